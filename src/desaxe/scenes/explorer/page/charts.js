// Two charts over the crank angle: any quantity or sensitivity, one curve for each design.

const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
const charts = [...document.querySelectorAll(".chart")];
const touched = matchMedia("(hover: none)").matches; // a finger over a chart moves the page

function palette() {
  const style = getComputedStyle(document.documentElement);
  const named = (name) => style.getPropertyValue(`--${name}`).trim();
  const curves = [1, 2, 3, 4, 5, 6].map((k) => named(`curve-${k}`));
  const [ink, soft, line, panel, bad] = ["ink", "soft", "line", "panel", "bad"].map(named);
  return { curves, ink, soft, line, panel, bad };
}

// What is chosen above a chart: a quantity, and itself or one of its derivatives.
function buildChooser(chart, index) {
  chart.innerHTML =
    `<div class="chooser"><select id="quantity-${index}" aria-label="Quantity of chart ${index + 1}"></select>` +
    `<select id="by-${index}" aria-label="The value or a sensitivity"></select></div>` +
    `<div class="plot" id="plot-${index}" role="img"></div><p class="note" id="note-${index}"></p>`;
  const bases = Object.keys(CONTENT.groups).filter((base) => base !== "status");
  const option = (base) => {
    const about = CONTENT.quantities[base];
    return `<option value="${base}">${plainSymbol(base, false)} – ${about.meaning}</option>`;
  };
  const quantity = document.getElementById(`quantity-${index}`), by = document.getElementById(`by-${index}`);
  quantity.innerHTML = bases.map(option).join("");
  quantity.addEventListener("change", () => show(index, quantity.value));
  by.addEventListener("change", () => show(index, by.value));
}

function showChoice(index) {
  const name = state.shown[index], base = HOME[name];
  document.getElementById(`quantity-${index}`).value = base;
  const by = document.getElementById(`by-${index}`);
  const words = (own) => {
    const over = CONTENT.quantities[own].by.map((p) => plainSymbol(p, false)).join(", ");
    return over ? `∂/∂${over}: its sensitivity` : "the value";
  };
  by.innerHTML = CONTENT.groups[base].map((own) => `<option value="${own}">${words(own)}</option>`).join("");
  by.value = name;
}

function drawChart(index) {
  const name = state.shown[index], look = palette(), labels = labelsOf(state.designs);
  const found = state.designs.map((design) => curve(name, design)), times = shownIn(name)[1];
  const curves = found.map(({ theta, value }) => ({ theta, value: value.map((v) => (v === null ? null : v * times)) }));
  const range = heightOf(curves.map(({ value }) => value));
  const traces = curves.map(({ theta, value }, k) => ({
    x: theta.map((angle) => (angle * 180) / Math.PI),
    y: range ? value.map((v) => drawable(v, range)) : value,
    customdata: value,
    name: labels[k],
    mode: "lines",
    connectgaps: false,
    // Every sample is drawn: a simplified line has corners in a large picture.
    line: { simplify: false, color: look.curves[k % look.curves.length], width: k ? 1.8 : 2.6, dash: DASHES[k % DASHES.length] },
    hovertemplate: `%{customdata:.6~g}`,
  }));
  const plot = document.getElementById(`plot-${index}`);
  plot.setAttribute("aria-label", `${CONTENT.quantities[name].meaning} over the crank angle`);
  Plotly.react(plot, traces.reverse(), layoutOf(name, range, look, labels.length), {
    displaylogo: false,
    responsive: true,
    modeBarButtons: [["zoom2d", "pan2d", "autoScale2d", "resetScale2d"]],
    displayModeBar: touched ? false : "hover",
  });
  setText(`note-${index}`, noteOf(name, curves.map(({ value }) => value), range));
  return found;
}

function noteOf(name, curves, range) {
  const known = curves.flat().filter((v) => v !== null);
  if (!known.length) return "No curve: this has no value at any of these angles.";
  if (!range) return "";
  if (curves.some((value) => value.includes(null))) return "It grows next to a limit angle, and is cut off there.";
  const peak = known.reduce((most, v) => (Math.abs(v) > Math.abs(most) ? v : most));
  return `A narrow peak of ${digits(peak, 3)} ${valueUnit(name)} is cut off.`;
}

