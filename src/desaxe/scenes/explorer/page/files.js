// What can be taken away: the scene, the values, a picture.

function offer(name, type, data) {
  const link = document.createElement("a");
  link.href = typeof data === "string" && data.startsWith("data:") ? data : URL.createObjectURL(new Blob([data], { type }));
  link.download = name;
  link.click();
  if (link.href.startsWith("blob:")) setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const SECTIONS = ["mechanism", "motion", "masses", "loads"];

// A value with the unit that is chosen, where that stands for the same double; else in SI units.
function written(name, value) {
  if (!Object.keys(units.values).length) return String(value);
  const text = String(Number(toShown(name, value).toPrecision(15))), unit = siUnit(name);
  if (unit === "1") return String(value);
  return toSI(name, text) === value ? `"${text} ${fieldUnit(name)}"` : `"${value} ${unit}"`;
}

// The designs as one scene, where they differ in one input; else the one that is being changed.
function sceneText() {
  const { designs, shown } = state;
  const differing = differingInputs(designs);
  const kept = differing.length === 1 ? designs : designs.slice(0, 1);
  const own = Object.entries(units.values).map(([unit, shown]) => `${CONTENT.dimensions[unit] ?? unit} = "${shown}"`);
  const loadOf = (name, added) => {
    const text = CONTENT.loads[name].saved[own.length ? 1 : 0];
    return added ? `[${text.startsWith("[") ? text.slice(1, -1) : text}, "${added} N"]` : text;
  };
  const valueOf = (name) => name in CONTENT.loads ? loadOf(name, kept[0][name]) : (differing.length === 1 && name === differing[0]
    ? `[${[...new Set(kept.map((d) => written(name, d[name])))].join(", ")}]`
    : written(name, kept[0][name]));
  const told = own.length ? "" : ", in SI units and radians";
  const lines = [`# Written by the explorer page of desaxe${told}: desaxe run scene.toml`, ""];
  lines.push(`title = ${JSON.stringify(CONTENT.title)}`, `outputs = ${JSON.stringify([...new Set(shown)])}`);
  if (own.length) lines.push("", "[units]", ...own);
  for (const section of SECTIONS) {
    const names = Object.keys(CONTENT.inputs).filter((name) => CONTENT.inputs[name].section === section);
    const given = names.filter((name) => CONTENT.inputs[name].given || kept.some((d) => d[name] !== 0));
    if (!given.length) continue;
    lines.push("", `[${section}]`, ...given.map((name) => `${name} = ${valueOf(name)}${own.length ? "" : ` # ${CONTENT.inputs[name].unit}`}`));
    if (section === "mechanism") lines.push(`branch = ${CONTENT.branch}`);
    if (section === "motion") {
      const [from, to] = CONTENT.theta.map((angle) => written("theta", angle));
      lines.push(`theta = { start = ${from}, stop = ${to}, num = ${SAMPLES} }`);
    }
  }
  for (const [name, table] of Object.entries(CONTENT.definitions)) {
    const constants = Object.entries(table.constants ?? {}).map(([constant, value]) => `${constant} = ${value}`);
    const texts = ["expression", "unit", "meaning"].map((key) => `${key} = ${JSON.stringify(table[key])}`);
    lines.push("", `[quantities.${name}]`, ...texts, ...(constants.length ? [`constants = { ${constants.join(", ")} }`] : []));
  }
  return lines.join("\n") + "\n";
}

// One row an angle, in the units that are chosen; nothing where there is no value, all digits of a double.
function valuesText() {
  const labels = labelsOf(state.designs);
  const names = [...new Set([...state.shown, "status"])];
  const columns = state.designs.flatMap((design, k) => names.map((name) => ({ design, name, label: labels[k] })));
  const titleOf = ({ name, label }) => `"${name} [${shownIn(name)[0]}] (${label})"`;
  const printed = (value) => (Number.isFinite(value) ? String(value) : "");
  const [angle, times] = inUnits("rad");
  const rows = evenAngles().map((theta) =>
    [theta * times, ...columns.map(({ design, name }) => printed(valueIn(name, valueAt(name, design, theta))))].join(","),
  );
  return [[`"theta [${angle}]"`, ...columns.map(titleOf)].join(","), ...rows].join("\n") + "\n";
}

const loaded = (source) =>
  new Promise((done, failed) => {
    const image = new Image();
    image.onload = () => done(image);
    image.onerror = failed;
    image.src = source;
  });

// The mechanism above the two charts, twice as fine as a screen.
async function pictureData() {
  const width = 900, scale = 2, look = palette();
  const svg = document.querySelector("#mechanism svg");
  const plots = charts.map((_, index) => document.getElementById(`plot-${index}`));
  const drawn = await loaded(`data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg.outerHTML)}`);
  const images = [];
  for (const plot of plots) images.push(await loaded(await Plotly.toImage(plot, { format: "png", width, height: 340, scale })));
  const canvas = document.createElement("canvas"), tall = +svg.getAttribute("height");
  Object.assign(canvas, { width: width * scale, height: (tall + 30 + 340 * images.length) * scale });
  const pen = canvas.getContext("2d");
  pen.scale(scale, scale);
  pen.fillStyle = look.panel;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = look.ink;
  pen.font = "600 16px system-ui, sans-serif";
  pen.fillText(CONTENT.title, 12, 22);
  pen.drawImage(drawn, (width - +svg.getAttribute("width")) / 2, 30, +svg.getAttribute("width"), tall);
  images.forEach((image, k) => pen.drawImage(image, 0, 30 + tall + 340 * k, width, 340));
  return canvas.toDataURL("image/png");
}

function listenToFiles() {
  const on = (id, action) => document.getElementById(id).addEventListener("click", action);
  on("save-scene", () => offer("scene.toml", "application/toml", sceneText()));
  on("save-csv", () => offer("values.csv", "text/csv", valuesText()));
  on("save-png", async () => offer("picture.png", "image/png", await pictureData()));
}
