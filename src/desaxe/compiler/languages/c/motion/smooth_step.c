int @NAME@_step(double h, double torque, double *theta, double *omega, const double in[]@MORE@) {@CHECKS@
  double angle = *theta, speed = *omega;
  const int status = h >= 0.0 ? runge_kutta(h, torque, 0.0, &angle, &speed, in@THESE@) : 4;
  if (status == 0) {
    *theta = angle;
    *omega = speed;
  }
  return status;
}
