// Designs and what is computed of them. A design is an object input -> value in SI units.

const HOME = {}; // name -> [the quantity whose function computes it, its place among the answers]
for (const [base, { names }] of Object.entries(CONTENT.functions)) {
  names.forEach((name, place) => (HOME[name] = [base, place]));
}
const TURN = 2 * Math.PI;
const SAMPLES = 721;
const NEARER = [1, 2, 3, 4, 5, 6, 7, 8].map((k) => 4 ** -k); // of a step towards a border

function answers(base, design, theta) {
  const { inputs, names, terms } = CONTENT.functions[base], loads = loadsAt(base, design, theta);
  const added = (name) => loads[name]?.value ?? 0;
  const found = FUNCTIONS[base](...inputs.map((name) => (name === "theta" ? theta : (design[name] ?? 0) + added(name))));
  for (const [place, slope, force, parameter] of terms) found[place] += found[slope] * loads[force].by(parameter);
  if (Object.values(loads).every(({ there }) => there)) return found;
  return found.map((value, k) => (names[k] !== "status" ? NaN : value || NO_DEAD_CENTRE));
}

const NO_DEAD_CENTRE = 1; // the status of a load that is measured from one

// The status of the linkage itself, whatever its loads.
function linkageAt(design, theta) {
  const { inputs, names } = CONTENT.functions.status;
  return FUNCTIONS.status(...inputs.map((name) => (name === "theta" ? theta : (design[name] ?? 0))))[names.indexOf("status")];
}

// The loads that a function needs, at an angle: the value, the derivative by a parameter, whether it is there.
function loadsAt(base, design, theta) {
  const { inputs } = CONTENT.functions[base];
  const names = Object.keys(CONTENT.loads).filter((name) => inputs.includes(name));
  const follow = names.some((name) => CONTENT.loads[name].over !== "theta");
  const motion = follow ? motionAt(design, theta) : {};
  const at = (name) => (CONTENT.loads[name].over === "theta" ? overTheta : overSlider)(CONTENT.loads[name], theta, motion, design);
  return Object.fromEntries(names.map((name) => [name, at(name)]));
}

function motionAt(design, theta) {
  const { names, inputs } = CONTENT.motion;
  const found = FUNCTIONS.motion(...inputs.map((name) => (name === "theta" ? theta : (design[name] ?? 0))));
  return Object.fromEntries(names.map((name, place) => [name, found[place]]));
}

function overTheta({ knots, rows, period }, theta) {
  const first = knots[0];
  let x = theta - period * Math.floor((theta - first) / period);
  if (x < first) x += period;
  else if (x - period >= first) x -= period;
  const [value, slope] = looked(knots, rows, x, false);
  return { value, by: () => slope, there: true };
}

// Over the slider's position, or its distance from a dead centre: the way it goes chooses the table.
function overSlider({ knots, rows, inward, centre, rises }, theta, motion, design) {
  const forward = motion.Y_wrt_theta || motion.Y_wrt_theta_theta;
  const turning = "omega" in design ? design.omega || design.alpha : design.omega0;
  const ahead = turning < 0 ? -forward : forward, side = centre && motion[centre] < motion.Y ? -1 : 1;
  const x = centre ? Math.abs(motion[centre] - motion.Y) : motion.Y;
  const [value, slope] = looked(knots, ahead < 0 && inward ? inward : rows, x, ahead * rises < 0);
  const moved = (p) => (centre ? side * ((motion[`${centre}_wrt_${p}`] ?? 0) - motion[`Y_wrt_${p}`]) : motion[`Y_wrt_${p}`]);
  const number = (v) => (Number.isFinite(v) ? v : NaN);
  return { value: number(value) || 0, by: (p) => slope * number(moved(p)), there: !centre || Number.isFinite(x) || !Number.isFinite(motion.Y) };
}

// Value and derivative of a table: cubics in the distance from a knot; on a knot `back` takes the piece below.
function looked(knots, rows, x, back) {
  let piece = 0, beyond = knots.length;
  while (piece < beyond) {
    const middle = (piece + beyond) >> 1;
    if (back ? knots[middle] < x : knots[middle] <= x) piece = middle + 1;
    else beyond = middle;
  }
  const [a, b, c, d] = rows[piece], s = x - knots[Math.max(piece - 1, 0)];
  return [a + s * (b + s * (c + s * d)), b + s * (2 * c + 3 * s * d)];
}

function valueAt(name, design, theta) {
  const [base, place] = HOME[name];
  return answers(base, design, theta)[place];
}

const statusAt = (design, theta) => valueAt("status", design, theta);
const marginOf = (design) => valueAt("margin", design, 0);

function isGood(name, value) {
  const least = CONTENT.inputs[name].least;
  return Number.isFinite(value) && (least === null || value >= least);
}

function evenAngles() {
  const [from, to] = CONTENT.theta;
  return Array.from({ length: SAMPLES }, (_, k) => from + ((to - from) * k) / (SAMPLES - 1));
}

// Angles at which no arc can be missed, however short: the crank pin is farthest from the slider axis at
// the quarters, where every gap has its middle, and on the axis where sin(theta) = -ec/AB.
function tellingAngles(design, from, to) {
  const zero = Math.asin(-design.ec / design.AB);
  const found = [];
  for (const angle of [Math.PI / 2, -Math.PI / 2, zero, Math.PI - zero]) {
    if (Number.isNaN(angle)) continue;
    const first = Math.ceil((from - angle) / TURN);
    for (let k = first; angle + k * TURN <= to; k++) found.push(angle + k * TURN);
  }
  return found;
}

