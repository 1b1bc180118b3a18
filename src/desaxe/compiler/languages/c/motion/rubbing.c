/* The way in which the crank turns or starts from rest, 0 where friction holds it; returns a status. */
static int way_of(double torque, double theta, double omega, const double in[], double *way) {
  double ahead[1], back[1];
  *way = omega > 0.0 ? 1.0 : -1.0;
  if (!(omega == 0.0)) {
    return 0;
  }
  const int status = motion_at(torque, theta, omega, 1.0, in, ahead);
  const int other = motion_at(torque, theta, omega, -1.0, in, back);
  const int starts = status == 0 && ahead[0] > 0.0, returns = other == 0 && back[0] < 0.0;
  *way = starts ? 1.0 : (returns ? -1.0 : 0.0);
  return starts && returns ? 6 : (status < 5 ? status : 0);
}

int @NAME@_alpha(double torque, double theta, double omega, const double in[], double *alpha) {
  double way;
  int status = way_of(torque, theta, omega, in, &way);
  *alpha = 0.0;
  if (status == 0 && !(way == 0.0)) {
    status = motion_at(torque, theta, omega, way, in, alpha);
  }
  *alpha = status == 0 ? *alpha : (double)NAN;
  return status;
}
