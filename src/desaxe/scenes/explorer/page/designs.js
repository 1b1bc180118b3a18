// Designs and what is computed of them. A design is an object input -> value in SI units.

// name -> the quantity that it is, or is a sensitivity of, or the closed forms that it is one of
const GROUPS = Object.entries({ ...CONTENT.groups, ...CONTENT.closed });
const HOME = Object.fromEntries(GROUPS.flatMap(([base, names]) => names.map((name) => [name, base])));
const TURN = 2 * Math.PI;
const SAMPLES = 721;
const BESIDE = 1e-9; // rad: the sides of a jump, which every function has on its own side there
const NEARER = [1, 2, 3, 4, 5, 6, 7, 8].map((k) => 4 ** -k); // of a step towards a border

function valueAt(name, design, theta) {
  return MODULE[name](...CONTENT.arguments[HOME[name]].map((input) => (input === "theta" ? theta : (design[input] ?? 0))));
}

const closedForms = (group, design) => CONTENT.closed[group].map((name) => valueAt(name, design, 0));

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
function tellingAngles(design) {
  const zero = Math.asin(-design.ec / design.AB);
  const found = [Math.PI / 2, -Math.PI / 2, zero, Math.PI - zero].filter((angle) => !Number.isNaN(angle));
  return found.flatMap((angle) => repeated(angle, TURN));
}

// An angle after whole periods, as often as it is on the page.
function repeated(angle, period) {
  const [from, to] = CONTENT.theta, found = [];
  for (let k = Math.ceil((from - angle) / period); angle + k * period <= to; k++) found.push(angle + k * period);
  return found;
}

// Both sides of the angles at which loads jump: of tables over theta, at positions of the slider, and at the dead
// centres, where a table for the other way begins.
function jumpAngles(design) {
  const found = [], [from, to] = CONTENT.theta, turn = turnOf(design);
  const dead = turn ? [turn.outer, turn.inner].flatMap((angle) => repeated(angle, TURN)) : [];
  const samples = [...evenAngles(), ...dead].sort((a, b) => a - b);
  const Y = (theta) => valueAt("Y", design, theta);
  for (const { over, jumps, inward, centre, period } of Object.values(CONTENT.loads).flatMap((load) => load.parts)) {
    if (over === "theta") found.push(...jumps.flatMap((angle) => repeated(angle, period)));
    else if (over === "Y" || (over === "stroke" && turn)) {
      if (inward) found.push(...dead);
      const origin = over === "Y" ? null : Y(turn[centre.slice(2)]);
      const place = (theta) => (origin === null ? Y(theta) : Math.abs(Y(theta) - origin));
      const places = jumps.length ? samples.map(place) : [];
      for (const jump of jumps) {
        samples.slice(1).forEach((angle, k) => {
          if (places[k] >= jump === places[k + 1] >= jump) return;
          found.push(border((theta) => place(theta) >= jump, samples[k], angle)[0]);
        });
      }
    }
  }
  return found.flatMap((angle) => [angle - BESIDE, angle + BESIDE]).filter((angle) => from <= angle && angle <= to);
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

// The angles of a curve: even ones, telling ones, both sides of each jump, both sides of each border, and ever denser ones towards it
// from where there are values, which may grow there.
function anglesOf(inside, design) {
  const angles = [...evenAngles(), ...tellingAngles(design), ...jumpAngles(design)].sort((a, b) => a - b);
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
  const inside = (theta) => Number.isFinite(valueAt(name, design, theta));
  const theta = anglesOf(inside, design);
  const value = theta.map((angle) => valueAt(name, design, angle)).map((v) => (Number.isFinite(v) ? v : null));
  return { theta, value };
}

// The arcs of one turn in which the linkage cannot be assembled, as [from, to]; one across 0 goes on beyond a turn.
function gaps(design) {
  const angles = closedForms("limits", design).filter((angle) => !Number.isNaN(angle));
  if (!angles.length) return [[0, TURN]];
  const ends = angles.length === 2 ? [[angles[1], angles[0]]] : [[angles[1], angles[2]], [angles[3], angles[0]]];
  const arcs = ends.map(([from, to]) => [turned(from), turned(from) + turned(to - from)]);
  return arcs.filter(([from, to]) => to > from).sort(([a], [b]) => a - b);
}

const turned = (angle) => ((angle % TURN) + TURN) % TURN;

// The largest magnitude of a curve, between its samples too: { theta, value, limit }, null where there is none;
// `limit`: it is reached next to a limit angle; `grows`: towards which it has no bound.
function peakOf(name, design, { theta, value }) {
  const size = (v) => (v === null || !Number.isFinite(v) ? -1 : Math.abs(v));
  const best = value.reduce((top, v, k) => (size(v) > size(value[top]) ? k : top), 0);
  if (size(value[best]) < 0) return null;
  const limit = [value[best - 1], value[best + 1]].includes(null);
  const [a, b] = [theta[Math.max(0, best - 1)], theta[Math.min(theta.length - 1, best + 1)]];
  const at = (angle) => size(valueAt(name, design, angle)), part = (b - a) / 1024;
  const [middle] = limit ? [theta[best]] : border((angle) => at(angle + part) > at(angle - part), a, b);
  const refined = !limit && at(middle) > size(value[best]);
  const angle = refined ? middle : theta[best];
  const sizes = value.map(size).filter((v) => v >= 0).sort((p, q) => p - q);
  const grows = limit && size(value[best]) > 1e3 * sizes[Math.floor(sizes.length / 2)];
  return { theta: angle, value: refined ? valueAt(name, design, angle) : value[best], limit, grows };
}

const canTurn = (design) => marginOf(design) >= 0;

// Stroke, time ratio, dead centres and the largest pressure angle of a crank that turns; null where it does not.
function turnOf(design) {
  if (!canTurn(design)) return null;
  const [stroke, ratio, outer, inner, pressure] = closedForms("turn", design);
  return { stroke, ratio, outer: turned(outer), inner: turned(inner), pressure };
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
