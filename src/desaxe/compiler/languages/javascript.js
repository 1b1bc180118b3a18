const { atan2, cos, exp, floor, log, pow, sin, sqrt, abs: fabs } = Math;
const nan = NaN, inf = Infinity, True = true, False = false;

function copysign(size, sign) {
  return sign < 0 || Object.is(sign, -0) ? -fabs(size) : fabs(size);
}

function two_sum_error(a, b) {
  const total = a + b, of_b = total - a;
  return (a - (total - of_b)) + (b - of_b);
}

function two_product_error(a, b) {
  const product = a * b;
  let wide = 134217729 * a;
  const a_high = wide - (wide - a), a_low = a - a_high;
  wide = 134217729 * b;
  const b_high = wide - (wide - b), b_low = b - b_high;
  return a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low) + 0;
}

function hypot(a, b) {
  const p = fabs(a), q = fabs(b), most = p < q ? q : p, least = p < q ? p : q;
  return least > 0 && most < Infinity ? most * sqrt(1 + (least / most) * (least / most)) : most + least;
}

function rounding(a) {
  return 4.440892098500626e-16 * fabs(a);
}

function power_of_two(a) {
  const least = 1.0261342003245941e-289, most = 9.7453140114e+288;
  const size = a < most ? (least < a ? a : least) : most, wide = 9007199254740992 * size;
  const step = (wide + size) - wide;
  return step > 0 ? step : size;
}

function mul_add(a, b, c) {
  return a * b + c;
}

function extended_only(a) {
  return false;
}

function rotated_sin(sine, cosine, quarters) {
  const turn = quarters - 4 * floor(quarters / 4);
  const value = turn % 2 === 1 ? cosine : sine;
  return turn >= 2 ? -value : value;
}

function rotated_cos(sine, cosine, quarters) {
  const turn = quarters - 4 * floor(quarters / 4), next = quarters + 1;
  const value = turn % 2 === 1 ? sine : cosine;
  return next - 4 * floor(next / 4) >= 2 ? -value : value;
}
