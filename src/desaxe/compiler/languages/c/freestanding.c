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
