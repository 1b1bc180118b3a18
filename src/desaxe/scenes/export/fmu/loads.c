/* ---- loads from tables: cubics over the crank angle, the slider's position or the distance
   from a dead centre, held between two kinks ---- */

/* Row 0 holds below the first place (above a period it is the last row), row k from place k - 1 on. */
typedef struct {
  int force, over_Y, centre, n, n_kinks; /* centre: where a dead centre stands in the position, 0 for none */
  double period; /* of an angle; over Y the ends go on */
  const double *places, (*rows)[4], (*inward)[4];
  const int *kinks; /* indices of the places where value or slope jumps */
} Load;

typedef struct {
  double edges[2], shift; /* crank angles between which the load is smooth; whole periods ahead of them */
  int first, last;        /* rows in use there */
  int inward;
} Held;

typedef struct {
  Held held[N_LOADS];
  int all;    /* whether every place counts as a kink: a step of high order is for one cubic */
  double kinks[N_LOADS][N_ANGLES];
} Loads;

/*TABLES*/

static int count_of(const Loads *loads, const Load *load) {
  return loads->all ? load->n : load->n_kinks;
}

static int kink_of(const Loads *loads, const Load *load, int number) {
  return loads->all ? number : load->kinks[number];
}

/* What a load over Y is looked up by, Y or the distance from its dead centre, with its derivatives by theta, ec,
   AB, BC; dY/dtheta is returned. */
static double find_position(const Load *load, const double v[], double found[5]) {
  double every[N_POSITION];
  (void)eval_position(v, every);
  memcpy(found, every, 5 * sizeof *found);
  if (load->centre) {
    const double *centre = &every[load->centre], side = every[0] < centre[0] ? -1.0 : 1.0;
    found[0] = side * (every[0] - centre[0]);
    found[1] = side * every[1];
    for (int j = 1; j < 4; j++) {
      found[1 + j] = side * (every[1 + j] - centre[j]);
    }
  }
  return every[1];
}

/* Name a dead centre that a load needs and that the lengths do not have; NULL where there is none such. */
static const char *missing_dead_centre(const double v[]) {
  double every[N_POSITION];
  (void)eval_position(v, every);
  for (int k = 0; k < N_LOADS; k++) {
    const double centre = every[LOADS[k].centre];
    if (LOADS[k].centre && centre != centre) {
      return LOADS[k].centre == OUTER ? "outer" : "inner";
    }
  }
  return NULL;
}

/* The crank angles of the kinks: where the slider passes a place, or turns round; NaN where it does not. */
static void find_kinks(Loads *loads, const double v[], int all) {
  const double ec = v[EC], longest = v[LENGTH_BC] + v[LENGTH_AB], least = v[LENGTH_BC] - v[LENGTH_AB];
  double every[N_POSITION];
  (void)eval_position(v, every);
  loads->all = all;
  for (int k = 0; k < N_LOADS; k++) {
    const Load *load = &LOADS[k];
    double *angles = loads->kinks[k];
    for (int j = 0; j < N_ANGLES; j++) {
      angles[j] = (double)NAN;
    }
    for (int j = 0; j < count_of(loads, load); j++) {
      const double place = load->places[kink_of(loads, load, j)];
      if (load->centre) {
        (void)eval_inverse(v, every[load->centre] - place, &angles[4 * j]);
        (void)eval_inverse(v, every[load->centre] + place, &angles[4 * j + 2]);
      } else if (load->over_Y) {
        (void)eval_inverse(v, place, &angles[2 * j]);
      } else {
        angles[j] = place;
      }
    }
    if (load->inward != NULL) {
      double *centres = &angles[(load->centre ? 4 : 2) * count_of(loads, load)];
      centres[0] = atan2(-ec, sqrt((longest - ec) * (longest + ec)));
      centres[1] = atan2(least < 0.0 ? -ec : ec, sqrt((least - ec) * (least + ec)));
      centres[2] = 3.141592653589793 - centres[0];
      centres[3] = 3.141592653589793 - centres[1];
    }
  }
}

