for (size_t k = 0; k < count; k++) {
  @VALUE@
  (void)(@CALL@);
  @STORED@
}
