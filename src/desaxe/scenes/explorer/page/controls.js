// Sliders and number fields for the inputs, the list of designs, keys.

const SLIDERS = ["AB", "BC", "ec", "omega0", "omega", "alpha"];
const NAMES = { AB: "Crank AB", BC: "Rod BC", ec: "Eccentricity ec", omega0: "Speed ω₀", omega: "Speed ω", alpha: "Acceleration α" };

// A span of the slider that suits what the scene has, in SI units.
function spanOf(name) {
  const given = Math.max(...state.designs.map((d) => Math.abs(d[name])));
  const lengths = Math.max(...state.designs.map((d) => d.BC));
  const speed = Math.max(...state.designs.map((d) => Math.abs(d.omega0 ?? d.omega)));
  if (name === "AB") return [0, Math.max(2 * given, lengths / 2)];
  if (name === "BC") return [lengths / 50, 2 * given];
  if (name === "ec") return [-lengths, lengths];
  if (name === "alpha") return [-1, 1].map((side) => side * Math.max(1.5 * given, (speed * speed) / TURN / 2, 10));
  return [-1, 1].map((side) => side * Math.max(2 * given, 10));
}

// A step of 1, 2 or 5 that divides a span into some hundreds.
function stepOf(length) {
  const power = 10 ** Math.floor(Math.log10(length / 400));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= length / 400);
}

function buildControls() {
  const names = Object.keys(CONTENT.inputs);
  const main = SLIDERS.filter((name) => names.includes(name)), rest = names.filter((name) => !main.includes(name));
  const form = document.getElementById("controls");
  const more = rest.length ? `<details id="more"><summary>Masses and loads<span id="loads-words"></span></summary>${rest.map(field).join("")}</details>` : "";
  form.innerHTML = main.map((name) => field(name, true)).join("") + more;
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const name of names) listenTo(name, main.includes(name));
}

function field(name, slider) {
  const { meaning } = CONTENT.inputs[name], label = NAMES[name] ?? symbol(name);
  const range = slider === true ? `<input type="range" id="slide-${name}" aria-label="${meaning}">` : "";
  return (
    `<div class="field" id="field-${name}"><label for="number-${name}" title="${meaning}">${label}</label>` +
    `<span class="number"><input type="number" step="any" id="number-${name}" aria-describedby="wrong-${name}">` +
    `<span class="unit" data-unit="${name}">${shownUnit(name)}</span></span>${range}` +
    `<p class="wrong" id="wrong-${name}" role="alert"></p></div>`
  );
}

// What a value reads as in its field, and the value that a text in it means: one that already reads so stays
// the same double, so that typing it again changes nothing.
const fieldText = (name, value) => String(Number(toShown(name, value).toPrecision(8)));

function fieldValue(name, text) {
  const known = [...state.designs, ...CONTENT.designs].map((design) => design[name]);
  const same = known.find((value) => fieldText(name, value) === text.trim());
  return same ?? toSI(name, text);
}

// The span of a slider in the unit of its field; a value beyond it widens it as long as it stands.
function spread(name) {
  const range = document.getElementById(`slide-${name}`);
  if (!range) return;
  const [low, high] = spans[name].map((v) => toShown(name, v));
  const step = stepOf(high - low), shown = toShown(name, state.designs[0][name]);
  range.step = step;
  range.min = Math.min(Math.ceil(low / step) * step, Math.floor(shown / step) * step);
  range.max = Math.max(Math.floor(high / step + 1e-9) * step, Math.ceil(shown / step) * step);
  range.value = shown;
  range.setAttribute("aria-valuetext", shownInput(name, state.designs[0][name]));
}

const spans = {}; // of sliders, in SI units, as the page began

function listenTo(name, slider) {
  const number = document.getElementById(`number-${name}`);
  number.addEventListener("input", () => {
    const value = number.value.trim() === "" ? NaN : fieldValue(name, number.value);
    const good = isGood(name, value);
    setText(`wrong-${name}`, good ? "" : `It must be ${CONTENT.inputs[name].limit}.`);
    number.setAttribute("aria-invalid", String(!good));
    if (good) change(name, value, number);
  });
  number.addEventListener("blur", showControls);
  if (!slider) return;
  const range = document.getElementById(`slide-${name}`);
  spans[name] = spanOf(name);
  spread(name);
  range.addEventListener("input", () => change(name, fieldValue(name, String(snapped(range.valueAsNumber, +range.step))), range));
}

