/* The acceleration, out[0], while the crank turns one way; returns its status. */
static int motion_at(double torque, double theta, double omega, double way, const double in[],
                     double out[]) {
@LINES@
}
