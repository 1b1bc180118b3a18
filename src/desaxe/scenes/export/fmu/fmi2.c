/* ---- the functions of FMI 2.0 ---- */

static void tell(Model *m, int failed, const char *text) {
  const fmi2CallbackLogger log = (fmi2CallbackLogger)m->log;
  if (log != NULL) {
    log(m->host, m->name, failed ? fmi2Error : fmi2Warning, failed ? "logStatusError" : "logEvents", "%s", text);
  }
}

static fmi2Status refuse(fmi2Component c, const char *text) {
  tell((Model *)c, 1, text);
  return fmi2Error;
}

static Values *values_of(fmi2Component c) {
  return &((Model *)c)->now;
}

/* The values, outputs up to date. */
static Values *updated(fmi2Component c) {
  Values *x = values_of(c);
  if (!x->known) {
    (void)update(x);
  }
  return x;
}

#define IS_PARAMETER(PLACE) ((PLACE) >= FIRST_PARAMETER && (PLACE) < FIRST_PARAMETER + N_PARAMETERS)
#define IS_INPUT(PLACE) ((PLACE) >= FIRST_INPUT && (PLACE) < FIRST_INPUT + N_INPUTS)

FMI2_Export const char *fmi2GetTypesPlatform(void) {
  return fmi2TypesPlatform;
}

FMI2_Export const char *fmi2GetVersion(void) {
  return fmi2Version;
}

FMI2_Export fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
  (void)c, (void)on, (void)n, (void)names;
  return fmi2OK;
}

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String path,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  Model *m = (Model *)calloc(1, sizeof(Model));
  (void)path, (void)visible, (void)logging;
  if (m == NULL) {
    return NULL;
  }
  start_values(&m->now);
  m->now.co_simulation = type == fmi2CoSimulation;
  m->host = functions != NULL ? functions->componentEnvironment : NULL;
  m->log = functions != NULL ? (Callback)functions->logger : NULL;
  snprintf(m->name, sizeof m->name, "%s", name != NULL ? name : "");
  if (token == NULL || strcmp(token, TOKEN) != 0) {
    tell(m, 1, "the GUID is not that of modelDescription.xml");
    free(m);
    return NULL;
  }
  return m;
}

FMI2_Export void fmi2FreeInstance(fmi2Component c) {
  free(c);
}

FMI2_Export fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  Values *x = values_of(c);
  (void)has_stop, (void)stop;
  if (has_tolerance != fmi2False && tolerance < x->tolerance) {
    x->tolerance = tolerance > 3e-14 ? tolerance : 3e-14;
  }
  x->v[0] = start;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  Values *x = values_of(c);
  if (x->mode != SETTING) {
    return refuse(c, "fmi2EnterInitializationMode: not in this state");
  }
  x->mode = INITIALISING;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  Values *x = values_of(c);
  if (x->mode != INITIALISING) {
    return refuse(c, "fmi2ExitInitializationMode: not in this state");
  }
  if (!is_sound((Model *)c)) {
    return fmi2Error;
  }
  x->mode = x->co_simulation ? STEPPING : EVENTS;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2Terminate(fmi2Component c) {
  values_of(c)->mode = OVER;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2Reset(fmi2Component c) {
  Values *x = values_of(c);
  const int co_simulation = x->co_simulation;
  start_values(x);
  x->co_simulation = co_simulation;
  return fmi2OK;
}

/* ---- variables ---- */

FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference places[], size_t n, fmi2Real values[]) {
  const Values *x = updated(c);
  for (size_t k = 0; k < n; k++) {
    if (places[k] >= N_VALUES) {
      return refuse(c, "there is no variable with this value reference");
    }
    values[k] = x->v[places[k]];
  }
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                   const fmi2Real values[]) {
  Values *x = values_of(c);
  for (size_t k = 0; k < n; k++) {
    if (!IS_INPUT(places[k]) && !(IS_PARAMETER(places[k]) && x->mode <= INITIALISING)) {
      return refuse(c, IS_PARAMETER(places[k]) ? "a parameter is set before initialisation mode is left"
                                               : "only parameters and inputs can be set");
    }
    x->v[places[k]] = values[k];
  }
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                      fmi2Integer values[]) {
  fmi2Status done = fmi2OK;
  for (size_t k = 0; k < n && done == fmi2OK; k++) {
    double value = 0.0;
    done = fmi2GetReal(c, &places[k], 1, &value);
    values[k] = (fmi2Integer)value;
  }
  return done;
}

#define UNUSED(NAME, TYPE)                                                                                     \
  FMI2_Export fmi2Status NAME(fmi2Component c, const fmi2ValueReference places[], size_t n, TYPE values[]) {   \
    (void)places, (void)values;                                                                                \
    return n == 0 ? fmi2OK : refuse(c, #NAME ": there is no variable of this type");                           \
  }
UNUSED(fmi2SetInteger, const fmi2Integer)
UNUSED(fmi2GetBoolean, fmi2Boolean)
UNUSED(fmi2SetBoolean, const fmi2Boolean)
UNUSED(fmi2GetString, fmi2String)
UNUSED(fmi2SetString, const fmi2String)

/* By inputs, states (parameters before initialisation mode is left, as the table of knowns has it) and time. */
FMI2_Export fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference of[], size_t n_of,
                                                    const fmi2ValueReference by[], size_t n_by,
                                                    const fmi2Real seed[], fmi2Real slopes[]) {
  const Values *x = updated(c);
  double seeds[N_VALUES] = {0.0};
  for (size_t k = 0; k < n_by; k++) {
    const int is_state = HAS_STATES && (by[k] == THETA || by[k] == OMEGA) && x->mode > INITIALISING;
    if (!is_state && !IS_INPUT(by[k]) && !IS_PARAMETER(by[k]) && by[k] != 0) {
      return refuse(c, "a directional derivative is by inputs, continuous states, parameters and time");
    }
    seeds[by[k]] += seed[k];
  }
  differentiate(x, seeds);
  for (size_t k = 0; k < n_of; k++) {
    if (of[k] >= N_VALUES) {
      return refuse(c, "there is no variable with this value reference");
    }
    slopes[k] = seeds[of[k]];
  }
  return fmi2OK;
}

