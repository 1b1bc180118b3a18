// Numbers as a person reads them: units of the controls, digits, names with subscripts.

const embedded = (id) => JSON.parse(document.getElementById(id).textContent);
const CONTENT = embedded("content");
// The module that computes all values, as `desaxe compile --to javascript` writes it.
const MODULE = { ...(await import(URL.createObjectURL(new Blob([embedded("module")], { type: "text/javascript" })))) };

// What one of a unit is in its SI unit, as an exact fraction; pi with fifty digits.
const DIGITS = 10n ** 50n, PI = 314159265358979323846264338327950288419716939937510n;
const ONE = [1n, 1n];
const SIZES = {
  mm: [1n, 1000n], cm: [1n, 100n], in: [127n, 5000n], "kg*mm^2": [1n, 1000000n],
  deg: [PI, 180n * DIGITS], rpm: [PI, 30n * DIGITS],
  ...Object.fromEntries(Object.entries(CONTENT.sizes).map(([unit, size]) => [unit, size.map(BigInt)])),
};
const many = (unit) => {
  const [p, q] = (SIZES[unit] ?? ONE).map(Number);
  return q / p;
};

// What the fields are in, and what values, tables and files are in: SI unit, or the name of a quantity or input,
// -> unit. What is not named is in SI.
const FIELDS = { m: "mm", "kg*m^2": "kg*mm^2", "rad/s": "rpm", rad: "deg", ...CONTENT.fields };
const ASKED = { title: Object.values(CONTENT.units).join(", "), fields: { ...FIELDS, ...CONTENT.units }, values: CONTENT.units };
const UNITS = {
  ...(ASKED.title ? { asked: ASKED } : {}),
  si: { title: "values in SI: m, rad, s", fields: FIELDS, values: {} },
  mm: { title: "mm, °, rpm", fields: FIELDS, values: { m: "mm", rad: "deg", "rad/s": "rpm" } },
  in: { title: "inch, °, rpm", fields: { ...FIELDS, m: "in" }, values: { m: "in", rad: "deg", "rad/s": "rpm" } },
  all: { title: "all in SI: m, rad, rad/s", fields: {}, values: {} },
};
let units = Object.values(UNITS)[0];

// The unit of the field of an input, or of a quantity with an SI unit.
const fieldUnit = (name) => units.fields[name] ?? units.fields[siUnit(name)] ?? siUnit(name);
const siUnit = (name) => CONTENT.parameters[name] ?? name;
const shownUnit = (name) => printedUnit(fieldUnit(name));
const toShown = (name, value) => value * many(fieldUnit(name));

// A text in the unit of its field, in SI units: the exact product, rounded once, as Python reads "62.3 mm".
function toSI(name, text) {
  const found = /^([-+]?)(\d*)\.?(\d*)(?:[eE]([-+]?\d+))?$/.exec(text.trim());
  if (!found || !(found[2] + found[3])) return NaN;
  const [, sign, whole, part, power] = found, [p, q] = SIZES[fieldUnit(name)] ?? ONE;
  const scaled = (BigInt(whole + part) * p * 10n ** 60n) / q;
  return Number(`${sign}${scaled}e${Number(power ?? 0) - part.length - 60}`);
}

// The unit of a value, and how many of it make one SI unit. A derivative is a quotient of units.
function shownIn(name) {
  const about = CONTENT.quantities[name];
  if (!about?.by.length) return inUnits((about ?? CONTENT.inputs[name] ?? { unit: name }).unit, name);
  const below = about.by.map((p) => inUnits(siUnit(p), p)), top = inUnits(CONTENT.quantities[about.base].unit, about.base);
  const times = below.reduce((product, [, each]) => product / each, top[1]);
  return times === 1 ? [about.unit, 1] : [[top[0], ...below.map(([unit]) => unit)].join("/"), times];
}

function inUnits(unit, name) {
  const own = units.values[name] ?? units.values[unit];
  if (own) return [own, many(own)];
  const speed = /^m(\/s(?:\^\d)?)$/.exec(unit);
  return speed && units.values.m ? [units.values.m + speed[1], many(units.values.m)] : [unit, 1];
}

const valueUnit = (name) => printedUnit(shownIn(name)[0]);
const valueIn = (name, value) => value * shownIn(name)[1];
const withUnit = (name, value, count) => `${digits(valueIn(name, value), count)} ${valueUnit(name)}`.trim();

const SUPERSCRIPT = { 2: "²", 3: "³", 4: "⁴", 5: "⁵" };
const GREEK = { theta: "θ", alpha: "α", omega: "ω", omega0: "ω₀", phi: "φ", delta: "δ", mu: "μ" };

function printedUnit(unit) {
  if (unit === "1") return "";
  return unit.replace(/\bdeg\b/g, "°").replace(/\^(\d)/g, (_, digit) => SUPERSCRIPT[digit]).replace(/\*/g, "·");
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

const shownInput = (name, value) => `${digits(toShown(name, value))} ${shownUnit(name)}`.trim();

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
