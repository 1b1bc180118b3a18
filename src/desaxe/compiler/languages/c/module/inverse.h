/* The crank angles theta[0] <= theta[1] in (-pi, pi] that put the slider at Y, NaN where there is none, and
   the crank's speed and acceleration there for the slider's V_C and a_C (NaN at a dead centre). Of in[], laid
   out as for @NAME@_point, only the lengths are read. Status: 0 one or two angles, 1 none, 2 dead centre,
   4 bad input. */
int @NAME@_inverse(double Y, double V_C, double a_C, const double in[], double theta[2], double omega[2],
    double alpha[2]);
