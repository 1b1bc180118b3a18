/* The same; beyond the angles that the polynomials' reduction keeps exact, from libm. */
static void sin_cos(double x, double out[]) {
  if (fabs(x) <= @LIMIT@) {
    near_sin_cos(x, out);
  } else {
    out[0] = sin(x);
    out[1] = cos(x);
  }
}