/* ---- the state of an instance ---- */

static fmi2Status copy_to(fmi2Component c, const void *from, fmi2FMUstate *state) {
  *state = *state != NULL ? *state : malloc(sizeof(Values));
  if (*state == NULL) {
    return refuse(c, "a state of the FMU: no memory");
  }
  memcpy(*state, from, sizeof(Values));
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
  return copy_to(c, values_of(c), state);
}

FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(values_of(c), state, sizeof(Values));
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
  (void)c;
  free(*state);
  *state = NULL;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
  (void)c, (void)state;
  *size = sizeof(Values);
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  if (size < sizeof(Values)) {
    return refuse(c, "fmi2SerializeFMUstate: too few bytes");
  }
  memcpy(bytes, state, sizeof(Values));
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
  return size == sizeof(Values) ? copy_to(c, bytes, state)
                                : refuse(c, "fmi2DeSerializeFMUstate: not a state of this model");
}

/* ---- model exchange ---- */

static void follow(Values *x) {
  if (!HAS_STATES && !x->co_simulation) {
    x->v[THETA] = followed(x);
    follow_from_here(x);
  }
  x->known = 0;
}

FMI2_Export fmi2Status fmi2EnterEventMode(fmi2Component c) {
  follow(values_of(c));
  values_of(c)->mode = EVENTS;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
  Values *x = values_of(c);
  const double before = x->v[OMEGA];
  meet_events((Model *)c);
  memset(info, 0, sizeof *info);
  info->terminateSimulation = x->ended != 0;
  info->valuesOfContinuousStatesChanged = x->v[OMEGA] < before || x->v[OMEGA] > before;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  Values *x = values_of(c);
  x->base[2] = HAS_STATES ? 0.0 : x->v[OMEGA];
  x->mode = CONTINUOUS;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean keeps, fmi2Boolean *event,
                                                   fmi2Boolean *terminate) {
  (void)keeps;
  follow(values_of(c));
  *event = fmi2False;
  *terminate = fmi2False;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  Values *x = values_of(c);
  x->v[0] = time;
  x->known = 0;
  return fmi2OK;
}

/* Copy the states or their derivatives. */
static fmi2Status copied(double to[], const double from[], size_t n) {
  const size_t most = HAS_STATES ? 2 : 0;
  for (size_t k = 0; k < n && k < most; k++) {
    to[k] = from[k];
  }
  return n == most ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real states[], size_t n) {
  values_of(c)->known = 0;
  return copied(&values_of(c)->v[THETA], states, n);
}

FMI2_Export fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real states[], size_t n) {
  return copied(states, &updated(c)->v[THETA], n);
}

FMI2_Export fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real rates[], size_t n) {
  Values *x = values_of(c);
  const int status = update(x);
  if (status != 0 && n > 0) {
    char text[160];
    snprintf(text, sizeof text, "no acceleration at t = %.9g, theta = %.9g: %s", x->v[0], x->v[THETA], REASONS[status]);
    return refuse(c, text);
  }
  return copied(rates, &x->v[DER_THETA], n);
}

FMI2_Export fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n) {
  const Values *x = updated(c);
  if (n == N_EVENTS) {
    indicators(x, &x->v[THETA], z);
  }
  return n == N_EVENTS ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real sizes[], size_t n) {
  (void)c;
  for (size_t k = 0; k < n; k++) {
    sizes[k] = NOMINAL;
  }
  return fmi2OK;
}

/* ---- co-simulation ---- */

#define NOT_PROVIDED(NAME, TYPE)                                                                               \
  FMI2_Export fmi2Status NAME(fmi2Component c, const fmi2ValueReference places[], size_t n,                    \
                              const fmi2Integer orders[], TYPE values[]) {                                     \
    (void)places, (void)n, (void)orders, (void)values;                                                         \
    return refuse(c, #NAME ": inputs are held during a step");                                                 \
  }
NOT_PROVIDED(fmi2SetRealInputDerivatives, const fmi2Real)
NOT_PROVIDED(fmi2GetRealOutputDerivatives, fmi2Real)

FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real start, fmi2Real h, fmi2Boolean keeps) {
  const Values *x = values_of(c);
  (void)keeps;
  if (x->mode != STEPPING || !do_step((Model *)c, start, h)) {
    return fmi2Error;
  }
  return x->ended ? fmi2Discard : fmi2OK; /* and fmi2Terminated says why */
}

FMI2_Export fmi2Status fmi2CancelStep(fmi2Component c) {
  return refuse(c, "fmi2CancelStep: no step is pending");
}

FMI2_Export fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
  (void)kind;
  *value = values_of(c)->ended ? fmi2Discard : fmi2OK;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
  *value = values_of(c)->v[0];
  return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
  *value = values_of(c)->ended ? fmi2True : fmi2False;
  return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define NO_STATUS(NAME)                                                                                       \
  FMI2_Export fmi2Status fmi2Get##NAME##Status(fmi2Component c, const fmi2StatusKind kind, fmi2##NAME *value) { \
    (void)c, (void)kind, (void)value;                                                                         \
    return fmi2Discard;                                                                                       \
  }
NO_STATUS(Integer)
NO_STATUS(String)