function layoutOf(name, range, look, designs) {
  const unit = valueUnit(name);
  const axis = { fixedrange: touched, gridcolor: look.line, zerolinecolor: look.soft, linecolor: look.line, zerolinewidth: 1 };
  const [from, to] = CONTENT.theta.map((angle) => (angle * 180) / Math.PI);
  return {
    height: 300,
    margin: { l: 68, r: 12, t: 8, b: 44 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "system-ui, sans-serif", size: 12.5, color: look.ink },
    hovermode: "x unified",
    dragmode: touched ? false : "zoom",
    modebar: { bgcolor: look.panel, color: look.soft, activecolor: look.ink },
    hoverlabel: { bgcolor: look.panel, bordercolor: look.line, font: { color: look.ink } },
    showlegend: designs > 1,
    legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", traceorder: "reversed" },
    xaxis: {
      ...axis, range: [from, Number(to.toFixed(9))], title: { text: "crank angle θ [°]", standoff: 6 }, zeroline: false,
      tickmode: to - from >= 180 && to - from <= 721 ? "linear" : "auto", dtick: to - from > 361 ? 90 : 45,
      unifiedhovertitle: { text: "θ = %{x:.4~f}°" },
    },
    yaxis: {
      ...axis, title: { text: `${symbol(name)}${unit ? ` [${unit}]` : ""}`, standoff: 4 }, tickformat: "~g",
      exponentformat: "power", automargin: true, ...(range ? { range, autorange: false } : { autorange: true }),
    },
    shapes: [cursor(state.theta, look)],
    uirevision: `${name} ${Boolean(range)} ${unit}`,
  };
}

function cursor(theta, look) {
  const x = (theta * 180) / Math.PI;
  return { type: "line", x0: x, x1: x, y0: 0, y1: 1, yref: "paper", line: { color: look.soft, width: 1, dash: "dot" } };
}

// A range of the vertical axis where a few values would hide all others: next to a limit angle, where a
// curve ends, or at a very narrow peak next to a change point. Null where everything can be seen.
function heightOf(curves) {
  const known = curves.map((value) => value.filter((v) => v !== null));
  const seen = known.flatMap((values, k) => (values.length < curves[k].length ? usual(values, 0.85, 5) : usual(values, 0.97, 100)));
  if (seen.length === known.flat().length) return null;
  const [low, high] = [Math.min(...seen, 0), Math.max(...seen, 0)], room = 0.08 * (high - low);
  return [low - room, high + room];
}

// Far outside of the picture a line is drawn to a nearer place: a browser has few digits for places.
function drawable(value, [low, high]) {
  const far = 1e4 * (high - low);
  return value === null ? null : Math.max(low - far, Math.min(high + far, value));
}

// All values, unless one has many times the size of most: then those without such a size. A press works
// over some tenth of the turn: that is to be seen.
function usual(values, share, times) {
  const sizes = values.map(Math.abs).sort((a, b) => a - b);
  const most = sizes[Math.floor(sizes.length * share)];
  return sizes.length < 20 || sizes.at(-1) <= times * most ? values : values.filter((v) => Math.abs(v) <= 2.5 * most);
}

function moveCursor() {
  const look = palette();
  for (const index of charts.keys()) {
    const plot = document.getElementById(`plot-${index}`);
    if (plot.layout) Plotly.relayout(plot, { shapes: [cursor(state.theta, look)] });
  }
}

// The crank follows the pointer over a curve.
function listen(index) {
  const plot = document.getElementById(`plot-${index}`);
  const follow = (event) => event.points?.length && turnTo((event.points[0].x * Math.PI) / 180);
  plot.on("plotly_hover", follow);
  plot.on("plotly_click", follow);
}

// What has a value under the cursor, for every design.
function readings() {
  const basics = ["Y", "V_C", "a_C", "phi", "omega_BC", "alpha_BC", "T_in", "N_C"].filter((name) => HOME[name]);
  const names = [...new Set([...state.shown, ...basics])];
  const labels = labelsOf(state.designs), look = palette();
  const swatch = (k) => `<span class="swatch" style="background:${look.curves[k % look.curves.length]}"></span>`;
  const head = labels.map((label, k) => `<th scope="col">${swatch(k)}${label}</th>`).join("");
  const rows = names.map((name) => {
    const about = CONTENT.quantities[name];
    const cells = state.designs.map((design) => `<td>${digits(valueIn(name, valueAt(name, design, state.theta)), 8)}</td>`);
    const title = `<th scope="row" title="${about.meaning}">${symbol(name)}</th>`;
    return `<tr data-name="${name}">${title}${cells.join("")}<td class="unit">${valueUnit(name)}</td></tr>`;
  });
  const words = state.designs.map((design) => statusWords(design, state.theta));
  if (words.some(Boolean)) {
    rows.push(`<tr class="why"><th scope="row">why</th>${words.map((w) => `<td class="${w ? "stuck" : ""}">${w || "ok"}</td>`).join("")}<td></td></tr>`);
  }
  document.getElementById("readings").innerHTML =
    `<thead><tr><th scope="col"></th>${head}<th scope="col">unit</th></tr></thead><tbody>${rows.join("")}</tbody>`;
  setText("values-theta", degrees(state.theta));
}
