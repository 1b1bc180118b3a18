/* The crank angles at which the mechanism can be assembled, from angles[0] to angles[1] and from angles[2] to
   angles[3], NaN where there is no such interval; one that crosses 2 pi goes on beyond it. Of in[] only the
   lengths are read. Status: 0 the crank turns fully, 1 it does not, 2 change point, 4 bad input. */
int @NAME@_limits(const double in[], double angles[4]);
