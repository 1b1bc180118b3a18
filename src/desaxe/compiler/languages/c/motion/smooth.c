int @NAME@_alpha(double torque, double theta, double omega, const double in[], double *alpha) {
  const int status = motion_at(torque, theta, omega, 0.0, in, alpha);
  *alpha = status == 0 ? *alpha : (double)NAN;
  return status;
}
