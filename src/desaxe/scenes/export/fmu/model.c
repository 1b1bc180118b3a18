/* ---- the model: one crank in a struct, no state elsewhere ---- */

typedef enum { SETTING, INITIALISING, EVENTS, CONTINUOUS, STEPPING, OVER } Mode;

typedef struct {
  double v[N_ALL];     /* every variable at its value reference; then the limit angles, and what loads hold */
  double way;          /* with friction: the sign of the speed, 0 at rest */
  double base[3];      /* time, angle and speed from which a given speed is followed */
  double h, tolerance; /* the last step of co-simulation; what it may err by, relative to the speed */
  Mode mode;
  int co_simulation;
  int known, ended;    /* whether outputs belong to the inputs; whether a limit angle is reached */
} Values;

typedef struct {
  Values now;
  void *host; /* of the messages */
  Callback log;
  char name[128];
} Model;

static void tell(Model *m, int failed, const char *text);

static void start_values(Values *x) {
  memset(x, 0, sizeof *x);
  memcpy(x->v, START, sizeof START);
  x->tolerance = 1e-10;
  x->way = 1.0;
  x->v[FIRST_ANGLE] = -(double)INFINITY;
  x->v[LAST_ANGLE] = (double)INFINITY;
}

/* ---- loads from tables, held between two kinks ---- */

#define WIDTH (1 + N_THROUGH)

/* What a table is looked up by, x[0], and its derivatives. */
static void argument_of(const Load *load, const double v[], const double columns[], double x[WIDTH]) {
  const double *at = &columns[load->column], *origin = load->centre != NULL ? &columns[load->origin] : NULL;
  for (int j = 0; j < WIDTH; j++) { /* from a dead centre a distance */
    x[j] = origin == NULL ? at[j] : at[0] < origin[0] ? origin[j] - at[j] : at[j] - origin[j];
  }
  x[0] -= v[load->held];
}

/* Add the loads to the forces; `by` becomes what each table's depends on. */
static void add_loads(double v[], double by[][N_THROUGH]) {
  double columns[N_COLUMNS], x[WIDTH];
  (void)eval_columns(v, columns);
  for (int k = 0; k < N_LOADS; k++) {
    const Load *load = &LOADS[k];
    const double *held = &v[load->held];
    argument_of(load, v, columns, x);
    const double piece = lookup_piece(x[0], load->knots, load->n, 1.0), low = piece > held[1] ? piece : held[1];
    const double at = (low < held[2] ? low : held[2]) + held[3];
    const double value = lookup(x[0], load->knots, load->rows, load->n, at);
    const double slope = lookup_slope(x[0], load->knots, load->rows, load->n, at);
    v[load->force] += value == value ? value : 0.0;
    for (int j = 0; j < N_THROUGH; j++) {
      by[k][j] = slope * x[1 + j];
    }
  }
}

/* Hold each load to the pieces ahead of the angle, for a crank that turns one way. */
static void hold_loads(double v[], double way) {
  double at[N_ALL], columns[N_COLUMNS], x[WIDTH];
  memcpy(at, v, sizeof at);
  at[THETA] += HAS_STATES ? 1e-9 * way : 0.0;
  (void)eval_columns(at, columns);
  for (int k = 0; k < N_LOADS; k++) {
    const Load *load = &LOADS[k];
    const double period = load->period, ahead = way < 0.0 ? -columns[RISES] : columns[RISES];
    double *held = &v[load->held], first = period > 0.0 ? 1.0 : 0.0, last = load->n;
    held[0] = period > 0.0 ? period * floor((at[THETA] - load->knots[0]) / period) : 0.0;
    argument_of(load, v, columns, x);
    const double here = lookup_piece(x[0], load->knots, load->n, 1.0), piece = here < first ? first : here;
    for (int j = 0; j < load->n_kinks; j++) {
      const double knot = load->kinks[j];
      first = knot < piece && knot + 1.0 > first ? knot + 1.0 : first;
      last = knot >= piece && knot < last ? knot : last;
    }
    held[1] = first;
    held[2] = last;
    held[3] = load->two_ways && ahead < 0.0 ? load->n + 1.0 : 0.0;
  }
}

