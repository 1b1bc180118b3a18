/* No load varies with the motion. */
#define TURNING_LOADS 0

typedef struct {
  int all;
} Loads;

static const char *missing_dead_centre(const double v[]) {
  (void)v;
  return NULL;
}

static void find_kinks(Loads *loads, const double v[], int all) {
  (void)loads, (void)v, (void)all;
}

static void hold_loads(Loads *loads, const double v[], const double limits[2], double way) {
  (void)loads, (void)v, (void)limits, (void)way;
}

static void add_loads(const Loads *loads, double v[], double (*slopes)[4]) {
  (void)loads, (void)v, (void)slopes;
}

static void seed_loads(const Loads *loads, double v[], double seed[N_VALUES]) {
  (void)loads, (void)v, (void)seed;
}

static void load_indicators(const Loads *loads, const double state[2], double z[]) {
  (void)loads, (void)state, (void)z;
}
