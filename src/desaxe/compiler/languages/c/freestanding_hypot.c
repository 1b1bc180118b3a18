/* sqrt(a^2 + b^2), without overflow on the way. */
static double own_hypot(double a, double b) {
  const double wide = fabs(a), high = fabs(b);
  if (wide > 1.7976931348623157e308 || high > 1.7976931348623157e308) {
    return INFINITY;
  }
  const double large = high > wide ? high : wide, small = high > wide ? wide : high;
  const double ratio = large > 0.0 ? small / large : 0.0;
  return wide != wide || high != high ? NAN : large * sqrt(1.0 + ratio * ratio);
}
#define hypot own_hypot
