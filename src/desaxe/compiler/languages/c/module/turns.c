double sines_@K@[@STRIP@], cosines_@K@[@STRIP@];
int far_@K@ = 0;
for (size_t k = 0; k < count; k++) {
  far_@K@ |= !(fabs(@ANGLE@[k]) <= @LIMIT@);
}
for (size_t k = 0; k < count; k++) {
  double turn[2];
  near_sin_cos(@ANGLE@[k], turn);
  sines_@K@[k] = turn[0];
  cosines_@K@[k] = turn[1];
}
for (size_t k = 0; far_@K@ && k < count; k++) {
  double turn[2];
  sin_cos(@ANGLE@[k], turn);
  sines_@K@[k] = turn[0];
  cosines_@K@[k] = turn[1];
}
