// The mechanism to scale. X points to the right and Y up, along the slider axis: theta turns clockwise.

const NAMESPACE = "http://www.w3.org/2000/svg";

// Where everything is in one design at one angle [m]; C is missing where the rod does not reach.
function jointsAt(design, theta) {
  const B = [design.AB * Math.sin(theta), design.AB * Math.cos(theta)];
  const Y = valueAt("Y", design, theta);
  return { A: [0, 0], B, C: Number.isFinite(Y) ? [-design.ec, Y] : null };
}

// Metres to pixels, so that every position of every design fits.
function viewOf(designs, width, height) {
  const reach = (pick) => Math.max(...designs.map(pick));
  const crank = reach((d) => d.AB), far = reach((d) => d.AB + d.BC);
  const body = 0.07 * far, foot = 40;
  const [low, high] = CONTENT.branch > 0 ? [-crank, far] : [-far, crank];
  const left = Math.max(crank, reach((d) => d.ec)) + body, right = Math.max(crank, reach((d) => -d.ec)) + body;
  const scale = Math.min((width - 36) / (left + right), (height - foot - 8) / (high - low + 2 * body));
  const middle = width / 2 + ((left - right) / 2) * scale;
  const base = 8 + (height - foot - 8 + (high + low) * scale) / 2;
  return { scale, width, height, foot, place: ([X, Y]) => [middle + X * scale, base - Y * scale] };
}

function drawMechanism(designs, theta) {
  const box = document.getElementById("mechanism");
  const width = box.clientWidth || 320, height = Math.max(340, Math.min(470, width * 1.3));
  const view = viewOf(designs, width, height);
  const look = palette();
  const parts = [...designs.keys()].reverse().map((k) => linkage(designs[k], theta, view, look, k));
  const svg =
    `<svg xmlns="${NAMESPACE}" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" ` +
    `font-family="system-ui, sans-serif" font-size="12" role="img" aria-label="${spoken(designs[0], theta)}">` +
    `${frame(designs[0], theta, view, look)}${parts.join("")}${scaleBar(view, look)}</svg>`;
  box.innerHTML = svg;
}

function spoken(design, theta) {
  return `Mechanism at a crank angle of ${degrees(theta, 1)}; ${statusWords(design, theta) || "assembled"}`;
}

const path = (points) => points.map((p, k) => `${k ? "L" : "M"}${p.map((v) => v.toFixed(2)).join(" ")}`).join("");
const stroked = (d, colour, wide, more = "") =>
  `<path d="${d}" fill="none" stroke="${colour}" stroke-width="${wide}" stroke-linecap="round" ${more}/>`;
const disc = ([x, y], r, fill, stroke) =>
  `<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${r}" fill="${fill}" stroke="${stroke}" stroke-width="1.5"/>`;
const text = ([x, y], words, colour, more = "") => `<text x="${x}" y="${y}" fill="${colour}" ${more}>${words}</text>`;
const halo = (look) => `paint-order="stroke" stroke="${look.panel}" stroke-width="4" stroke-linejoin="round"`;

const arrow = ([x, y], [dx, dy], colour) => // a head at a place, in a direction of length 1
  `<path d="M${x} ${y}l${-7 * dx - 3.5 * dy} ${-7 * dy + 3.5 * dx}l${7 * dy} ${-7 * dx}z" fill="${colour}"/>`;