// The last double on each side of a border between two angles, on one of which `inside` holds.
function border(inside, a, b) {
  const wanted = inside(a);
  for (;;) {
    const middle = a + (b - a) / 2;
    if (middle === a || middle === b) return [a, b];
    if (inside(middle) === wanted) a = middle;
    else b = middle;
  }
}

// The angles of a curve: even ones, telling ones, both sides of each border, and ever denser ones towards it
// from where there are values, which may grow there.
function anglesOf(inside, design, from, to, even) {
  const angles = [...even, ...tellingAngles(design, from, to)].sort((a, b) => a - b);
  const found = [];
  angles.forEach((angle, k) => {
    const before = angles[k - 1];
    if (k && inside(angle) !== inside(before)) {
      const [last, first] = border(inside, before, angle);
      const near = NEARER.map((part) => (inside(angle) ? first + (angle - first) * part : last - (last - before) * part));
      found.push(...[...near, last, first].sort((a, b) => a - b));
    }
    found.push(angle);
  });
  return found;
}

// A quantity over the crank angle: null where it has no value, so that no line is drawn there.
function curve(name, design) {
  const [from, to] = CONTENT.theta;
  const inside = (theta) => Number.isFinite(valueAt(name, design, theta));
  const theta = anglesOf(inside, design, from, to, evenAngles());
  const value = theta.map((angle) => valueAt(name, design, angle)).map((v) => (Number.isFinite(v) ? v : null));
  return { theta, value };
}

// The arcs of one turn in which the linkage cannot be assembled, as [from, to].
function gaps(design) {
  const stuck = (theta) => linkageAt(design, theta) === 1;
  const even = Array.from({ length: 181 }, (_, k) => (TURN * k) / 180);
  const angles = anglesOf(stuck, design, 0, TURN, even);
  const found = [];
  angles.forEach((angle, k) => {
    if (!stuck(angle)) return;
    if (k && stuck(angles[k - 1])) found.at(-1)[1] = angle;
    else found.push([angle, angle]);
  });
  const whole = found.length === 1 && found[0][0] === 0 && found[0][1] === TURN;
  if (!whole && found.length > 1 && found[0][0] === 0 && found.at(-1)[1] === TURN) {
    found.at(-1)[1] = TURN + found.shift()[1]; // a gap across theta = 0 is one gap
  }
  return found;
}

// The largest magnitude of a curve, between its samples too: { theta, value, limit }, null where there is none;
// `limit`: it is reached next to a limit angle; `grows`: towards which it has no bound.
function peakOf(name, design, { theta, value }) {
  const size = (v) => (v === null || !Number.isFinite(v) ? -1 : Math.abs(v));
  const best = value.reduce((top, v, k) => (size(v) > size(value[top]) ? k : top), 0);
  if (size(value[best]) < 0) return null;
  const limit = [value[best - 1], value[best + 1]].includes(null);
  let a = theta[Math.max(0, best - 1)], b = theta[Math.min(theta.length - 1, best + 1)];
  const at = (angle) => size(valueAt(name, design, angle)), part = (Math.sqrt(5) - 1) / 2;
  if (!limit) {
    let [c, d] = [b - part * (b - a), a + part * (b - a)], [f, g] = [at(c), at(d)];
    for (let k = 0; k < 60; k++) {
      if (f > g) [b, d, g, c] = [d, c, f, d - part * (d - a)], f = at(c);
      else [a, c, f, d] = [c, d, g, c + part * (b - c)], g = at(d);
    }
  }
  const middle = (a + b) / 2, refined = !limit && at(middle) > size(value[best]);
  const angle = refined ? middle : theta[best];
  const sizes = value.map(size).filter((v) => v >= 0).sort((p, q) => p - q);
  const grows = limit && size(value[best]) > 1e3 * sizes[Math.floor(sizes.length / 2)];
  return { theta: angle, value: refined ? valueAt(name, design, angle) : value[best], limit, grows };
}

const canTurn = (design) => marginOf(design) >= 0;

// Stroke, time ratio, dead centres and the largest pressure angle of a crank that turns; null where it does not.
function turnOf(design) {
  if (!canTurn(design)) return null;
  const { AB, BC, ec } = design, out = BC + AB, inn = BC - AB;
  const height = (reach) => Math.sqrt((reach - ec) * (reach + ec));
  const [far, near] = [Math.asin(ec / out), Math.asin(ec / inn)];
  const turned = (angle) => ((angle % TURN) + TURN) % TURN;
  const [outer, inner] = CONTENT.branch > 0 ? [-far, Math.PI - near] : [Math.PI + far, near];
  const lag = Math.asin(Math.abs(ec) / inn) - Math.asin(Math.abs(ec) / out);
  return {
    stroke: AB ? (4 * AB * BC) / (height(out) + height(inn)) : 0,
    ratio: (Math.PI + lag) / (Math.PI - lag),
    outer: turned(outer),
    inner: turned(inner),
    pressure: Math.asin((AB + Math.abs(ec)) / BC),
  };
}

// The inputs in which not all of the designs agree.
function differingInputs(designs) {
  return Object.keys(CONTENT.inputs).filter((name) => designs.some((design) => design[name] !== designs[0][name]));
}

// What tells one of several designs from the others.
function labelsOf(designs) {
  const differing = differingInputs(designs);
  return designs.map((design) =>
    differing.length
      ? differing.map((name) => `${plainSymbol(name, false)} = ${shownInput(name, design[name])}`).join(", ")
      : "this design",
  );
}
