class A {
  // @module_start
  // @module_name A
  /** Javadoc.
   * @DataOut RequestWhenReady
   * @Input sink: none
   */
  @Override @SuppressWarnings({"a,b", "@module_end"})
  public <T extends Comparable<T>> CompletableFuture<List<T>> sort(Optional<T> x, Map<String, ? extends Pose> m, List<? super T> sink, Consumer<T> c) throws E { return null; }
  // @DataOut RequestWhenReady
  int[] ids(int[][] grid, long... rest);
  // @DataOut RequestWhenReady
  A(Scan s) { }
  // @DataOut RequestWhenReady
  private final Map m = new Map();
  // @DataOut RequestWhenReady
  String text = """
    // @module_end
    """;
  // @module_end
}
