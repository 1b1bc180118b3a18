/* Strips of an array: sines ahead, then one loop in the form that the strip's designs share. */
void @NAME@_array(size_t n, const double *const in[], double *const out[]) {
  @UNUSED@
  for (size_t start = 0; start < n; start += @STRIP@) {
    const size_t count = n - start < @STRIP@ ? n - start : @STRIP@;
    @COLUMNS@
    @TURNS@
    @LOOPS@
  }
}
