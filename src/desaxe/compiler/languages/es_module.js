/** A number as it is; text, which would be read as one, and anything else is refused. */
function number(name, value) {
  if (typeof value === "number") return value;
  const shown = typeof value === "string" ? JSON.stringify(value) : String(value);
  throw new TypeError(`${name} = ${shown}: expected numbers in SI units`);
}

/** All outputs by name; numbers, or arrays of one length (a number goes with every element). */
export function evaluate(inputs) {
  const isArray = (value) => Array.isArray(value) || (ArrayBuffer.isView(value) && "length" in value);
  for (const name of INPUTS) {
    if (inputs[name] === undefined) throw new TypeError(`${name} is missing (needed: ${INPUTS})`);
    if (!isArray(inputs[name])) number(name, inputs[name]);
  }
  const given = INPUTS.map((name) => inputs[name]);
  const lengths = given.filter(isArray).map((value) => value.length);
  if (!lengths.length) {
    const found = values(...given);
    return Object.fromEntries(OUTPUTS.map((name, place) => [name, found[place]]));
  }
  if (lengths.some((length) => length !== lengths[0])) throw new RangeError("arrays must have one length");
  const arrays = OUTPUTS.map(() => new Float64Array(lengths[0]));
  for (let k = 0; k < lengths[0]; k++) {
    const point = given.map((value, place) => (isArray(value) ? number(INPUTS[place], value[k]) : value));
    values(...point).forEach((one, place) => {
      arrays[place][k] = one;
    });
  }
  return Object.fromEntries(OUTPUTS.map((name, place) => [name, arrays[place]]));
}
