/* ---- the functions of FMI 3.0 ---- */

static void tell(Model *m, int failed, const char *text) {
  const fmi3LogMessageCallback log = (fmi3LogMessageCallback)m->log;
  if (log != NULL) {
    log((fmi3InstanceEnvironment)m->host, failed ? fmi3Error : fmi3Warning, failed ? "logStatusError" : "logEvents", text);
  }
}

static fmi3Status refuse(fmi3Instance instance, const char *text) {
  tell((Model *)instance, 1, text);
  return fmi3Error;
}

FMI3_Export const char *fmi3GetVersion(void) {
  return fmi3Version;
}

FMI3_Export fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String names[]) {
  (void)instance, (void)on, (void)n, (void)names;
  return fmi3OK;
}

static fmi3Instance instantiate(fmi3String name, fmi3String token, int co_simulation, fmi3InstanceEnvironment host,
                                fmi3LogMessageCallback log) {
  Model *m = (Model *)calloc(1, sizeof(Model));
  if (m == NULL) {
    return NULL;
  }
  start_values(&m->now);
  m->now.co_simulation = co_simulation;
  m->host = host;
  m->log = (Callback)log;
  snprintf(m->name, sizeof m->name, "%s", name != NULL ? name : "");
  if (token == NULL || strcmp(token, TOKEN) != 0) {
    tell(m, 1, "the instantiation token is not that of modelDescription.xml");
    free(m);
    return NULL;
  }
  return m;
}

FMI3_Export fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String path,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment host, fmi3LogMessageCallback log) {
  (void)path, (void)visible, (void)logging;
  return instantiate(name, token, 0, host, log);
}

FMI3_Export fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path,
                                                     fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                                     fmi3Boolean early, const fmi3ValueReference wanted[], size_t n,
                                                     fmi3InstanceEnvironment host, fmi3LogMessageCallback log,
                                                     fmi3IntermediateUpdateCallback update_call) {
  (void)path, (void)visible, (void)logging, (void)events, (void)wanted, (void)n, (void)update_call;
  Model *m = (Model *)instantiate(name, token, 1, host, log);
  if (m != NULL) {
    m->now.early = early ? 1 : 0;
  }
  return m;
}

FMI3_Export fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment host, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
  (void)name, (void)token, (void)path, (void)visible, (void)logging, (void)host, (void)log, (void)clock, (void)lock;
  (void)unlock;
  return NULL;
}

FMI3_Export void fmi3FreeInstance(fmi3Instance instance) {
  free(instance);
}

FMI3_Export fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                                   fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
  Values *x = &((Model *)instance)->now;
  (void)has_stop, (void)stop;
  if (x->mode != SETTING) {
    return refuse(instance, "fmi3EnterInitializationMode: not in this state");
  }
  set_tolerance(x, has_tolerance ? 1 : 0, tolerance);
  x->v[0] = start;
  x->mode = INITIALISING;
  x->known = 0;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  Values *x = &((Model *)instance)->now;
  if (x->mode != INITIALISING) {
    return refuse(instance, "fmi3ExitInitializationMode: not in this state");
  }
  if (!is_sound((Model *)instance)) {
    return fmi3Error;
  }
  x->mode = x->co_simulation ? STEPPING : EVENTS;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  enter_events(&((Model *)instance)->now);
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3Terminate(fmi3Instance instance) {
  ((Model *)instance)->now.mode = OVER;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3Reset(fmi3Instance instance) {
  Values *x = &((Model *)instance)->now;
  const int co_simulation = x->co_simulation, early = x->early;
  start_values(x);
  x->co_simulation = co_simulation;
  x->early = early;
  return fmi3OK;
}

/* ---- variables ---- */

FMI3_Export fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                      fmi3Float64 values[], size_t size) {
  return size == n && get_values((Model *)instance, places, n, values) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                      const fmi3Float64 values[], size_t size) {
  return size == n && set_values((Model *)instance, places, n, values) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                    fmi3Int32 values[], size_t size) {
  for (size_t k = 0; k < n && k < size; k++) {
    double value;
    if (!get_values((Model *)instance, &places[k], 1, &value)) {
      return fmi3Error;
    }
    values[k] = (fmi3Int32)value;
  }
  return fmi3OK;
}

