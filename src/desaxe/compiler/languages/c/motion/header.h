/* The crank's angular acceleration under a torque on it, positive like theta. Of in[], laid out as for
   @NAME@_point, lengths, masses, loads and friction are read. Returns the status; NaN where it is not 0. */
int @NAME@_alpha(double torque, double theta, double omega, const double in[], double *alpha);

/* One step of h >= 0 seconds, of fixed length and order 4, the torque held: theta and omega become those at
   its end. Returns the status; where it is not 0, both stay as they are. */
int @NAME@_step(double h, double torque, double *theta, double *omega, const double in[]);
