/* ---- the model: one crank in a struct, no state elsewhere ---- */

typedef enum { SETTING, INITIALISING, EVENTS, CONTINUOUS, STEPPING, OVER } Mode;

typedef struct {
  double v[N_VALUES];   /* every variable at its value reference */
  double first, last;   /* limit angles around theta */
  Loads loads;
  double way;           /* with friction: the sign of the speed, 0 at rest */
  double base[3];       /* time, angle and speed from which a given speed is followed */
  double h;             /* the last step of the integrator */
  double tolerance;
  Mode mode;
  int co_simulation, early; /* whether a step may return early */
  int known, ended;         /* whether outputs belong to the inputs; whether a limit angle is reached */
} Values;

typedef struct {
  Values now;
  void *host;       /* of the messages */
  Callback log;
  char name[128];
} Model;

static void tell(Model *m, int failed, const char *text);

static void start_values(Values *x) {
  memset(x, 0, sizeof *x);
  for (int k = 0; k < N_VALUES; k++) {
    x->v[k] = START[k];
  }
  x->tolerance = 1e-10;
  x->way = 1.0;
  x->first = -(double)INFINITY;
  x->last = (double)INFINITY;
}

/* The acceleration while the crank turns one way; returns its status. */
static int alpha_of(const Values *x, const double state[2], double way, double *alpha) {
  double v[N_VALUES], out[1];
  memcpy(v, x->v, sizeof v);
  const double first = x->first + EDGE, last = x->last - EDGE;
  v[THETA] = state[0] < first ? first : (state[0] > last ? last : state[0]); /* trial steps go beyond */
  v[OMEGA] = state[1];
  add_loads(&x->loads, v, NULL);
  const int status = eval_motion(v, way, out);
  *alpha = status == 0 ? out[0] : (double)NAN;
  return status;
}

static void hold(Values *x, double way) {
  const double limits[2] = {x->first, x->last};
  hold_loads(&x->loads, x->v, limits, way);
}

/* Whether a crank at rest starts one way. */
static int starts(Values *x, double way) {
  const double rest[2] = {x->v[THETA], 0.0};
  double alpha;
  hold(x, way);
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
    hold(x, way);
    return has_way(x) ? way : 1.0;
  }
  return starts(x, 1.0) ? 1.0 : (starts(x, -1.0) ? -1.0 : 0.0);
}