/* Event indicators of the loads: distances to the kinks around, and the slider's way. */
static void load_indicators(const Values *x, const double state[2], double z[]) {
  double v[N_ALL], columns[N_COLUMNS], at[WIDTH];
  memcpy(v, x->v, sizeof v);
  v[THETA] = state[0];
  (void)eval_columns(v, columns);
  for (int k = 0; k < N_LOADS; k++, z += 3) {
    const Load *load = &LOADS[k];
    const double *held = &v[load->held], inward = held[3] > 0.0 ? -1.0 : 1.0;
    const int first = (int)held[1], last = (int)held[2];
    const double end = load->period > 0.0 ? load->knots[0] + load->period : (double)INFINITY;
    const double right = last < load->n ? load->knots[last] : end;
    argument_of(load, v, columns, at);
    z[0] = first > 0 ? at[0] - load->knots[first - 1] : 1.0;
    z[1] = right < (double)INFINITY ? right - at[0] : 1.0;
    z[2] = load->two_ways ? inward * (x->way < 0.0 ? -1.0 : 1.0) * columns[RISES] : 1.0;
  }
}

/* The dead centre that a load needs and that the lengths do not have; NULL where there is none such. */
static const char *missing_dead_centre(const double v[]) {
  double columns[N_COLUMNS];
  (void)eval_columns(v, columns);
  for (int k = 0; k < N_LOADS; k++) {
    if (LOADS[k].centre != NULL && !(columns[LOADS[k].origin] < (double)INFINITY)) {
      return LOADS[k].centre;
    }
  }
  return NULL;
}

/* ---- the motion ---- */

/* The acceleration, out[0], while the crank turns one way; returns its status. */
static int motion_at(double torque, double theta, double omega, double way, const double in[], double out[]) {
  double v[N_ALL], by[N_LOADS + 1][N_THROUGH];
  const double first = in[FIRST_ANGLE] + EDGE, last = in[LAST_ANGLE] - EDGE;
  memcpy(v, in, sizeof v);
  v[THETA] = theta < first ? first : (theta > last ? last : theta); /* trial steps go beyond */
  v[OMEGA] = omega;
  v[TORQUE] = torque;
  add_loads(v, by);
  return eval_motion(v, way, out);
}

/*STEP*/

static int alpha_of(const Values *x, const double state[2], double way, double *alpha) {
  const int status = motion_at(x->v[TORQUE], state[0], state[1], way, x->v, alpha);
  *alpha = status == 0 ? *alpha : (double)NAN;
  return status;
}

/* Whether a crank at rest starts one way. */
static int starts(Values *x, double way) {
  const double rest[2] = {x->v[THETA], 0.0};
  double alpha;
  hold_loads(x->v, way);
  return alpha_of(x, rest, way, &alpha) == 0 && alpha * way > 0.0;
}

/* Whether the way of turning matters: under friction, and under a load that the slider's way changes. */
static int has_way(const Values *x) {
  return HAS_STATES && (x->v[MU] > 0.0 || TURNING_LOADS > 0);
}

/* The way in which the crank turns or starts from rest, 0 where it is held there; loads are held for it. */
static double way_of(Values *x) {
  const double speed = x->v[OMEGA], way = speed < 0.0 ? -1.0 : 1.0;
  if (!has_way(x) || fabs(speed) > STANDS) {
    hold_loads(x->v, way);
    return has_way(x) ? way : 1.0;
  }
  return starts(x, 1.0) ? 1.0 : (starts(x, -1.0) ? -1.0 : 0.0);
}

/* Event indicators: distances to the limit angles; the speed, or what holds the crank at rest; the loads.
   An importer's root may lie on the tie itself, from which no further crossing would be seen: an event is due a
   margin beyond it, so that at the event the decision is clear, and behind it each indicator is > 0. */
static void indicators(const Values *x, const double state[2], double z[N_EVENTS]) {
  const double first = x->v[FIRST_ANGLE], last = x->v[LAST_ANGLE];
  z[0] = first > -(double)INFINITY ? state[0] - first - EDGE : 1.0;
  z[1] = last < (double)INFINITY ? last - EDGE - state[0] : 1.0;
  if (HAS_STATES) {
    load_indicators(x, state, &z[3]);
    z[AT_REST] = has_way(x) ? x->way * state[1] + STANDS : 1.0;
    if (has_way(x) && x->way == 0.0) {
      double ahead, back;
      Values trial = *x;
      hold_loads(trial.v, 1.0);
      const double up = alpha_of(&trial, state, 1.0, &ahead) == 0 ? -ahead : 1.0;
      hold_loads(trial.v, -1.0);
      const double down = alpha_of(&trial, state, -1.0, &back) == 0 ? back : 1.0;
      z[AT_REST] = (up < down ? up : down) + LETS_GO;
    }
  }
}

