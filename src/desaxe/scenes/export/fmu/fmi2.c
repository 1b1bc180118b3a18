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
  Values *x = &((Model *)c)->now;
  (void)has_stop, (void)stop;
  set_tolerance(x, has_tolerance != fmi2False, tolerance);
  x->v[0] = start;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  Values *x = &((Model *)c)->now;
  if (x->mode != SETTING) {
    return refuse(c, "fmi2EnterInitializationMode: not in this state");
  }
  x->mode = INITIALISING;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  Values *x = &((Model *)c)->now;
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
  ((Model *)c)->now.mode = OVER;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2Reset(fmi2Component c) {
  Values *x = &((Model *)c)->now;
  const int co_simulation = x->co_simulation;
  start_values(x);
  x->co_simulation = co_simulation;
  return fmi2OK;
}

/* ---- variables ---- */

FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference places[], size_t n, fmi2Real values[]) {
  return get_values((Model *)c, places, n, values) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                   const fmi2Real values[]) {
  return set_values((Model *)c, places, n, values) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                      fmi2Integer values[]) {
  for (size_t k = 0; k < n; k++) {
    double value;
    if (!get_values((Model *)c, &places[k], 1, &value)) {
      return fmi2Error;
    }
    values[k] = (fmi2Integer)value;
  }
  return fmi2OK;
}

#define SET_UNUSED(NAME, TYPE)                                                                                \
  FMI2_Export fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference places[], size_t n,          \
                                       const TYPE values[]) {                                                 \
    (void)places, (void)values;                                                                               \
    return n == 0 ? fmi2OK : refuse(c, "fmi2Set" #NAME ": there is no variable of this type to set");         \
  }
#define UNUSED(NAME, TYPE)                                                                                    \
  FMI2_Export fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference places[], size_t n,          \
                                       TYPE values[]) {                                                       \
    (void)places, (void)values;                                                                               \
    return n == 0 ? fmi2OK : refuse(c, "fmi2Get" #NAME ": there is no variable of this type");                \
  }                                                                                                           \
  SET_UNUSED(NAME, TYPE)
SET_UNUSED(Integer, fmi2Integer)
UNUSED(Boolean, fmi2Boolean)
UNUSED(String, fmi2String)

/* ---- the state of an instance ---- */

FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
  *state = copy_of(&((Model *)c)->now, (Values *)*state);
  return *state != NULL ? fmi2OK : refuse(c, "fmi2GetFMUstate: no memory");
}

FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(&((Model *)c)->now, state, sizeof(Values));
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
  if (size != sizeof(Values)) {
    return refuse(c, "fmi2DeSerializeFMUstate: not a state of this model");
  }
  *state = copy_of(bytes, (Values *)*state);
  return *state != NULL ? fmi2OK : refuse(c, "fmi2DeSerializeFMUstate: no memory");
}

FMI2_Export fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference of[], size_t n_of,
                                                    const fmi2ValueReference by[], size_t n_by,
                                                    const fmi2Real seed[], fmi2Real found[]) {
  return directional((Model *)c, of, n_of, by, n_by, seed, found) ? fmi2OK : fmi2Error;
}

/* ---- model exchange ---- */

FMI2_Export fmi2Status fmi2EnterEventMode(fmi2Component c) {
  enter_events(&((Model *)c)->now);
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
  Values *x = &((Model *)c)->now;
  const double before = x->v[OMEGA];
  meet_events((Model *)c);
  info->newDiscreteStatesNeeded = fmi2False;
  info->terminateSimulation = x->ended != 0;
  info->nominalsOfContinuousStatesChanged = fmi2False;
  info->valuesOfContinuousStatesChanged = x->v[OMEGA] < before || x->v[OMEGA] > before;
  info->nextEventTimeDefined = fmi2False;
  info->nextEventTime = 0.0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  enter_continuous(&((Model *)c)->now);
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean keeps, fmi2Boolean *event,
                                                   fmi2Boolean *terminate) {
  (void)keeps;
  step_completed(&((Model *)c)->now);
  *event = fmi2False;
  *terminate = fmi2False;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  Values *x = &((Model *)c)->now;
  x->v[0] = time;
  x->known = 0;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real states[], size_t n) {
  return set_states((Model *)c, states, n) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real rates_now[], size_t n) {
  return get_rates((Model *)c, rates_now, n) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n) {
  return get_indicators((Model *)c, z, n) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real states[], size_t n) {
  return get_states((Model *)c, states, n) ? fmi2OK : fmi2Error;
}

FMI2_Export fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real sizes[], size_t n) {
  (void)c;
  for (size_t k = 0; k < n; k++) {
    sizes[k] = NOMINAL;
  }
  return fmi2OK;
}

/* ---- co-simulation ---- */

FMI2_Export fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                                   const fmi2Integer orders[], const fmi2Real values[]) {
  (void)places, (void)n, (void)orders, (void)values;
  return refuse(c, "fmi2SetRealInputDerivatives: inputs are held during a step");
}

FMI2_Export fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference places[], size_t n,
                                                    const fmi2Integer orders[], fmi2Real values[]) {
  (void)places, (void)n, (void)orders, (void)values;
  return refuse(c, "fmi2GetRealOutputDerivatives: not provided");
}

FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real start, fmi2Real h, fmi2Boolean keeps) {
  Model *m = (Model *)c;
  (void)keeps;
  if (m->now.mode != STEPPING || !do_step(m, start, h)) {
    return fmi2Error;
  }
  return m->now.ended ? fmi2Discard : fmi2OK; /* and fmi2Terminated says why */
}

FMI2_Export fmi2Status fmi2CancelStep(fmi2Component c) {
  return refuse(c, "fmi2CancelStep: no step is pending");
}

FMI2_Export fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
  (void)kind;
  *value = ((Model *)c)->now.ended ? fmi2Discard : fmi2OK;
  return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
  (void)kind;
  *value = ((Model *)c)->now.v[0];
  return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
  *value = ((Model *)c)->now.ended ? fmi2True : fmi2False;
  return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

FMI2_Export fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}
