"""Functions that the spellings of the C column call, as source text.

No product is fused with a sum in these files, so that all error terms are exact, and every compiler and
option gives the same digits.
"""

# Contraction is switched off as each compiler wants it; the rest of the list changes no value.
PRAGMAS = """\
#if defined(__FAST_MATH__)
#error "compile without -ffast-math: it drops error terms and the NaN of an infeasible point"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "numbers must be evaluated in their own type: -mfpmath=sse, for example"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off", "no-math-errno", "no-trapping-math")
#elif !defined(_MSC_VER)
#pragma STDC FP_CONTRACT OFF
#endif
"""

# C++ compiles the file, too, but for this word.
CPLUSPLUS = """\
#if defined(__cplusplus)
#define restrict __restrict
#endif
"""

HELPERS = {
    "checked_table": """/* 0, or NaN where something is no table: then x, c and n become one of zeros. */
static double checked_table(const double **x, const double **c, int64_t *n, int64_t ways, double period) {
  static const double places[2] = {0.0, 1.0}, zeros[24] = {0.0};
  const double *knots = *x, *rows = *c;
  const int64_t count = *n;
  int bad = knots == NULL || rows == NULL || count < 2;
  if (!bad) {
    bad |= !(fabs(knots[0]) < (double)INFINITY) | !(knots[count - 1] - knots[0] < period);
    for (int64_t k = 1; k < count; k++) {
      bad |= !(knots[k - 1] <= knots[k]) | !(knots[k] < (double)INFINITY);
    }
    for (int64_t k = 2; k < count; k++) {
      bad |= !(knots[k - 2] < knots[k]);
    }
    for (int64_t k = 0; k < 4 * ways * (count + 1); k++) {
      bad |= !(fabs(rows[k]) < (double)INFINITY);
    }
  }
  if (bad) {
    *x = places;
    *c = zeros;
    *n = 2;
  }
  return bad ? (double)NAN : 0.0;
}
""",
    "filled_table": """/* The pieces between points: straight lines, or steps, each up to the next point. */
static void filled_table(int64_t n, const double *x, const double *y, int steps, double period, double *c) {
  const int repeats = period < (double)INFINITY;
  for (int64_t k = 0; k <= n; k++) {
    const int inside = k > 0 && (k < n || repeats);
    const int64_t left = k > 0 ? k - 1 : 0, right = k < n ? k : 0;
    const double width = (k < n ? x[right] : x[0] + period) - x[left];
    c[4 * k] = y[left];
    c[4 * k + 1] = inside && !steps && width > 0.0 ? (y[right] - y[left]) / width : 0.0;
    c[4 * k + 2] = 0.0;
    c[4 * k + 3] = 0.0;
  }
  for (int k = 0; repeats && k < 4; k++) {
    c[k] = c[4 * n + k];
  }
}
""",
    "lookup_piece": """/* The number of the piece of a table at x; those of the way back follow. */
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
""",
    "lookup": """/* The value of a piece of a table at x, beyond its ends too. */
static inline double lookup(double x, const double *knots, const double *rows, int64_t n, double piece) {
  const int64_t at = (int64_t)piece % (n + 1);
  const double s = x - knots[at > 0 ? at - 1 : 0], *row = rows + 4 * (int64_t)piece;
  return row[0] + s * (row[1] + s * (row[2] + s * row[3]));
}
""",
    "lookup_slope": """/* The slope of a piece of a table at x, beyond its ends too. */
static inline double lookup_slope(double x, const double *knots, const double *rows, int64_t n,
                                  double piece) {
  const int64_t at = (int64_t)piece % (n + 1);
  const double s = x - knots[at > 0 ? at - 1 : 0], *row = rows + 4 * (int64_t)piece;
  return row[1] + s * (2.0 * row[2] + s * (3.0 * row[3]));
}
""",
    "two_sum_error": """/* What rounding took from a + b, exactly (Knuth). */
static inline double two_sum_error(double a, double b) {
  const double total = a + b, of_b = total - a;
  return (a - (total - of_b)) + (b - of_b);
}
""",
    "two_product_error": """/* What rounding took from a * b, exactly (Dekker). */
static inline double two_product_error(double a, double b) {
  const double product = a * b, wide_a = 134217729.0 * a, wide_b = 134217729.0 * b;
  const double a_high = wide_a - (wide_a - a), b_high = wide_b - (wide_b - b);
  const double a_low = a - a_high, b_low = b - b_high;
  return a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low) + 0.0;
}
""",
    "mul_add": """static inline double mul_add(double a, double b, double c) {
  return a * b + c;
}
""",
    "extended_only": """/* Whether to take a form that only twice the digits tell from the other: not here. */
static inline int extended_only(int a) {
  (void)a;
  return 0;
}
""",
    "rounding": """/* What rounding may take from a number of this size in four operations. */
static inline double rounding(double a) {
  return 4.440892098500626e-16 * fabs(a);
}
""",
    "power_of_two": """/* The power of two that is not below a size (Rump), within bounds. */
static inline double power_of_two(double a) {
  const double least = 1.0261342003245941e-289, most = 9.7453140114e+288;
  const double size = a < most ? (least < a ? a : least) : most, wide = 9007199254740992.0 * size;
  const double step = (wide + size) - wide;
  return step > 0.0 ? step : size;
}
""",
    "rotated_sin": """/* The sine of an angle and whole quarter turns, from the angle's own. */
static inline double rotated_sin(double sine, double cosine, double quarters) {
  const double turn = quarters - 4.0 * floor(0.25 * quarters);
  const double value = ((turn == 1.0) | (turn == 3.0)) ? cosine : sine;
  return turn >= 2.0 ? -value : value;
}
""",
    "rotated_cos": """/* The cosine of an angle and whole quarter turns, from the angle's own. */
static inline double rotated_cos(double sine, double cosine, double quarters) {
  const double turn = quarters - 4.0 * floor(0.25 * quarters);
  const double value = ((turn == 1.0) | (turn == 3.0)) ? sine : cosine;
  return ((turn == 1.0) | (turn == 2.0)) ? -value : value;
}
""",
}