/* The angle that a given speed has led to; states have one of their own. */
static double followed(const Values *x) {
  return x->base[1] + 0.5 * (x->base[2] + x->v[OMEGA]) * (x->v[0] - x->base[0]);
}

static void follow_from_here(Values *x) {
  x->base[1] = x->v[THETA];
  x->base[0] = x->v[0];
  x->base[2] = x->v[OMEGA];
}

/* Everything that follows from states, inputs and parameters; returns the status. */
static int update(Values *x) {
  double alpha = 0.0, v[N_ALL], out[N_OUTPUTS + 1], by[N_LOADS + 1][N_THROUGH];
  int status = 0;
  if (x->mode <= INITIALISING) {
    x->v[THETA] = x->v[THETA0];
    if (HAS_STATES) {
      x->v[OMEGA] = x->v[OMEGA_START];
    }
    x->way = way_of(x);
  } else if (!HAS_STATES) {
    x->v[THETA] = x->co_simulation ? x->v[THETA] : followed(x);
    x->way = way_of(x);
  }
  if (HAS_STATES) {
    status = x->way < 0.0 || x->way > 0.0 ? alpha_of(x, &x->v[THETA], x->way, &alpha) : 0;
    x->v[DER_THETA] = x->v[OMEGA];
    x->v[DER_OMEGA] = alpha;
  }
  memcpy(v, x->v, sizeof v);
  add_loads(v, by);
  const int other = eval_outputs(v, alpha, out);
  for (int k = 0; k < N_OUTPUTS; k++) {
    x->v[OUTPUTS[k]] = out[k];
  }
  x->known = 1;
  return HAS_STATES ? status : other;
}

/* The limit angles around theta: infinite where the crank turns fully. Returns 0 where it cannot be assembled. */
static int find_limits(Values *x) {
  double angles[5];
  const double turn = 6.283185307179586, theta = x->v[THETA], ec = x->v[EC];
  const int status = eval_limits(x->v, angles);
  if (status == 0) {
    return 1;
  }
  if (angles[0] == 0.0 && angles[1] == turn) { /* a change point: the arcs between its quarters */
    const double quarter = 1.5707963267948966;
    angles[0] = ec < 0.0 ? -quarter : quarter;
    angles[1] = angles[0] + turn;
    if (ec == 0.0) {
      angles[0] = -quarter;
      angles[1] = angles[2] = quarter;
      angles[3] = 3.0 * quarter;
    }
  }
  for (int k = 0; k < 4; k += 2) {
    const double turns = turn * floor((theta - 0.5 * (angles[k] + angles[k + 1])) / turn + 0.5);
    if (angles[k] + turns < theta && theta < angles[k + 1] + turns) {
      x->v[FIRST_ANGLE] = angles[k] + turns;
      x->v[LAST_ANGLE] = angles[k + 1] + turns;
      return 1;
    }
  }
  return 0;
}

/* Whether a motion can start; if not, a message says why. */
static int is_sound(Model *m) {
  Values *x = &m->now;
  const double *v = x->v;
  char text[256] = "";
  for (int k = 0; k < N_CHECKS; k++) {
    const double value = v[CHECKS[k].place];
    if (!(fabs(value) < (double)INFINITY) || value < CHECKS[k].least) {
      snprintf(text, sizeof text, "%s = %.9g: expected %s", CHECKS[k].name, value, CHECKS[k].limit);
      tell(m, 1, text);
      return 0;
    }
  }
  x->v[FIRST_ANGLE] = -(double)INFINITY;
  x->v[LAST_ANGLE] = (double)INFINITY;
  x->mode = INITIALISING;
  (void)update(x);
  const int assembled = find_limits(x), status = update(x);
  const char *missing = missing_dead_centre(v);
  if (!assembled) {
    snprintf(text, sizeof text, "theta0 = %.9g: with ec = %.9g, AB = %.9g, BC = %.9g it cannot be assembled there", v[THETA],
             v[EC], v[LENGTH_AB], v[LENGTH_BC]);
  } else if (missing != NULL) {
    snprintf(text, sizeof text, "ec = %.9g, AB = %.9g, BC = %.9g: a load is given over the distance from the %s dead centre, "
             "and there is none", v[EC], v[LENGTH_AB], v[LENGTH_BC], missing);
  } else if (status == 0 && HAS_STATES && !(fabs(v[DER_OMEGA]) < (double)INFINITY)) {
    snprintf(text, sizeof text, "nothing moves without inertia: M_eff must be > 0 where the motion starts");
  } else if (status != 0) {
    snprintf(text, sizeof text, "no motion can start at theta = %.9g: %s", v[THETA], REASONS[status]);
  }
  if (text[0] != '\0') {
    tell(m, 1, text);
    return 0;
  }
  follow_from_here(x);
  return 1;
}

