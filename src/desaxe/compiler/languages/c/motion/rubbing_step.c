int @NAME@_step(double h, double torque, double *theta, double *omega, const double in[]) {
  double angle = *theta, speed = *omega, left = h;
  for (int turns = 0; turns < 3; turns++) {
    double way, end = angle, last = speed;
    int status = h >= 0.0 ? way_of(torque, angle, speed, in, &way) : 4;
    if (status == 0 && way == 0.0) {
      break;
    }
    status = status == 0 ? runge_kutta(left, torque, way, &end, &last, in) : status;
    double low = 0.0, high = left, at_low = speed, at_high = last, part = left;
    /* Where the speed changes its sign, by the Illinois rule. */
    for (int k = 0; status == 0 && at_high * way < 0.0 && k < 20 && high - low > 1e-15 * h; k++) {
      part = low + (high - low) * (at_low / (at_low - at_high));
      end = angle;
      last = speed;
      status = runge_kutta(part, torque, way, &end, &last, in);
      if (last * way > 0.0) {
        low = part;
        at_low = last;
        at_high *= 0.5;
      } else {
        high = part;
        at_high = last;
        at_low *= 0.5;
      }
    }
    if (status != 0) {
      return status;
    }
    angle = end;
    left -= part;
    speed = left > 0.0 ? 0.0 : last;
    if (!(left > 0.0)) {
      break;
    }
  }
  *theta = angle;
  *omega = speed;
  return 0;
}