# Where there is no libm. The bits of a double are read through a union, which C99 allows.
FREESTANDING = """\
/* Elementary functions of this file's own: it needs no libm. */
typedef union {
  double number;
  uint64_t bits;
} number_bits;

static inline double from_bits(uint64_t bits) {
  number_bits both;
  both.bits = bits;
  return both.number;
}

static inline uint64_t bits_of(double number) {
  number_bits both;
  both.number = number;
  return both.bits;
}

#define SIGN_BIT UINT64_C(0x8000000000000000)
#undef NAN
#undef INFINITY
#define NAN from_bits(UINT64_C(0x7ff8000000000000))
#define INFINITY from_bits(UINT64_C(0x7ff0000000000000))

static inline double own_fabs(double a) {
  return from_bits(bits_of(a) & ~SIGN_BIT);
}

static inline double own_copysign(double size, double sign) {
  return from_bits((bits_of(size) & ~SIGN_BIT) | (bits_of(sign) & SIGN_BIT));
}

/* The largest whole number that is not larger; without digits behind the point, every number is. */
static inline double own_floor(double a) {
  if (!(own_fabs(a) < 4503599627370496.0)) {
    return a;
  }
  const double whole = (double)(int64_t)a;
  return own_copysign(whole > a ? whole - 1.0 : whole, a);
}

/* The square root: Newton's steps, then the exact remainder of the last one (Dekker's product). */
static double own_sqrt(double a) {
  if (!(a > 0.0) || a > 1.7976931348623157e308) {
    return a == 0.0 || a > 0.0 ? a : NAN;
  }
  double scale = 1.0;
  while (a < 0x1p-500) {
    a *= 0x1p+512;
    scale *= 0x1p-256;
  }
  while (a > 0x1p+500) {
    a *= 0x1p-512;
    scale *= 0x1p+256;
  }
  double root = from_bits((bits_of(a) >> 1) + UINT64_C(0x1ff8000000000000));
  for (int step = 0; step < 5; step++) {
    root = 0.5 * (root + a / root);
  }
  const double wide = 134217729.0 * root, high = wide - (wide - root), low = root - high;
  const double square = root * root, rest = ((high * high - square) + 2.0 * high * low) + low * low;
  return scale * (root + ((a - square) - rest) / (2.0 * root));
}
#define fabs own_fabs
#define copysign own_copysign
#define floor own_floor
#define sqrt own_sqrt
"""

FREESTANDING_HYPOT = """\
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
"""

# After the written-out sine and cosine, on which it is built.
FREESTANDING_ATAN2 = """\
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
"""