/* What happens at an instant: a limit angle ends the motion, friction holds or lets go, loads have a kink. */
static void meet_events(Model *m) {
  Values *x = &m->now;
  char text[160];
  double z[N_EVENTS];
  indicators(x, &x->v[THETA], z);
  if ((z[0] <= 0.0 || z[1] <= 0.0) && !x->ended) {
    snprintf(text, sizeof text, "theta has reached the limit angle %.9g at t = %.9g: beyond it there is no mechanism",
             x->v[z[0] <= 0.0 ? FIRST_ANGLE : LAST_ANGLE], x->v[0]);
    tell(m, 0, text);
    x->ended = 1;
  }
  if (has_way(x) && x->way * x->v[OMEGA] <= STANDS) {
    x->v[OMEGA] = 0.0;
  }
  x->way = way_of(x);
  x->known = 0;
}

/* ---- partial derivatives: seeds of the knowns, in the places of v, become those of everything ---- */

static void differentiate(const Values *x, double seed[N_VALUES]) {
  double slopes[N_SLOPES + 1], rows[N_OUTPUTS + 1] = {0.0}, by_alpha[N_OUTPUTS + 1] = {0.0}, alpha = 0.0;
  double v[N_ALL], by[N_LOADS + 1][N_THROUGH];
  const int through[N_THROUGH] = {THETA, OMEGA, EC, LENGTH_AB, LENGTH_BC};
  if (x->mode <= INITIALISING && HAS_STATES) {
    seed[THETA] = seed[THETA0];
    seed[OMEGA] = seed[OMEGA_START];
  } else if (!HAS_STATES) {
    seed[THETA] = seed[THETA0];
    if (x->mode > INITIALISING && !x->co_simulation) {
      seed[THETA] += 0.5 * ((x->base[2] + x->v[OMEGA]) * seed[0] + (x->v[0] - x->base[0]) * seed[OMEGA]);
    }
  }
  memcpy(v, x->v, sizeof v);
  add_loads(v, by);
  for (int k = 0; k < N_LOADS; k++) {
    for (int j = 0; j < N_THROUGH; j++) {
      seed[LOADS[k].force] += seed[through[j]] != 0.0 ? by[k][j] * seed[through[j]] : 0.0;
    }
  }
  (void)eval_slopes(v, HAS_STATES ? x->v[DER_OMEGA] : 0.0, slopes);
  for (int k = 0; k < N_SLOPES; k++) {
    if (SLOPES[k][1] == ALPHA) {
      by_alpha[SLOPES[k][0]] = slopes[k];
    } else if (seed[SLOPES[k][1]] != 0.0) {
      rows[SLOPES[k][0]] += slopes[k] * seed[SLOPES[k][1]];
    }
  }
  if (HAS_STATES) { /* T_in is the torque */
    alpha = x->way == 0.0 ? 0.0 : (seed[TORQUE] - rows[TORQUE_ROW]) / by_alpha[TORQUE_ROW];
    seed[DER_THETA] = seed[OMEGA];
    seed[DER_OMEGA] = alpha;
  }
  for (int k = 0; k < N_OUTPUTS; k++) {
    seed[OUTPUTS[k]] = rows[k] + (alpha != 0.0 ? by_alpha[k] * alpha : 0.0);
  }
}

/* ---- co-simulation: steps of Runge and Kutta to the communication point, halved where an event lies ---- */