function buildUnits() {
  const choice = document.getElementById("units");
  choice.innerHTML = Object.entries(UNITS).map(([key, { title }]) => `<option value="${key}">${title}</option>`).join("");
  choice.addEventListener("change", () => {
    units = UNITS[choice.value];
    for (const element of document.querySelectorAll("[data-unit]")) element.textContent = shownUnit(element.dataset.unit);
    showAll();
  });
}

// The masses and loads that are not 0.
function loadWords(design) {
  const there = Object.keys(CONTENT.inputs).filter((name) => !SLIDERS.includes(name));
  const words = there.map((name) => {
    const own = design[name] ? `${plainSymbol(name, false)} = ${shownInput(name, design[name])}` : "";
    const words = CONTENT.loads[name]?.words;
    return words ? `${plainSymbol(name, false)} ${words}${own ? `, and ${own}` : ""}` : own;
  });
  return words.filter(Boolean).join(", ");
}

// A multiple of the step without the dust of binary fractions.
const snapped = (value, step) => Number((Math.round(value / step) * step).toPrecision(12));

function showControls(source) {
  if (document.getElementById("more")) setText("loads-words", loadWords(state.designs[0]));
  for (const [name, value] of Object.entries(state.designs[0])) {
    const number = document.getElementById(`number-${name}`), range = document.getElementById(`slide-${name}`);
    if (number !== source && document.activeElement !== number) {
      number.value = fieldText(name, value);
      number.setAttribute("aria-invalid", "false");
      setText(`wrong-${name}`, "");
    }
    if (range && range !== source) spread(name);
  }
}

function showDesigns() {
  const labels = labelsOf(state.designs), look = palette();
  const kinds = state.designs.map(kindOf);
  const item = (k) => {
    const [mark, level, title] = KINDS[kinds[k]];
    const badge = `<span class="badge ${level}" role="img" aria-label="${title}" title="${title}">${mark}</span>`;
    const colour = look.curves[k % look.curves.length];
    const swatch = `<span class="swatch" style="background:${colour}" aria-hidden="true"></span>`;
    if (k === 0) return `<li>${swatch}<span class="label">${labels[0]} <em>(changed above)</em></span>${badge}</li>`;
    return (
      `<li>${swatch}<button type="button" class="label link" data-take="${k}" title="Change this one above">${labels[k]}</button>` +
      `${badge}<button type="button" data-drop="${k}" aria-label="Remove ${labels[k]}" title="Remove">×</button></li>`
    );
  };
  document.getElementById("designs").innerHTML = state.designs.map((_, k) => item(k)).join("");
  document.getElementById("keep").disabled = state.designs.length >= look.curves.length;
  const one = "The designs differ in more than one input: the scene has the one that is changed above.";
  setText("export-note", differingInputs(state.designs).length > 1 ? one : "");
}

function listenToDesigns() {
  document.getElementById("keep").addEventListener("click", keep);
  document.getElementById("designs").addEventListener("click", ({ target }) => {
    const { take, drop } = target.dataset;
    if (take) state.designs.unshift(...state.designs.splice(+take, 1));
    if (drop) state.designs.splice(+drop, 1);
    if (take || drop) showAll();
  });
}

function keep() {
  if (document.getElementById("keep").disabled) return;
  state.designs.push({ ...state.designs[0] });
  showAll();
}

function listenToKeys() {
  document.addEventListener("keydown", (event) => {
    const inField = event.target.closest("input, select, textarea, button, summary, a");
    if (inField || event.ctrlKey || event.metaKey || event.altKey) return;
    const steps = { ArrowLeft: -1, ArrowRight: 1 };
    if (event.key in steps) turnTo(state.theta + (steps[event.key] * (event.shiftKey ? 10 : 1) * Math.PI) / 180);
    else if (event.key === " ") play();
    else if (event.key === "k" || event.key === "K") keep();
    else return;
    event.preventDefault();
  });
}

function listenToTurning() {
  const slider = document.getElementById("theta"), [from, to] = CONTENT.theta.map((v) => (v * 180) / Math.PI);
  Object.assign(slider, { min: from, max: to, step: 0.5 });
  slider.addEventListener("input", () => turnTo((slider.valueAsNumber * Math.PI) / 180, slider));
  document.getElementById("play").addEventListener("click", play);
}
