class Robot {
    /**
     * @module_start
     * @module_name Gps
     * @Sense NotifyAtFrequency 5
     */
    Fix read() { return null; }
    // @module_end

    /*
    // @module_start
    // @module_name Compass
    // @Sense NotifyAtFrequency 5
    Heading turn() { return null; }
    // @module_end
    /** @module_start
     */

    // // @module_start
    /* // @module_start */
}