// What stands still: X and Y through A, the slider axis, the crank circle, the frame, the eccentricity.
function frame(design, theta, { place, scale, height, foot }, look) {
  const [ax, ay] = place([0, 0]), axis = place([-design.ec, 0])[0], r = design.AB * scale, floor = height - foot;
  const arc = Math.min(r * 0.45, 34), turn = theta % TURN;
  const end = [ax + arc * Math.sin(turn), ay - arc * Math.cos(turn)];
  const sweep = `M${ax} ${ay - arc}A${arc} ${arc} 0 ${Math.abs(turn) > Math.PI ? 1 : 0} ${turn < 0 ? 0 : 1} ${end.join(" ")}`;
  const half = turn / 2, tag = [ax + (arc + 11) * Math.sin(half) - 4, ay - (arc + 11) * Math.cos(half) + 4];
  const right = ax + Math.max(r, arc) + 22, top = 10;
  const parts = [
    stroked(path([[axis, 10], [axis, floor]]), look.line, 1, 'stroke-dasharray="10 3 2 3"'),
    `<circle cx="${ax}" cy="${ay}" r="${r}" fill="none" stroke="${look.line}" stroke-dasharray="2 4"/>`,
    stroked(path([[ax, floor], [ax, top]]), look.line, 1), arrow([ax, top], [0, -1], look.soft),
    stroked(path([[ax, ay], [right, ay]]), look.line, 1), arrow([right, ay], [1, 0], look.soft),
    text([right - 10, ay - 8], "X", look.soft), text([ax + (axis <= ax ? 7 : -15), top + 8], "Y", look.soft),
    stroked(sweep, look.soft, 1.2), text(tag, "θ", look.soft),
    `<path d="M${ax} ${ay}l-9 15h18z" fill="${look.panel}" stroke="${look.soft}" stroke-width="1.5"/>`,
    stroked(path([[ax - 14, ay + 15], [ax + 14, ay + 15]]), look.soft, 1.5),
  ];
  if (Math.abs(ax - axis) > 14) {
    const y = Math.min(floor - 4, ay + r + 16), way = Math.sign(ax - axis);
    parts.push(stroked(path([[axis, y], [ax, y]]), look.soft, 1), stroked(path([[ax, y + 4], [ax, ay + 18]]), look.line, 1));
    parts.push(arrow([axis, y], [-way, 0], look.soft), arrow([ax, y], [way, 0], look.soft));
    parts.push(text([(ax + axis) / 2, y - 5], "ec", look.soft, 'text-anchor="middle"'));
  }
  return parts.join("");
}

function linkage(design, theta, { place, scale }, look, index) {
  const { A, B, C } = jointsAt(design, theta), colour = look.curves[index % look.curves.length];
  const [a, b] = [place(A), place(B)], current = index === 0;
  const wide = current ? 6 : 3;
  const parts = [];
  if (C) {
    const c = place(C), w = current ? 22 : 18, h = current ? 34 : 28;
    parts.push(stroked(path([b, c]), colour, wide));
    parts.push(
      `<rect x="${c[0] - w / 2}" y="${c[1] - h / 2}" width="${w}" height="${h}" rx="3" fill="${look.panel}" ` +
        `stroke="${colour}" stroke-width="${current ? 2.5 : 1.5}"/>`,
    );
    parts.push(disc(c, current ? 4 : 2.5, look.panel, colour));
    if (current) parts.push(text([c[0] + (design.ec > 0 ? -w / 2 - 13 : w / 2 + 5), c[1] + 4], "C", look.ink, halo(look)));
  } else if (current) {
    const r = design.BC * scale;
    parts.push(`<circle cx="${b[0]}" cy="${b[1]}" r="${r}" fill="none" stroke="${look.bad}" stroke-width="1.2" stroke-dasharray="6 5"/>`);
    const side = Math.sign(place([-design.ec, 0])[0] - b[0]) || 1;
    parts.push(stroked(path([b, [b[0] + side * r, b[1]]]), look.bad, 3));
    parts.push(text([12, 20], "the rod does not reach", look.bad, `font-weight="600" ${halo(look)}`));
  }
  parts.push(stroked(path([a, b]), colour, wide + 1));
  parts.push(disc(a, current ? 5 : 3, look.panel, colour), disc(b, current ? 5 : 3, look.panel, colour));
  if (current) parts.push(text([a[0] - 17, a[1] + 4], "A", look.ink, halo(look)), text([b[0] + 9, b[1] + 4], "B", look.ink, halo(look)));
  return `<g opacity="${current ? 1 : 0.6}">${parts.join("")}</g>`;
}

function scaleBar({ scale, width, height }, look) {
  const most = toShown("BC", width / 3 / scale);
  const length = toSI("BC", String(Math.max(...[1, 2, 5].map((m) => niceBelow(most, m)))));
  const end = 12 + length * scale, y = height - 12;
  const bar = `M12 ${y - 4}v8M12 ${y}H${end}M${end} ${y - 4}v8`;
  return stroked(bar, look.soft, 1.2) + text([end + 6, y + 4], shownInput("BC", length), look.soft);
}

const niceBelow = (limit, m) => m * 10 ** Math.floor(Math.log10(limit / m));
