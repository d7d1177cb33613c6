// Which bead is under the pointer, and what is said of it.
//
// A bead's section is taken as an ellipse, and its ends as round: in a space
// whose z is stretched until the section is a circle, a bead is a capsule.

// The nearest bead that a ray meets, or -1. `ray` has `from` and `along`, mm;
// `shown` is what is shown; `ahead` tells from where to where along the ray
// beads count.
function nearestBead(ray, { low, end, hidden }, ahead) {
  const { points, roles, heights } = moves;
  const { unit, origin, length_unit: lengthUnit } = told;
  const [dx, dy, dz] = ray.along;
  const [ex, ey, ez] = ray.from;
  let [best, bestAt] = [-1, Infinity];
  for (let i = told.first[low]; i < end; i++) {
    const role = roles[i];
    if (role >= TRAVEL || hidden >>> role & 1) {
      continue;
    }
    const p = 4 * i;
    const width = points[p + 7] * lengthUnit;
    const height = heights[i] * lengthUnit;
    if (!(width > 0 && height > 0)) {
      continue;
    }
    const ax = origin[0] + unit * points[p] - ex;
    const ay = origin[1] + unit * points[p + 1] - ey;
    const az = origin[2] + unit * points[p + 2] - height / 2 - ez;
    const bx = origin[0] + unit * points[p + 4] - ex;
    const by = origin[1] + unit * points[p + 5] - ey;
    const bz = origin[2] + unit * points[p + 6] - height / 2 - ez;
    // Most beads are far from the ray: the middle is farther than half of the
    // length and the width.
    const mx = (ax + bx) / 2;
    const my = (ay + by) / 2;
    const mz = (az + bz) / 2;
    const along = mx * dx + my * dy + mz * dz;
    const off = mx * mx + my * my + mz * mz - along * along;
    const length = (bx - ax) ** 2 + (by - ay) ** 2 + (bz - az) ** 2;
    if (off > length / 2 + 2 * Math.max(width, height) ** 2) {
      continue;
    }
    const stretch = width / height;
    const at = enters(
      [ax, ay, az * stretch], [bx, by, bz * stretch], width / 2,
      [dx, dy, dz * stretch], ahead);
    if (at < bestAt) {
      [best, bestAt] = [i, at];
    }
  }
  return best;
}

// Where a ray from the origin enters the capsule round a–b, or Infinity. The
// ray's multiples are kept, so that stretched spaces compare.
function enters(a, b, radius, d, { from, to }) {
  const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  const ba = [0, 1, 2].map(k => b[k] - a[k]);
  // Squared distance of a place on the ray from the axis, less the radius'.
  const outside = t => {
    const p = [0, 1, 2].map(k => t * d[k] - a[k]);
    const size = dot(ba, ba);
    const share = size > 0 ? Math.max(0, Math.min(1, dot(p, ba) / size)) : 0;
    const q = [0, 1, 2].map(k => p[k] - share * ba[k]);
    return dot(q, q) - radius * radius;
  };
  // The distance has one least place along the ray, found by thirds.
  const dd = dot(d, d);
  const reach = (Math.sqrt(dot(ba, ba)) / 2 + radius) / Math.sqrt(dd);
  const middle = dot(d, [0, 1, 2].map(k => (a[k] + b[k]) / 2)) / dd;
  let low = Math.max(from, middle - reach);
  let high = Math.min(to, middle + reach);
  if (low > high) {
    return Infinity;
  }
  if (outside(low) <= 0) {
    return low;
  }
  const start = low;
  for (let i = 0; i < 60; i++) {
    const [p, q] = [low + (high - low) / 3, high - (high - low) / 3];
    if (outside(p) <= 0) {
      high = p;
      break;
    }
    if (outside(p) < outside(q)) {
      high = q;
    } else {
      low = p;
    }
  }
  if (outside(high) > 0) {
    return Infinity;
  }
  // The surface lies between the start and there.
  let before = start;
  for (let i = 0; i < 40; i++) {
    const p = (before + high) / 2;
    if (outside(p) > 0) {
      before = p;
    } else {
      high = p;
    }
  }
  return high;
}

// Picks the bead at a place of the window, or none.
function pickAt(x, y) {
  const canvas = $("view");
  const ray = camera.ray(x, y, canvas.clientWidth, canvas.clientHeight);
  pick(nearestBead(ray, shown(), cut.stretch(ray)));
}

function pick(move) {
  state.picked = move;
  $("picked").hidden = move < 0;
  if (move >= 0) {
    tellPicked(move);
  }
  redraw(false);
}

function tellPicked(i) {
  const role = moves.roles[i];
  const name = role < TRAVEL ? told.role_names[role] : "travel";
  $("picked").querySelector("h2").textContent = name;
  const list = $("picked").querySelector("dl");
  list.replaceChildren();
  const add = (name, text, className = "") => list.append(
    element("dt", name), element("dd", text, { className }));
  const layer = moves.layers[i];
  const place = i => moves.place(i).map(n => n.toFixed(2)).join(", ");
  add("Line", String(moves.lines[i]));
  add("Layer", `${layer + 1}, ${told.z[layer].toFixed(2)} mm`);
  if (role < TRAVEL) {
    add("Bead", `${moves.width(i).toFixed(2)} × ${moves.height(i).toFixed(2)} mm`);
    add("Flow", `${moves.flow(i).toFixed(1)} mm³/s`);
  }
  add("Speed", `${moves.speed(i).toFixed(0)} mm/s`);
  add("Length", `${moves.length(i).toFixed(2)} mm`);
  if (moves.heat(i) > 0) {
    add("Nozzle", `${moves.heat(i).toFixed(0)} °C`);
  }
  add("Fan", `${moves.fans[i]} %`);
  add("From", place(i - 1), "wide");
  add("To", place(i), "wide");
  const text = $("picked").querySelector("pre");
  text.textContent = "";
  // Only the program that serves a page has the file's text.
  live?.line(moves.lines[i]).then(line => {
    if (state.picked === i) {
      text.textContent = line;
    }
  });
}

// Shows the print as it is when the nozzle has laid the picked bead.
function goToPicked() {
  const i = state.picked;
  toLayer(moves.layers[i]);
  toMove(i + 1);
}

// The bead that was laid last is picked, without a pointer.
function pickLast() {
  pick(moveSlider.high - 1);
}
