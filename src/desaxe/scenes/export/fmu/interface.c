/* ---- what both versions of the interface share ---- */

static void set_tolerance(Values *x, int given, double tolerance) {
  if (given && tolerance < 1e-10) {
    x->tolerance = tolerance > 3e-14 ? tolerance : 3e-14;
  }
}

static int get_values(Model *m, const Place places[], size_t n, double values[]) {
  Values *x = &m->now;
  if (!x->known) {
    (void)update(x);
  }
  for (size_t k = 0; k < n; k++) {
    if (places[k] >= N_VALUES) {
      tell(m, 1, "there is no variable with this value reference");
      return 0;
    }
    values[k] = x->v[places[k]];
  }
  return 1;
}

static int is_parameter(Place place) {
  return place >= FIRST_PARAMETER && place < FIRST_PARAMETER + N_PARAMETERS;
}

static int is_input(Place place) {
  return place >= FIRST_INPUT && place < FIRST_INPUT + N_INPUTS;
}

static int set_values(Model *m, const Place places[], size_t n, const double values[]) {
  Values *x = &m->now;
  for (size_t k = 0; k < n; k++) {
    if (!is_input(places[k]) && !(is_parameter(places[k]) && x->mode <= INITIALISING)) {
      tell(m, 1, is_parameter(places[k]) ? "a parameter is set before initialisation mode is left"
                                         : "only parameters and inputs can be set");
      return 0;
    }
    x->v[places[k]] = values[k];
  }
  x->known = 0;
  return 1;
}

static void enter_events(Values *x) {
  if (!HAS_STATES && !x->co_simulation) {
    x->v[THETA] = followed(x);
    follow_from_here(x);
  }
  x->mode = EVENTS;
  x->known = 0;
}

static void enter_continuous(Values *x) {
  x->base[2] = HAS_STATES ? 0.0 : x->v[OMEGA];
  x->mode = CONTINUOUS;
  x->known = 0;
}

static void step_completed(Values *x) {
  if (!HAS_STATES) {
    x->v[THETA] = followed(x);
    follow_from_here(x);
    x->known = 0;
  }
}

static int set_states(Model *m, const double states[], size_t n) {
  for (size_t k = 0; k < n && k < 2 && HAS_STATES; k++) {
    m->now.v[THETA + k] = states[k];
  }
  m->now.known = 0;
  return n == (HAS_STATES ? 2 : 0);
}

static int get_states(Model *m, double states[], size_t n) {
  if (!m->now.known) {
    (void)update(&m->now);
  }
  for (size_t k = 0; k < n && k < 2; k++) {
    states[k] = m->now.v[THETA + k];
  }
  return n == (HAS_STATES ? 2 : 0);
}

static int get_rates(Model *m, double rates_now[], size_t n) {
  char text[160];
  const int status = update(&m->now);
  if (status != 0 && n > 0) {
    snprintf(text, sizeof text, "no acceleration at t = %.9g, theta = %.9g: %s", m->now.v[0], m->now.v[THETA],
             REASONS[status]);
    tell(m, 1, text);
    return 0;
  }
  for (size_t k = 0; k < n && k < 2 && HAS_STATES; k++) {
    rates_now[k] = m->now.v[DER_THETA + k];
  }
  return n == (HAS_STATES ? 2 : 0);
}

static int get_indicators(Model *m, double z[], size_t n) {
  if (!m->now.known) {
    (void)update(&m->now);
  }
  for (size_t k = 0; k < n && k < N_EVENTS; k++) {
    z[k] = m->now.v[INDICATORS + k];
  }
  return n == N_EVENTS;
}

static Values *copy_of(const void *from, Values *place) {
  Values *copy = place != NULL ? place : (Values *)malloc(sizeof(Values));
  if (copy != NULL) {
    memcpy(copy, from, sizeof(Values));
  }
  return copy;
}

/* By inputs, states (parameters before initialisation mode is left, as the table of knowns has it) and time. */
static int directional(Model *m, const Place of[], size_t n_of, const Place by[], size_t n_by, const double seed[],
                       double found[]) {
  double seeds[N_VALUES] = {0.0};
  if (!m->now.known) {
    (void)update(&m->now);
  }
  for (size_t k = 0; k < n_by; k++) {
    const int is_state = HAS_STATES && (by[k] == THETA || by[k] == OMEGA) && m->now.mode > INITIALISING;
    if (!is_state && !is_input(by[k]) && !is_parameter(by[k]) && by[k] != 0) {
      tell(m, 1, "a directional derivative is by inputs, continuous states, parameters and time");
      return 0;
    }
    seeds[by[k]] += seed[k];
  }
  differentiate(&m->now, seeds);
  for (size_t k = 0; k < n_of; k++) {
    if (of[k] >= N_VALUES) {
      tell(m, 1, "there is no variable with this value reference");
      return 0;
    }
    found[k] = seeds[of[k]];
  }
  return 1;
}
