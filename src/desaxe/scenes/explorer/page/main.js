// The state of the page, and what follows from a change of it.

const state = {
  designs: CONTENT.designs.map((design) => ({ ...design })), // the first is the one that is changed
  shown: [CONTENT.shown[0], CONTENT.shown[1] ?? CONTENT.groups[HOME[CONTENT.shown[0]]].at(1)],
  theta: CONTENT.theta[0] + (CONTENT.theta[1] - CONTENT.theta[0]) / 6,
  playing: 0,
};

let drawn = []; // the curves of each chart
let wanted = 0; // the frame in which the page is drawn again

function later(draw) {
  cancelAnimationFrame(wanted);
  wanted = requestAnimationFrame(draw);
}

function showAll(source) {
  showControls(source);
  showDesigns();
  showVerdict(state.designs[0]);
  drawn = charts.map((_, index) => drawChart(index));
  showFigures(drawn);
  showTurn();
}

function showTurn(source) {
  const slider = document.getElementById("theta");
  if (source !== slider) slider.value = (state.theta * 180) / Math.PI;
  slider.setAttribute("aria-valuetext", degrees(state.theta, 1));
  document.getElementById("theta-shown").textContent = degrees(state.theta, 1);
  drawMechanism(state.designs, state.theta);
  readings();
  sayLater();
}

// What the charts show of the design that is changed, for those who cannot see it: once all is at rest.
let saying = 0;
function sayLater() {
  clearTimeout(saying);
  saying = setTimeout(() => state.playing || setText("said", spokenValues(state.designs[0], state.theta)), 600);
}

function change(name, value, source) {
  state.designs[0][name] = value;
  later(() => showAll(source));
}

function show(index, name) {
  state.shown[index] = name;
  showChoice(index);
  drawn[index] = drawChart(index);
  showFigures(drawn);
  readings();
  sayLater();
}

function turnTo(theta, source) {
  const [from, to] = CONTENT.theta;
  state.theta = Math.max(from, Math.min(to, theta));
  showTurn(source);
  moveCursor();
}

// One turn in four seconds, back to the start at the end.
function play() {
  const button = document.getElementById("play");
  const [from, to] = CONTENT.theta;
  const stop = () => {
    cancelAnimationFrame(state.playing);
    state.playing = 0;
  };
  let before = performance.now();
  const step = (now) => {
    const next = state.theta + ((now - before) / 4000) * TURN;
    before = now;
    turnTo(next > to ? from : next);
    state.playing = requestAnimationFrame(step);
  };
  if (state.playing) stop();
  else state.playing = requestAnimationFrame(step);
  button.textContent = state.playing ? "Stop" : "Play";
  button.setAttribute("aria-pressed", String(Boolean(state.playing)));
}

function listenToTheme() {
  const button = document.getElementById("theme"), root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => {
    const isDark = (root.dataset.theme ?? (dark.matches ? "dark" : "light")) === "dark";
    button.textContent = isDark ? "Light" : "Dark";
    button.setAttribute("aria-pressed", String(isDark));
    showAll();
  };
  button.addEventListener("click", () => {
    root.dataset.theme = button.getAttribute("aria-pressed") === "true" ? "light" : "dark";
    paint();
  });
  dark.addEventListener("change", paint);
  paint();
}

charts.forEach(buildChooser);
charts.forEach((_, index) => showChoice(index));
buildUnits();
buildControls();
if (CONTENT.left_out) setText("left-out", `Not shown: ${CONTENT.left_out}`);
listenToDesigns();
listenToKeys();
listenToTurning();
listenToFiles();
listenToTheme(); // draws everything
charts.forEach((_, index) => listen(index));
addEventListener("resize", () => later(() => drawMechanism(state.designs, state.theta)));

// For scripts, and for those who would like to check a number.
window.desaxe = { content: CONTENT, state, valueAt, curve, gaps, kindOf, canTurn, turnOf, peakOf, toSI, sceneText, statusWords, valuesText };
