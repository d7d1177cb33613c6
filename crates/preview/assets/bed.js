// The printer's bed: its edge, and a grid of centimetres on it.

// Where the bed begins below the print, mm: both are seen.
const BED_SINK = 0.02;

// Lines of the grid and of the edge, as pairs of places. A bed that is not
// known is a grid a little larger than the box.
function bedLines(plate, [min, max]) {
  const corners = plate ?? [];
  const known = corners.length > 2;
  const ends = known
    ? [0, 1].map(i => [
      Math.min(...corners.map(c => c[i])), Math.max(...corners.map(c => c[i])),
    ])
    : [0, 1].map(i => [
      Math.floor(min[i] / 10 - 1) * 10, Math.ceil(max[i] / 10 + 1) * 10,
    ]);
  const grid = [];
  for (const along of [0, 1]) {
    const across = 1 - along;
    const [low, high] = ends[across];
    for (let at = Math.ceil(low / 10) * 10; at <= high; at += 10) {
      const stretches = known
        ? crossings(corners, across, at) : [ends[along]];
      for (const stretch of stretches) {
        for (const place of stretch) {
          const point = [0, 0, -BED_SINK];
          [point[along], point[across]] = [place, at];
          grid.push(...point);
        }
      }
    }
  }
  const edge = corners.flatMap(([x, y], i) => {
    const [nextX, nextY] = corners[(i + 1) % corners.length];
    return [x, y, 0, nextX, nextY, 0];
  });
  return { grid, edge };
}

// Where the line at a coordinate is within an outline, from … to.
function crossings(corners, across, at) {
  const along = 1 - across;
  const places = [];
  corners.forEach((a, i) => {
    const b = corners[(i + 1) % corners.length];
    if ((a[across] <= at) !== (b[across] <= at)) {
      const share = (at - a[across]) / (b[across] - a[across]);
      places.push(a[along] + share * (b[along] - a[along]));
    }
  });
  places.sort((a, b) => a - b);
  return Array.from({ length: places.length >> 1 },
    (_, i) => places.slice(2 * i, 2 * i + 2));
}
