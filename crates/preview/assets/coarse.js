// The print with fewer moves, which is drawn while the view turns.
//
// Moves of one purpose that follow each other on nearly a line become one.
// Points, heights and roles stand in `moves` as they do for the whole print.
// `first` has each layer's first move, and `of` the move of the print with which
// each coarse one begins.

// Greatest distance of a point from the line that replaces it, mm.
const COARSE = 0.12;
// Greatest number of moves that become one.
const MERGED = 24;

function coarsen(moves, told) {
  const { points, roles, count } = moves;
  const limit = (COARSE / told.unit) ** 2;
  const of = new Uint32Array(count);
  const first = new Uint32Array(told.first.length);
  let [made, layer] = [0, 0];

  // Whether all points between two lie near the line from one to the other.
  // This is called for every move, so it works on plain numbers.
  const straight = (from, to) => {
    const x = points[4 * from];
    const y = points[4 * from + 1];
    const dx = points[4 * to] - x;
    const dy = points[4 * to + 1] - y;
    const square = dx * dx + dy * dy;
    for (let at = 4 * from + 4; at < 4 * to; at += 4) {
      const px = points[at] - x;
      const py = points[at + 1] - y;
      let along = square > 0 ? (px * dx + py * dy) / square : 0;
      along = along < 0 ? 0 : along > 1 ? 1 : along;
      const ox = px - along * dx;
      const oy = py - along * dy;
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
    for (let axis = 0; axis < 3; axis++) {
      coarse[4 * i + 4 + axis] = points[4 * end + axis];
    }
    coarse[4 * i + 7] = points[4 * of[i] + 7];
  }
  return { count: made, points: coarse, first, of: of.subarray(0, made) };
}
