function lookup_piece(x, knots, way) {
  let low = 0, high = knots.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (knots[middle] <= x) low = middle + 1; else high = middle;
  }
  return low + (way < 0 ? knots.length + 1 : 0);
}

function lookup(x, knots, rows, piece) {
  const at = piece % (knots.length + 1), s = x - knots[at > 0 ? at - 1 : 0], k = 4 * piece;
  return rows[k] + s * (rows[k + 1] + s * (rows[k + 2] + s * rows[k + 3]));
}

function lookup_slope(x, knots, rows, piece) {
  const at = piece % (knots.length + 1), s = x - knots[at > 0 ? at - 1 : 0], k = 4 * piece;
  return rows[k + 1] + s * (2 * rows[k + 2] + s * (3 * rows[k + 3]));
}
