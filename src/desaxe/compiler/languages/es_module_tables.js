/** The numbers of all tables, then their arrays. */
function valuesOf(tables) {
  return [...tables.flatMap((one) => one.slice(0, 2)), ...tables.flatMap((one) => one.slice(2))];
}

/** 0, or NaN where something is no table, and then zeros in its place; the first knot; both arrays. */
function checkedTable(x, c, ways, period) {
  if (!x || !c || x.length === undefined || c.length === undefined) throw new TypeError("a table is missing");
  const n = x.length;
  let good = n >= 2 && c.length >= 4 * ways * (n + 1) && x[n - 1] - x[0] < period;
  for (let k = 0; good && k < n; k++) {
    good = Number.isFinite(x[k]) && (k < 1 || x[k - 1] <= x[k]) && (k < 2 || x[k - 2] < x[k]);
  }
  for (let k = 0; good && k < 4 * ways * (n + 1); k++) good = Number.isFinite(c[k]);
  return good ? [0, x[0], x, c] : [NaN, 0, [0, 1], new Array(24).fill(0)];
}
