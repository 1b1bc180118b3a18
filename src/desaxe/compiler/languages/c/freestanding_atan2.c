/* The angle of (x, y): an estimate, turned back by its own sine and cosine, plus what is left. */
static double own_atan2(double y, double x) {
  if (y != y || x != x) {
    return NAN;
  }
  double wide = fabs(x), high = fabs(y);
  if (wide > 1.7976931348623157e308 && high > 1.7976931348623157e308) {
    wide = high = 1.0;
  }
  const int steep = high > wide;
  const double large = steep ? high : wide, small = steep ? wide : high;
  double angle = large > 0.0 && large <= 1.7976931348623157e308 ? small / large : 0.0;
  if (large < 0x1p-960) { /* so that no product below is subnormal */
    wide *= 0x1p+100;
    high *= 0x1p+100;
  } else if (large > 0x1p+960) {
    wide *= 0x1p-100;
    high *= 0x1p-100;
  }
  if (large > 1.7976931348623157e308) {
    angle = 0.0;
  } else if (angle > 1e-9) { /* below, the angle is its tangent */
    double turn[2];
    angle *= 1.0584 - 0.273 * angle;
    near_sin_cos(angle, turn);
    const double far = steep ? high : wide, near = steep ? wide : high;
    const double left = (near * turn[1] - far * turn[0]) / (far * turn[1] + near * turn[0]);
    const double square = left * left;
    angle += left - left * square * (1.0 / 3.0 - square * (0.2 - square * (1.0 / 7.0)));
  }
  angle = steep ? (1.5707963267948966 - angle) + 6.123233995736766e-17 : angle;
  angle = x < 0.0 || bits_of(x) >> 63 ? (3.141592653589793 - angle) + 1.2246467991473532e-16 : angle;
  return copysign(angle, y);
}
#define atan2 own_atan2
