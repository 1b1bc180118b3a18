/* The state after a step, the way of turning held; returns the status. */
static int runge_kutta(double h, double torque, double way, double *theta, double *omega,
                       const double in[]) {
  const double parts[4] = {0.0, 0.5, 0.5, 1.0};
  double speed[4], slope[4];
  for (int k = 0; k < 4; k++) {
    const double part = h * parts[k];
    const double angle = *theta + (k > 0 ? part * speed[k - 1] : 0.0);
    speed[k] = *omega + (k > 0 ? part * slope[k - 1] : 0.0);
    const int status = motion_at(torque, angle, speed[k], way, in, &slope[k]);
    if (status != 0) {
      return status;
    }
  }
  *theta += h / 6.0 * (speed[0] + 2.0 * (speed[1] + speed[2]) + speed[3]);
  *omega += h / 6.0 * (slope[0] + 2.0 * (slope[1] + slope[2]) + slope[3]);
  return fabs(*theta) < (double)INFINITY && fabs(*omega) < (double)INFINITY ? 0 : 4;
}