#define UNUSED(NAME, TYPE)                                                                                             \
  FMI3_Export fmi3Status fmi3Get##NAME(fmi3Instance instance, const fmi3ValueReference places[], size_t n,             \
                                       TYPE values[], size_t size) {                                                   \
    (void)places, (void)values, (void)size;                                                                            \
    return n == 0 ? fmi3OK : refuse(instance, "fmi3Get" #NAME ": there is no variable of this type");                  \
  }                                                                                                                    \
  SET_UNUSED(NAME, TYPE)
#define SET_UNUSED(NAME, TYPE)                                                                                         \
  FMI3_Export fmi3Status fmi3Set##NAME(fmi3Instance instance, const fmi3ValueReference places[], size_t n,             \
                                       const TYPE values[], size_t size) {                                             \
    (void)places, (void)values, (void)size;                                                                            \
    return n == 0 ? fmi3OK : refuse(instance, "fmi3Set" #NAME ": there is no variable of this type to set");           \
  }
UNUSED(Float32, fmi3Float32)
UNUSED(Int8, fmi3Int8)
UNUSED(UInt8, fmi3UInt8)
UNUSED(Int16, fmi3Int16)
UNUSED(UInt16, fmi3UInt16)
SET_UNUSED(Int32, fmi3Int32)
UNUSED(UInt32, fmi3UInt32)
UNUSED(Int64, fmi3Int64)
UNUSED(UInt64, fmi3UInt64)
UNUSED(Boolean, fmi3Boolean)
UNUSED(String, fmi3String)

FMI3_Export fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference places[], size_t n, size_t sizes[],
                                     fmi3Binary values[], size_t size) {
  (void)places, (void)sizes, (void)values, (void)size;
  return n == 0 ? fmi3OK : refuse(instance, "fmi3GetBinary: there is no variable of this type");
}

FMI3_Export fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                     const size_t sizes[], const fmi3Binary values[], size_t size) {
  (void)places, (void)sizes, (void)values, (void)size;
  return n == 0 ? fmi3OK : refuse(instance, "fmi3SetBinary: there is no variable of this type");
}

FMI3_Export fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                    fmi3Clock values[]) {
  (void)places, (void)values;
  return n == 0 ? fmi3OK : refuse(instance, "fmi3GetClock: there are no clocks");
}

FMI3_Export fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference places[], size_t n,
                                    const fmi3Clock values[]) {
  (void)places, (void)values;
  return n == 0 ? fmi3OK : refuse(instance, "fmi3SetClock: there are no clocks");
}

#define NOT_HERE(NAME, ...)                                                                                            \
  FMI3_Export fmi3Status fmi3##NAME(fmi3Instance instance, __VA_ARGS__)
NOT_HERE(GetNumberOfVariableDependencies, fmi3ValueReference place, size_t *n) {
  (void)place, (void)n;
  return refuse(instance, "fmi3GetNumberOfVariableDependencies: not provided");
}
NOT_HERE(GetVariableDependencies, fmi3ValueReference place, size_t of[], fmi3ValueReference by[], size_t which[],
         fmi3DependencyKind kinds[], size_t n) {
  (void)place, (void)of, (void)by, (void)which, (void)kinds, (void)n;
  return refuse(instance, "fmi3GetVariableDependencies: not provided");
}
NOT_HERE(GetAdjointDerivative, const fmi3ValueReference of[], size_t n_of, const fmi3ValueReference by[], size_t n_by,
         const fmi3Float64 seed[], size_t n_seed, fmi3Float64 found[], size_t n_found) {
  (void)of, (void)n_of, (void)by, (void)n_by, (void)seed, (void)n_seed, (void)found, (void)n_found;
  return refuse(instance, "fmi3GetAdjointDerivative: not provided");
}
NOT_HERE(GetIntervalDecimal, const fmi3ValueReference places[], size_t n, fmi3Float64 intervals[],
         fmi3IntervalQualifier qualifiers[]) {
  (void)places, (void)n, (void)intervals, (void)qualifiers;
  return refuse(instance, "fmi3GetIntervalDecimal: there are no clocks");
}
NOT_HERE(GetIntervalFraction, const fmi3ValueReference places[], size_t n, fmi3UInt64 counters[],
         fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]) {
  (void)places, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
  return refuse(instance, "fmi3GetIntervalFraction: there are no clocks");
}
NOT_HERE(GetShiftDecimal, const fmi3ValueReference places[], size_t n, fmi3Float64 shifts[]) {
  (void)places, (void)n, (void)shifts;
  return refuse(instance, "fmi3GetShiftDecimal: there are no clocks");
}
NOT_HERE(GetShiftFraction, const fmi3ValueReference places[], size_t n, fmi3UInt64 counters[],
         fmi3UInt64 resolutions[]) {
  (void)places, (void)n, (void)counters, (void)resolutions;
  return refuse(instance, "fmi3GetShiftFraction: there are no clocks");
}
NOT_HERE(SetIntervalDecimal, const fmi3ValueReference places[], size_t n, const fmi3Float64 intervals[]) {
  (void)places, (void)n, (void)intervals;
  return refuse(instance, "fmi3SetIntervalDecimal: there are no clocks");
}
NOT_HERE(SetIntervalFraction, const fmi3ValueReference places[], size_t n, const fmi3UInt64 counters[],
         const fmi3UInt64 resolutions[]) {
  (void)places, (void)n, (void)counters, (void)resolutions;
  return refuse(instance, "fmi3SetIntervalFraction: there are no clocks");
}
NOT_HERE(SetShiftDecimal, const fmi3ValueReference places[], size_t n, const fmi3Float64 shifts[]) {
  (void)places, (void)n, (void)shifts;
  return refuse(instance, "fmi3SetShiftDecimal: there are no clocks");
}
NOT_HERE(SetShiftFraction, const fmi3ValueReference places[], size_t n, const fmi3UInt64 counters[],
         const fmi3UInt64 resolutions[]) {
  (void)places, (void)n, (void)counters, (void)resolutions;
  return refuse(instance, "fmi3SetShiftFraction: there are no clocks");
}
NOT_HERE(ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time) {
  (void)clock, (void)time;
  return refuse(instance, "fmi3ActivateModelPartition: there are no clocks");
}
NOT_HERE(GetOutputDerivatives, const fmi3ValueReference places[], size_t n, const fmi3Int32 orders[],
         fmi3Float64 values[], size_t size) {
  (void)places, (void)n, (void)orders, (void)values, (void)size;
  return refuse(instance, "fmi3GetOutputDerivatives: not provided");
}

