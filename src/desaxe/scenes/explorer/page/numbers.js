// Numbers as a person reads them: units of the controls, digits, names with subscripts.

const CONTENT = JSON.parse(document.getElementById("content").textContent);

// The shown unit, how many of it make one SI unit, and the power of ten where it is one.
const SHOWN = {
  m: ["mm", 1e3, "e-3"],
  "kg*m^2": ["kg·mm²", 1e6, "e-6"],
  "rad/s": ["rpm", 30 / Math.PI],
  rad: ["°", 180 / Math.PI],
};
const shownUnit = (unit) => (SHOWN[unit] ?? [printedUnit(unit)])[0];
const toShown = (unit, value) => value * (SHOWN[unit]?.[1] ?? 1);

// In SI units. By its digits where that is a power of ten, so that 62.3 mm is the double nearest to 0.0623.
function toSI(unit, value) {
  const [, many, power] = SHOWN[unit] ?? ["", 1];
  return power && /^-?[\d.]+$/.test(value) ? Number(`${value}${power}`) : value / many;
}

const SUPERSCRIPT = { 2: "²", 3: "³", 4: "⁴", 5: "⁵" };
const GREEK = { theta: "θ", alpha: "α", omega: "ω", omega0: "ω₀", phi: "φ", delta: "δ", mu: "μ" };

function printedUnit(unit) {
  if (unit === "1") return "";
  return unit.replace(/\^(\d)/g, (_, digit) => SUPERSCRIPT[digit]).replace(/\*/g, "·");
}

// A number with so many digits, without a tail of zeros; a minus sign is a minus sign.
function digits(value, count = 6) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-4 ? value.toExponential(count - 1) : value.toPrecision(count);
  const [mantissa, exponent] = text.split("e");
  const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
  const power = exponent === undefined ? "" : ` × 10${raised(exponent.replace("+", ""))}`;
  return (short + power).replace(/^-/, "−");
}

function raised(text) {
  return [...text].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
}

function shownInput(name, value) {
  const unit = CONTENT.inputs[name].unit;
  return `${digits(toShown(unit, value))} ${shownUnit(unit)}`.trim();
}

// a_C_wrt_ec -> ∂a_C/∂ec, with subscripts as HTML or as plain text.
function symbol(name, html = true) {
  const about = CONTENT.quantities[name];
  if (!about || !about.by.length) return plainSymbol(name, html);
  const order = about.by.length > 1 ? SUPERSCRIPT[about.by.length] : "";
  const under = about.by.map((p) => `∂${plainSymbol(p, html)}`).join(" ");
  return `∂${order}${plainSymbol(about.base, html)}/${under}`;
}

function plainSymbol(name, html) {
  const [head, ...rest] = name.split("_");
  if (head.length > 5 && !GREEK[head]) return name.replaceAll("_", " ");
  const base = GREEK[head] ?? head;
  if (!rest.length) return base;
  return html ? `${base}<sub>${rest.join(",")}</sub>` : `${base}_${rest.join("_")}`;
}
