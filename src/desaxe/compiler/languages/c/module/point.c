int @NAME@_point(const double in[], double out[]) {
  @UNUSED@
  @TURNS@
  @PLAIN@
  return stable(@ARGUMENTS@);
}