/* ---- the state of an instance ---- */

FMI3_Export fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  *state = copy_of(&((Model *)instance)->now, (Values *)*state);
  return *state != NULL ? fmi3OK : refuse(instance, "fmi3GetFMUState: no memory");
}

FMI3_Export fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  memcpy(&((Model *)instance)->now, state, sizeof(Values));
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  (void)instance;
  free(*state);
  *state = NULL;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
  (void)instance, (void)state;
  *size = sizeof(Values);
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  if (size < sizeof(Values)) {
    return refuse(instance, "fmi3SerializeFMUState: too few bytes");
  }
  memcpy(bytes, state, sizeof(Values));
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                               fmi3FMUState *state) {
  if (size != sizeof(Values)) {
    return refuse(instance, "fmi3DeserializeFMUState: not a state of this model");
  }
  *state = copy_of(bytes, (Values *)*state);
  return *state != NULL ? fmi3OK : refuse(instance, "fmi3DeserializeFMUState: no memory");
}

FMI3_Export fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference of[], size_t n_of,
                                                    const fmi3ValueReference by[], size_t n_by,
                                                    const fmi3Float64 seed[], size_t n_seed, fmi3Float64 found[],
                                                    size_t n_found) {
  (void)n_seed, (void)n_found;
  return directional((Model *)instance, of, n_of, by, n_by, seed, found) ? fmi3OK : fmi3Error;
}

/* ---- model exchange ---- */

FMI3_Export fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return refuse(instance, "fmi3EnterConfigurationMode: there are no structural parameters");
}

FMI3_Export fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return refuse(instance, "fmi3ExitConfigurationMode: there are no structural parameters");
}

FMI3_Export fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *terminate,
                                                fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *has_next,
                                                fmi3Float64 *next) {
  Values *x = &((Model *)instance)->now;
  const double before = x->v[OMEGA];
  meet_events((Model *)instance);
  *again = fmi3False;
  *terminate = x->ended != 0;
  *nominals = fmi3False;
  *values = x->v[OMEGA] < before || x->v[OMEGA] > before;
  *has_next = fmi3False;
  *next = 0.0;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  enter_continuous(&((Model *)instance)->now);
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean keeps, fmi3Boolean *event,
                                                   fmi3Boolean *terminate) {
  (void)keeps;
  step_completed(&((Model *)instance)->now);
  *event = fmi3False;
  *terminate = fmi3False;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  Values *x = &((Model *)instance)->now;
  x->v[0] = time;
  x->known = 0;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t n) {
  return set_states((Model *)instance, states, n) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 rates_now[], size_t n) {
  return get_rates((Model *)instance, rates_now, n) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 z[], size_t n) {
  return get_indicators((Model *)instance, z, n) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], size_t n) {
  return get_states((Model *)instance, states, n) ? fmi3OK : fmi3Error;
}

FMI3_Export fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 sizes[], size_t n) {
  (void)instance;
  for (size_t k = 0; k < n; k++) {
    sizes[k] = NOMINAL;
  }
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n) {
  (void)instance;
  *n = N_EVENTS;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n) {
  (void)instance;
  *n = HAS_STATES ? 2 : 0;
  return fmi3OK;
}

/* ---- co-simulation ---- */

FMI3_Export fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  ((Model *)instance)->now.mode = STEPPING;
  return fmi3OK;
}

FMI3_Export fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 start, fmi3Float64 h, fmi3Boolean keeps,
                                  fmi3Boolean *events, fmi3Boolean *terminate, fmi3Boolean *early,
                                  fmi3Float64 *reached) {
  Model *m = (Model *)instance;
  (void)keeps;
  const int done = m->now.mode == STEPPING && do_step(m, start, h);
  *events = fmi3False;
  *terminate = m->now.ended != 0;
  *early = m->now.ended && m->now.early && m->now.v[0] < start + h;
  *reached = m->now.v[0];
  return done ? fmi3OK : fmi3Error;
}
