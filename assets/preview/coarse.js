// The same print with fewer moves, for while it is turned.
//
// Moves of one purpose that follow each other on nearly a line become one.
// What stands in `moves` as for the whole print: points, heights, roles;
// `first` has each layer's first move, `of` which move of the print each one
// begins with.

// Greatest distance of a point from the line that replaces it, mm.
const COARSE = 0.12;
// Most moves in one.
const MERGED = 24;

function coarsen(moves, told) {
  const { points, roles, count } = moves;
  const limit = (COARSE / told.unit) ** 2;
  const of = new Uint32Array(count);
  const first = new Uint32Array(told.first.length);
  let [made, layer] = [0, 0];

  // Whether all points between two lie near the line from one to the other.
  const straight = (from, to) => {
    const [x, y] = [points[4 * from], points[4 * from + 1]];
    const [dx, dy] = [points[4 * to] - x, points[4 * to + 1] - y];
    const square = dx * dx + dy * dy;
    for (let i = from + 1; i < to; i++) {
      const [px, py] = [points[4 * i] - x, points[4 * i + 1] - y];
      const along = square > 0
        ? Math.max(0, Math.min(1, (px * dx + py * dy) / square)) : 0;
      const [ox, oy] = [px - along * dx, py - along * dy];
      if (ox * ox + oy * oy > limit) {
        return false;
      }
    }
    return true;
  };

  for (let i = 0; i < count;) {
    while (layer < told.first.length && told.first[layer] <= i) {
      first[layer++] = made;
    }
    of[made++] = i;
    const stop = Math.min(count, i + MERGED,
      layer < told.first.length ? told.first[layer] : count);
    let next = i + 1;
    while (next < stop && roles[next] === roles[i] && roles[i] < TRAVEL
      && points[4 * next + 6] === points[4 * i + 6]
      && straight(i, next + 1)) {
      next++;
    }
    i = next;
  }
  first.fill(made, layer);

  const coarse = new Uint16Array(4 * (made + 1));
  coarse.set(points.subarray(0, 4));
  for (let i = 0; i < made; i++) {
    const end = i + 1 < made ? of[i + 1] : count;
    coarse.set(points.subarray(4 * end, 4 * end + 3), 4 * (i + 1));
    coarse[4 * (i + 1) + 3] = points[4 * of[i] + 7];
  }
  return { count: made, points: coarse, first, of: of.subarray(0, made) };
}