/* The number of the row at a place, from first to last. */
static int row_at(const Load *load, double place, int first, int last) {
  while (first < last) {
    const int middle = first + (last - first) / 2;
    if (place >= load->places[middle]) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  return first;
}

static double periods(const Load *load, double theta) {
  return load->over_Y ? 0.0 : load->period * floor((theta - load->places[0]) / load->period);
}

/* Hold each load to the rows ahead of the angle, for a crank that turns one way. */
static void hold_loads(Loads *loads, const double v[], const double limits[2], double way) {
  for (int k = 0; k < N_LOADS; k++) {
    const Load *load = &LOADS[k];
    Held *held = &loads->held[k];
    const double ahead = v[THETA] + (HAS_STATES ? 1e-9 * way : 0.0), period = load->over_Y ? 6.283185307179586 : load->period;
    double at[N_VALUES], found[5], low = limits[0], high = limits[1];
    held->edges[0] = -(double)INFINITY;
    held->edges[1] = (double)INFINITY;
    for (int j = 0; j < N_ANGLES; j++) {
      double angle = loads->kinks[k][j];
      angle += period * floor((ahead - angle) / period);
      angle -= angle > ahead ? period : 0.0;
      held->edges[0] = angle > held->edges[0] ? angle : held->edges[0];
      held->edges[1] = angle + period < held->edges[1] ? angle + period : held->edges[1];
    }
    low = held->edges[0] > low ? held->edges[0] : low;
    high = held->edges[1] < high ? held->edges[1] : high;
    memcpy(at, v, sizeof at);
    at[THETA] = high - low < (double)INFINITY ? 0.5 * (low + high) : ahead;
    held->shift = periods(load, at[THETA]);
    double place = at[THETA] - held->shift;
    held->inward = 0;
    if (load->over_Y) {
      const double rises = find_position(load, at, found);
      place = found[0];
      held->inward = load->inward != NULL && rises * (way < 0.0 ? -1.0 : 1.0) < 0.0;
    }
    held->first = load->over_Y ? 0 : 1;
    held->last = load->n;
    const int row = row_at(load, place, held->first, held->last);
    for (int j = 0; j < count_of(loads, load); j++) {
      const int knot = kink_of(loads, load, j);
      held->first = knot < row && knot + 1 > held->first ? knot + 1 : held->first;
      held->last = knot >= row && knot < held->last ? knot : held->last;
    }
  }
}

/* Add the loads to the forces; slopes, where given, are by theta, ec, AB, BC. */
static void add_loads(const Loads *loads, double v[], double (*slopes)[4]) {
  for (int k = 0; k < N_LOADS; k++) {
    const Load *load = &LOADS[k];
    const Held *held = &loads->held[k];
    const double shift = count_of(loads, load) > 0 ? held->shift : periods(load, v[THETA]);
    double found[5] = {v[THETA] - shift, 1.0};
    if (load->over_Y) {
      (void)find_position(load, v, found);
    }
    const int row = row_at(load, found[0], held->first, held->last);
    const double *c = (held->inward ? load->inward : load->rows)[row];
    const double s = found[0] - load->places[row > 0 ? row - 1 : 0];
    v[load->force] += found[0] == found[0] ? c[0] + s * (c[1] + s * (c[2] + s * c[3])) : 0.0;
    for (int j = 0; j < 4 && slopes != NULL; j++) {
      slopes[k][j] = (load->over_Y || j == 0 ? found[j + 1] : 0.0) * (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3])));
    }
  }
}

/* What loads that vary with the motion make of the seeds of the forces. */
static void seed_loads(const Loads *loads, double v[], double seed[N_VALUES]) {
  const int by[4] = {THETA, EC, LENGTH_AB, LENGTH_BC};
  double slopes[N_LOADS][4];
  add_loads(loads, v, slopes);
  for (int k = 0; k < N_LOADS; k++) {
    for (int j = 0; j < 4; j++) {
      seed[LOADS[k].force] += seed[by[j]] != 0.0 ? slopes[k][j] * seed[by[j]] : 0.0;
    }
  }
}

/* Event indicators: distances to the kinks around the angle. */
static void load_indicators(const Loads *loads, const double state[2], double z[]) {
  for (int k = 0; k < N_LOADS; k++) {
    const double *edges = loads->held[k].edges;
    z[2 * k] = edges[0] > -(double)INFINITY ? state[0] - edges[0] : 1.0;
    z[2 * k + 1] = edges[1] < (double)INFINITY ? edges[1] - state[0] : 1.0;
  }
}
