int @NAME@_limits(const double in[], double angles[4]) {
  @UNUSED@
  return limits_angles(@ANGLES@);
}
