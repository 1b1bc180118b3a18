/* The number of the piece of a table at x; those of the way back follow. */
static inline double lookup_piece(double x, const double *knots, int64_t n, double way) {
  int64_t low = 0, high = n;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (knots[middle] <= x) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return (double)(low + (way < 0.0 ? n + 1 : 0));
}

/* The value of a piece of a table at x, beyond its ends too. */
static inline double lookup(double x, const double *knots, const double *rows, int64_t n, double piece) {
  const int64_t at = (int64_t)piece % (n + 1);
  const double s = x - knots[at > 0 ? at - 1 : 0], *row = rows + 4 * (int64_t)piece;
  return row[0] + s * (row[1] + s * (row[2] + s * row[3]));
}

/* The slope of a piece of a table at x, beyond its ends too. */
static inline double lookup_slope(double x, const double *knots, const double *rows, int64_t n,
                                  double piece) {
  const int64_t at = (int64_t)piece % (n + 1);
  const double s = x - knots[at > 0 ? at - 1 : 0], *row = rows + 4 * (int64_t)piece;
  return row[1] + s * (2.0 * row[2] + s * (3.0 * row[3]));
}

/* What rounding took from a + b, exactly (Knuth). */
static inline double two_sum_error(double a, double b) {
  const double total = a + b, of_b = total - a;
  return (a - (total - of_b)) + (b - of_b);
}

/* What rounding took from a * b, exactly (Dekker). */
static inline double two_product_error(double a, double b) {
  const double product = a * b, wide_a = 134217729.0 * a, wide_b = 134217729.0 * b;
  const double a_high = wide_a - (wide_a - a), b_high = wide_b - (wide_b - b);
  const double a_low = a - a_high, b_low = b - b_high;
  return a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low) + 0.0;
}

static inline double mul_add(double a, double b, double c) {
  return a * b + c;
}

/* Whether to take a form that only twice the digits tell from the other: not here. */
static inline int extended_only(int a) {
  (void)a;
  return 0;
}

/* What rounding may take from a number of this size in four operations. */
static inline double rounding(double a) {
  return 4.440892098500626e-16 * fabs(a);
}

/* The power of two that is not below a size (Rump), within bounds. */
static inline double power_of_two(double a) {
  const double least = 1.0261342003245941e-289, most = 9.7453140114e+288;
  const double size = a < most ? (least < a ? a : least) : most, wide = 9007199254740992.0 * size;
  const double step = (wide + size) - wide;
  return step > 0.0 ? step : size;
}

/* The sine of an angle and whole quarter turns, from the angle's own. */
static inline double rotated_sin(double sine, double cosine, double quarters) {
  const double turn = quarters - 4.0 * floor(0.25 * quarters);
  const double value = ((turn == 1.0) | (turn == 3.0)) ? cosine : sine;
  return turn >= 2.0 ? -value : value;
}

/* The cosine of an angle and whole quarter turns, from the angle's own. */
static inline double rotated_cos(double sine, double cosine, double quarters) {
  const double turn = quarters - 4.0 * floor(0.25 * quarters);
  const double value = ((turn == 1.0) | (turn == 3.0)) ? sine : cosine;
  return ((turn == 1.0) | (turn == 2.0)) ? -value : value;
}