/* Event indicators: distances to the limit angles; the speed, or what holds the crank at rest. */
static void indicators(const Values *x, const double state[2], double z[N_EVENTS]) {
  z[0] = x->first > -(double)INFINITY ? state[0] - x->first - EDGE : 1.0;
  z[1] = x->last < (double)INFINITY ? x->last - EDGE - state[0] : 1.0;
  if (HAS_STATES) {
    load_indicators(&x->loads, state, &z[3]);
    z[AT_REST] = has_way(x) ? x->way * state[1] : 1.0;
    if (has_way(x) && x->way == 0.0) {
      double ahead, back;
      Values trial = *x;
      hold(&trial, 1.0);
      const double up = alpha_of(&trial, state, 1.0, &ahead) == 0 ? -ahead : 1.0;
      hold(&trial, -1.0);
      const double down = alpha_of(&trial, state, -1.0, &back) == 0 ? back : 1.0;
      z[AT_REST] = up < down ? up : down;
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
  double alpha = 0.0, v[N_VALUES], out[N_OUTPUTS + 1];
  int status = 0;
  if (x->mode <= INITIALISING) {
    x->v[THETA] = x->v[THETA0];
    if (HAS_STATES) {
      x->v[OMEGA] = x->v[OMEGA_START];
    }
    find_kinks(&x->loads, x->v, x->co_simulation);
    x->way = way_of(x);
  } else if (!HAS_STATES) {
    x->v[THETA] = x->co_simulation ? x->v[THETA] : followed(x);
    x->way = way_of(x);
  }
  if (HAS_STATES && x->way != 0.0) {
    status = alpha_of(x, &x->v[THETA], x->way, &alpha);
  }
  if (HAS_STATES) {
    x->v[DER_THETA] = x->v[OMEGA];
    x->v[DER_OMEGA] = alpha;
  }
  memcpy(v, x->v, sizeof v);
  add_loads(&x->loads, v, NULL);
  const int other = eval_outputs(v, alpha, out);
  for (int k = 0; k < N_OUTPUTS; k++) {
    x->v[OUTPUTS[k]] = out[k];
  }
  indicators(x, &x->v[THETA], &x->v[INDICATORS]);
  x->known = 1;
  return HAS_STATES ? status : other;
}

/* The limit angles around theta: infinite where the crank turns fully. Returns 0 where it cannot be assembled. */
static int find_limits(Values *x) {
  double found[6];
  const double turn = 6.283185307179586, theta = x->v[THETA], ec = x->v[EC];
  int status = eval_limits(x->v, found);
  x->first = -(double)INFINITY;
  x->last = (double)INFINITY;
  if (status == 0) {
    return 1;
  }
  if (found[0] == 0.0 && found[1] == turn) { /* a change point: the arcs between its quarters */
    const double quarter = 1.5707963267948966;
    found[0] = ec < 0.0 ? -quarter : quarter;
    found[1] = found[0] + turn;
    if (ec == 0.0) {
      found[0] = -quarter;
      found[1] = found[2] = quarter;
      found[3] = 3.0 * quarter;
    }
  }
  for (int k = 0; k < 4; k += 2) {
    const double turns = turn * floor((theta - 0.5 * (found[k] + found[k + 1])) / turn + 0.5);
    if (found[k] + turns < theta && theta < found[k + 1] + turns) {
      x->first = found[k] + turns;
      x->last = found[k + 1] + turns;
      return 1;
    }
  }
  return 0;
}

/* Whether a motion can start; if not, a message says why. */
static int is_sound(Model *m) {
  Values *x = &m->now;
  char text[256];
  for (int k = 0; k < N_CHECKS; k++) {
    const double value = x->v[CHECKS[k].place];
    if (!(fabs(value) < (double)INFINITY) || value < CHECKS[k].least) {
      snprintf(text, sizeof text, "%s = %.9g: expected %s", CHECKS[k].name, value, CHECKS[k].limit);
      tell(m, 1, text);
      return 0;
    }
  }
  x->first = -(double)INFINITY;
  x->last = (double)INFINITY;
  x->mode = INITIALISING;
  update(x);
  if (!find_limits(x)) {
    snprintf(text, sizeof text, "theta0 = %.9g: with ec = %.9g, AB = %.9g, BC = %.9g it cannot be assembled there",
             x->v[THETA], x->v[EC], x->v[LENGTH_AB], x->v[LENGTH_BC]);
    tell(m, 1, text);
    return 0;
  }
  const char *missing = missing_dead_centre(x->v);
  if (missing != NULL) {
    snprintf(text, sizeof text, "ec = %.9g, AB = %.9g, BC = %.9g: a load is given over the distance from the %s dead centre, "
             "and there is none", x->v[EC], x->v[LENGTH_AB], x->v[LENGTH_BC], missing);
    tell(m, 1, text);
    return 0;
  }
  const int status = update(x);
  if (status == 0 && HAS_STATES && !(fabs(x->v[DER_OMEGA]) < (double)INFINITY)) {
    tell(m, 1, "nothing moves without inertia: M_eff must be > 0 where the motion starts");
    return 0;
  }
  if (status != 0) {
    snprintf(text, sizeof text, "no motion can start at theta = %.9g: %s", x->v[THETA], REASONS[status]);
    tell(m, 1, text);
    return 0;
  }
  follow_from_here(x);
  return 1;
}

/* What happens at an instant: a limit angle ends the motion, friction holds or lets go. */
static void meet_events(Model *m) {
  Values *x = &m->now;
  char text[160];
  double z[N_EVENTS];
  indicators(x, &x->v[THETA], z);
  if ((z[0] <= 0.0 || z[1] <= 0.0) && !x->ended) {
    snprintf(text, sizeof text, "theta has reached the limit angle %.9g at t = %.9g: beyond it there is no mechanism",
             z[0] <= 0.0 ? x->first : x->last, x->v[0]);
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

static void differentiate(Values *x, double seed[N_VALUES]) {
  double slopes[N_SLOPES + 1], rows[N_OUTPUTS + 1] = {0.0}, by_alpha[N_OUTPUTS + 1] = {0.0}, alpha = 0.0;
  if (x->mode <= INITIALISING) {
    seed[THETA] = seed[THETA0];
    if (HAS_STATES) {
      seed[OMEGA] = seed[OMEGA_START];
    }
  } else if (!HAS_STATES) {
    seed[THETA] = seed[THETA0];
    if (!x->co_simulation) {
      seed[THETA] += 0.5 * ((x->base[2] + x->v[OMEGA]) * seed[0] + (x->v[0] - x->base[0]) * seed[OMEGA]);
    }
  }
  double v[N_VALUES];
  memcpy(v, x->v, sizeof v);
  seed_loads(&x->loads, v, seed);
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

/* ---- DOP853 (Hairer, Norsett, Wanner), for co-simulation: to the communication point, cut at events ---- */

static int rates(const Values *x, const double y[2], double f[2]) {
  f[0] = y[1];
  f[1] = 0.0;
  return x->way == 0.0 ? 0 : alpha_of(x, y, x->way, &f[1]);
}

/* One step of order 8; returns its error relative to the tolerance, NaN where there is none. */
static double trial(const Values *x, const double y[2], const double f[2], double h, double new_y[2]) {
  double K[13][2], fifth = 0.0, third = 0.0;
  memcpy(K[0], f, sizeof K[0]);
  for (int s = 1; s <= 12; s++) {
    for (int i = 0; i < 2; i++) {
      double total = 0.0;
      for (int j = 0; j < s; j++) {
        total += A[s - 1][j] * K[j][i];
      }
      new_y[i] = y[i] + h * total;
    }
    if (rates(x, new_y, K[s]) != 0) {
      return (double)NAN;
    }
  }
  for (int i = 0; i < 2; i++) {
    double of_fifth = 0.0, of_third = 0.0;
    for (int j = 0; j <= 12; j++) {
      of_fifth += E5[j] * K[j][i];
      of_third += E3[j] * K[j][i];
    }
    const double wide = fabs(y[i]) > fabs(new_y[i]) ? fabs(y[i]) : fabs(new_y[i]);
    const double scale = i == 0 ? 1e-3 * x->tolerance + 3e-14 * wide
                                : x->tolerance * (wide + 0.01 * fabs(h * f[1])) + 1e-300;
    fifth += of_fifth / scale * (of_fifth / scale);
    third += of_third / scale * (of_third / scale);
  }
  return fifth == 0.0 && third == 0.0 ? 0.0 : h * fifth / sqrt((fifth + 0.01 * third) * 2.0);
}

/* Cut a step where an event indicator changes its sign (Illinois); returns what is left of h. */
static double cut(const Values *x, const double y[2], const double f[2], double h, int which, double new_y[2]) {
  double z[N_EVENTS], low = 0.0, high = h, at_low, at_high, part = h;
  indicators(x, y, z);
  at_low = z[which] > 0.0 ? z[which] : 1e-300;
  indicators(x, new_y, z);
  at_high = z[which];
  for (int k = 0; k < 60 && high - low > 1e-15 * h && at_high != 0.0; k++) {
    part = low + (high - low) * (at_low / (at_low - at_high));
    if (!(part > low && part < high)) {
      part = 0.5 * (low + high);
    }
    double middle[2];
    (void)trial(x, y, f, part, middle);
    indicators(x, middle, z);
    if (z[which] > 0.0) {
      low = part;
      at_low = z[which];
      at_high *= 0.5;
    } else {
      high = part;
      at_high = z[which];
      at_low *= 0.5;
    }
  }
  (void)trial(x, y, f, high, new_y);
  return high;
}

/* To the communication point `end`, or to an event that ends the motion; returns whether it got there. */
static int advance(Model *m, double end) {
  Values *x = &m->now;
  char text[160];
  for (int steps = 0; x->v[0] < end && !x->ended; steps++) {
    double f[2], new_y[2], z[N_EVENTS], *y = &x->v[THETA];
    x->way = fabs(y[1]) > STANDS ? x->way : way_of(x);
    const int status = rates(x, y, f);
    if (status != 0 || steps > 1000000) {
      snprintf(text, sizeof text, "the integration failed at t = %.9g, theta = %.9g, omega = %.9g: %s", x->v[0], y[0],
               y[1], status != 0 ? REASONS[status] : "more than a million steps");
      tell(m, 1, text);
      return 0;
    }
    if (x->way == 0.0) {
      y[1] = 0.0; /* nothing moves until an input changes */
      x->v[0] = end;
      break;
    }
    const double left = end - x->v[0];
    double h = x->h > 0.0 && x->h < left ? x->h : left, error;
    for (;;) {
      error = trial(x, y, f, h, new_y);
      if (error < 1.0) {
        break;
      }
      h *= error > 0.0 && 0.9 * pow(error, -0.125) > 0.2 ? 0.9 * pow(error, -0.125) : 0.2;
      if (!(x->v[0] + h > x->v[0])) {
        tell(m, 1, "the integration failed: no step is short enough; perhaps no inertia is left at a dead centre");
        return 0;
      }
    }
    const double growth = error > 1e-9 ? 0.9 * pow(error, -0.125) : 10.0, whole = h;
    indicators(x, new_y, z);
    for (int k = 0; k < N_EVENTS; k++) {
      if (z[k] < 0.0) {
        h = cut(x, y, f, h, k, new_y);
        indicators(x, new_y, z);
      }
    }
    const int met = h < whole;
    if (met || h < left || !(x->h > 0.0)) {
      x->h = whole * (growth < 10.0 ? growth : 10.0);
    }
    y[0] = new_y[0];
    y[1] = met && has_way(x) && z[AT_REST] <= 0.0 ? 0.0 : new_y[1];
    x->v[0] = h < left ? x->v[0] + h : end;
    meet_events(m);
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
