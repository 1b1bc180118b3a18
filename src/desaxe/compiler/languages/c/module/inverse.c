int @NAME@_inverse(double Y, double V_C, double a_C, const double in[], double theta[2], double omega[2],
    double alpha[2]) {
  @UNUSED@
  const int status = inverse_angles(@ANGLES@);
  for (int k = 0; k < 2; k++) {
    double turn[2], slope[2];
    sin_cos(theta[k], turn);
    inverse_slopes(@SLOPES@);
    const double along = status == 2 ? (double)NAN : slope[0];
    omega[k] = V_C / along;
    alpha[k] = (a_C - omega[k] * omega[k] * slope[1]) / along;
  }
  return status;
}
