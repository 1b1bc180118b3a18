size_t wide = 0;
for (size_t k = 0; k < count; k++) {
  wide += (size_t)has_wide_margins(@TEST@);
}
if (wide == count) {
  @PLAIN@
} else if (wide == 0) {
  @STABLE@
} else {
  @EITHER@
}
