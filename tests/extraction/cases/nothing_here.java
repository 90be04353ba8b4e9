/**
 * @param s the scan
 * @return the map, see {@link Map}; mail@Sense.org
 * @Output the map
 * @sense of direction
 */
@Override
@Input
public Map build(Scan s) { return null; }
