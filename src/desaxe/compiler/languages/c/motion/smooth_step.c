int @NAME@_step(double h, double torque, double *theta, double *omega, const double in[]) {
  double angle = *theta, speed = *omega;
  const int status = h >= 0.0 ? runge_kutta(h, torque, 0.0, &angle, &speed, in) : 4;
  if (status == 0) {
    *theta = angle;
    *omega = speed;
  }
  return status;
}
