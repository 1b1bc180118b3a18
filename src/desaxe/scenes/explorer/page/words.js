// Margin and feasibility in words.

const degrees = (theta, places = 2) => `${Number(((theta * 180) / Math.PI).toFixed(places))}°`.replace("-", "−");

// "crank" turns fully, "change point", "rocker" turns partly, "none".
function kindOf(design) {
  const margin = marginOf(design);
  const ulp = 2 ** (Math.floor(Math.log2(design.BC)) - 52);
  if (Math.abs(margin) <= 4 * ulp) return "change point";
  if (margin > 0) return "crank";
  const stuck = gaps(design);
  return stuck.length === 1 && stuck[0][1] - stuck[0][0] >= TURN ? "none" : "rocker";
}

const KINDS = {
  crank: ["✓", "good", "Turns fully"],
  "change point": ["!", "warn", "At its change point"],
  rocker: ["!", "warn", "Cannot turn fully"],
  none: ["×", "bad", "Cannot be assembled"],
};

function verdictWords(design, kind) {
  if (kind === "crank") return "The linkage can be assembled at every crank angle.";
  if (kind === "change point") {
    if (!canTurn(design)) return "Rod and crank just fail to pass across the slider axis together: it cannot turn fully.";
    return "Rod and crank come to lie across the slider axis together: it turns, but can fold over there.";
  }
  if (kind === "none") return "The rod reaches the slider axis at no crank angle: it is too short, or ec too large.";
  const arcs = gaps(design).map(([from, to]) => `from ${degrees(from)} to ${degrees(to)}`);
  return `No assembly for crank angles ${arcs.join(" and ")}: there the rod does not reach the slider axis.`;
}

function stallWords(design) {
  if (!("omega0" in design)) return "";
  const [from, to] = CONTENT.theta;
  const stalled = (theta) => design.omega0 ** 2 + 2 * design.alpha * theta < 0;
  if (stalled(from) === stalled(to)) return stalled(from) ? " It has stalled at all of these angles." : "";
  const [, theta] = border(stalled, from, to);
  return ` With this deceleration the crank stalls at ${degrees(theta)}.`;
}

// What happens at one crank angle, if anything does.
function statusWords(design, theta) {
  const status = statusAt(design, theta);
  if (status !== 1) return status ? CONTENT.status[status] : "";
  if (Number.isFinite(valueAt("Y", design, theta))) return "forces have no value: this design lacks the dead centre from which a load is measured";
  const reach = Math.abs(design.ec + design.AB * Math.sin(theta));
  return (
    `cannot be assembled: the crank pin is ${shownInput("BC", reach)} from the slider axis, ` +
    `the rod is ${shownInput("BC", design.BC)} long`
  );
}

function showVerdict(design) {
  const kind = kindOf(design);
  const [mark, level, title] = KINDS[kind];
  const margin = marginOf(design);
  const box = document.getElementById("verdict");
  box.className = level;
  box.dataset.kind = kind;
  setText("verdict-mark", mark);
  setText("verdict-kind", title);
  setText("verdict-words", verdictWords(design, kind) + stallWords(design));
  setText("margin-words", `margin BC − AB − |ec| = ${shownInput("BC", margin)}`);
  const part = Math.max(-1, Math.min(1, margin / design.BC));
  const bar = document.getElementById("margin-bar");
  bar.style.left = `${50 + Math.min(0, part) * 50}%`;
  bar.style.width = `${Math.max(Math.abs(part) * 50, 0.5)}%`;
}

// What a design is and does over a turn: a row each, a column for each design.
function showFigures(curves) {
  const turns = state.designs.map(turnOf), none = "–";
  const angle = (theta) => degrees(theta);
  const of = (pick) => turns.map((turn) => (turn ? pick(turn) : none));
  const rows = [
    ["turns", "turns fully", state.designs.map((design) => (canTurn(design) ? "yes" : "no"))],
    ["stroke", "stroke", of((turn) => shownInput("BC", turn.stroke))],
    ["time_ratio", "time ratio", of((turn) => digits(turn.ratio, 6))],
    ["theta_outer", "outer dead centre", of((turn) => angle(turn.outer))],
    ["theta_inner", "inner dead centre", of((turn) => angle(turn.inner))],
    ["max_pressure_angle", "largest pressure angle", of((turn) => angle(turn.pressure))],
  ];
  [...new Set(state.shown)].forEach((name) => {
    const own = curves[state.shown.indexOf(name)];
    const cells = state.designs.map((design, k) => {
      const peak = peakOf(name, design, own[k]);
      if (!peak) return none;
      const where = peak.limit ? "next to a limit angle" : `at ${angle(peak.theta)}`;
      if (peak.grows) return `no bound<small>${where}</small>`;
      return `${withUnit(name, peak.value, 5)}<small>${where}</small>`;
    });
    rows.push([`peak-${name}`, `peak of ${symbol(name)}`, cells]);
  });
  document.getElementById("look").classList.toggle("many", state.designs.length > 3);
  const look = palette(), swatch = (k) => `<span class="swatch" style="background:${look.curves[k % look.curves.length]}"></span>`;
  const head = labelsOf(state.designs).map((label, k) => `<th scope="col">${swatch(k)}${label}</th>`).join("");
  const line = ([key, title, cells]) =>
    `<tr data-figure="${key}"><th scope="row">${title}</th>${cells.map((cell) => `<td>${cell}</td>`).join("")}</tr>`;
  document.getElementById("figures").innerHTML =
    `<thead><tr><th scope="col"></th>${head}</tr></thead><tbody>${rows.map(line).join("")}</tbody>`;
}

function spokenValues(design, theta) {
  const values = [...new Set(state.shown)].map((name) => {
    const value = valueAt(name, design, theta);
    return `${symbol(name, false)} = ${Number.isFinite(value) ? withUnit(name, value, 5) : "no value"}`;
  });
  return `At ${degrees(theta, 1)}: ${values.join(", ")}`;
}

function setText(id, text) {
  const element = document.getElementById(id);
  if (element.textContent !== text) element.textContent = text; // what has not changed is not said again
}