/* A step, and the same in halves: their difference is the error, relative to the tolerance, NaN where there is none. */
static double trial(const Values *x, double h, const double y[2], double end[2]) {
  double whole[2] = {y[0], y[1]}, error = 0.0;
  const double torque = x->v[TORQUE], half = 0.5 * h;
  end[0] = y[0];
  end[1] = y[1];
  if (runge_kutta(h, torque, x->way, &whole[0], &whole[1], x->v) != 0 ||
      runge_kutta(half, torque, x->way, &end[0], &end[1], x->v) != 0 ||
      runge_kutta(half, torque, x->way, &end[0], &end[1], x->v) != 0) {
    return (double)NAN;
  }
  for (int i = 0; i < 2; i++) {
    const double slip = (end[i] - whole[i]) / 15.0, wide = fabs(y[1]) > fabs(end[1]) ? fabs(y[1]) : fabs(end[1]);
    const double scale = 0.03 * x->tolerance * (i == 0 ? 1.0 : wide + 0.01 * fabs(end[1] - y[1])) + 1e-300;
    error = fabs(slip) / scale > error ? fabs(slip) / scale : error;
    end[i] += slip;
  }
  return error;
}

/* To the communication point `end`, or to an event that ends the motion; returns whether it got there. */
static int advance(Model *m, double end) {
  Values *x = &m->now;
  double least = 1e-15 * (1.0 + fabs(end)); /* of a step that errs by nothing, and that may pass an event */
  double *y = &x->v[THETA], next[2], z[N_EVENTS], most = (double)INFINITY; /* most: of a step towards an event */
  for (int tiny = 0; x->v[0] < end && !x->ended;) {
    x->way = fabs(y[1]) > STANDS ? x->way : way_of(x);
    if (x->way == 0.0) {
      y[1] = 0.0; /* nothing moves until an input changes */
      x->v[0] = end;
      break;
    }
    const double left = end - x->v[0], longest = x->h > 0.0 && x->h < left ? x->h : left;
    const double h = most < longest ? most : longest, error = trial(x, h, y, next);
    const double growth = error < 1e-4 ? 5.0 : 0.9 * pow(error, -0.2);
    tiny += h <= least;
    if (tiny > 10000 || (h <= least && !(error < (double)INFINITY))) {
      char text[160];
      snprintf(text, sizeof text, "the integration failed at t = %.9g, theta = %.9g, omega = %.9g: no step is short enough",
               x->v[0], y[0], y[1]);
      tell(m, 1, text);
      return 0;
    }
    if (!(error < 1.0) && h > least) {
      x->h = h * (growth > 0.2 ? growth : 0.2);
      continue;
    }
    indicators(x, next, z);
    int met = 0;
    for (int k = 0; k < N_EVENTS; k++) {
      met = met || z[k] < 0.0 || (k < 2 && z[k] <= 0.0);
    }
    if (met && h > least) {
      most = 0.5 * h;
      continue;
    }
    x->h = !(x->h > 0.0) || !(h < x->h) ? h * (growth > 1.0 ? growth : 1.0) : x->h;
    least *= !met && most < least ? 8.0 : 1.0; /* an event less than the last digit of the angle ahead */
    most = met || most < least ? (double)INFINITY : 0.5 * most;
    memcpy(y, next, sizeof next);
    x->v[0] = h < left ? x->v[0] + h : end;
    if (met) {
      meet_events(m);
    }
  }
  x->known = 0;
  return 1;
}

/* A step of co-simulation; returns whether it succeeded. */
static int do_step(Model *m, double start, double h) {
  Values *x = &m->now;
  if (!(h > 0.0) || !(start + h < (double)INFINITY) || fabs(start - x->v[0]) > 1e-9 * (1.0 + fabs(start))) {
    tell(m, 1, "a step goes from the time that is reached, over a finite time > 0");
    return 0;
  }
  for (int k = FIRST_INPUT; k < FIRST_INPUT + N_INPUTS; k++) {
    if (!(fabs(x->v[k]) < (double)INFINITY)) {
      tell(m, 1, "an input is not a finite number");
      return 0;
    }
  }
  x->v[0] = start;
  if (HAS_STATES) {
    return advance(m, start + h);
  }
  x->v[THETA] += x->v[OMEGA] * h;
  x->v[0] = start + h;
  meet_events(m);
  return 1;
}
