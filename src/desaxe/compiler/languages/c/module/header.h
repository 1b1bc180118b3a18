@COMMENT@
#ifndef @GUARD@
#define @GUARD@

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One point; returns its status. */
int @NAME@_point(const double in[], double out[]);

/* n points: in[k] and out[k] are arrays. What is written shares no memory with anything else. */
void @NAME@_array(size_t n, const double *const in[], double *const out[]);

@FUNCTIONS@
/* Names and SI units, in order; NULL at the end. */
extern const char *const @NAME@_inputs[];
extern const char *const @NAME@_input_units[];
extern const char *const @NAME@_outputs[];
extern const char *const @NAME@_output_units[];

#ifdef __cplusplus
}
#endif

#endif
