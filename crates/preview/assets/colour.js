// What the colours of the beads mean: roles, or a number of each move.

// The colours of the roles in their order, and then that of travels.
const COLOURS = [
  "#e0703a", "#eebc4e", "#4458c9", "#3aa79a", "#d64550", "#5b8cc9", "#8a68bf",
  "#58b4e0", "#ee9aa6", "#a85c4f", "#7ea35b", "#4d7a43", "#2f8f74", "#b9a57f",
  "#a1a6ac", "#8d99a8", "#6485b5",
];
const CUSTOM = 14;
// Colours from low to high, which can be told apart on light and dark grounds.
const RAMP = [
  "#4f3f96", "#4062a8", "#2f87a6", "#26a28d",
  "#55bd68", "#98cf45", "#d8d63c", "#fbb92f",
];
const MODES = {
  role: null,
  speed: { unit: "mm/s", digits: 0, of: i => moves.speed(i) },
  width: { unit: "mm", digits: 2, of: i => moves.width(i) },
  height: { unit: "mm", digits: 2, of: i => moves.height(i) },
  flow: { unit: "mm³/s", digits: 1, of: i => moves.flow(i) },
  heat: { unit: "°C", digits: 0, of: i => moves.heat(i) },
  fan: { unit: "%", digits: 0, of: i => moves.fans[i] },
  time: { unit: "s a layer", digits: 0, of: i => told.time[moves.layers[i]] },
};
// Number of bars of the histogram.
const BARS = 60;

function setMode(mode) {
  state.mode = mode;
  for (const button of $("modes").children) {
    button.setAttribute("aria-pressed", button.dataset.mode === mode);
  }
  if (!told) {
    return;
  }
  const how = MODES[mode];
  $("scale").hidden = how === null;
  for (const row of $("roles").tBodies[0].rows) {
    const role = Number(row.dataset.role);
    const neutral = how !== null && role !== TRAVEL;
    row.style.setProperty(
      "--colour", neutral ? "var(--soft)" : COLOURS[role]);
  }
  if (how === null) {
    scene.colourBy(null);
  } else {
    const scale = measure(how.of);
    scene.colourBy(how.of, scale.low, scale.high);
    showScale(scale, how);
  }
  redraw(false);
}
// Where most of the numbers lie, by length, and how they are spread.
function measure(of) {
  const counted = i => moves.roles[i] < TRAVEL && moves.roles[i] !== CUSTOM;
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < moves.count; i++) {
    if (counted(i)) {
      const number = of(i);
      low = Math.min(low, number);
      high = Math.max(high, number);
    }
  }
  if (!(high > low)) {
    const only = Number.isFinite(low) ? low : 0;
    return { low: only, high: only, bars: [] };
  }
  const spread = bins => {
    const bars = new Float64Array(bins);
    const scale = bins / (high - low);
    for (let i = 0; i < moves.count; i++) {
      if (counted(i)) {
        const bin = Math.floor((of(i) - low) * scale);
        if (bin >= 0 && bin <= bins) {
          bars[Math.min(bins - 1, bin)] += moves.length(i);
        }
      }
    }
    return bars;
  };
  // A few moves with numbers far out would leave one colour for all the others.
  const fine = spread(4096);
  const total = fine.reduce((sum, bar) => sum + bar, 0);
  const at = share => {
    let sum = 0;
    return fine.findIndex(bar => (sum += bar) >= share * total);
  };
  const bin = (high - low) / fine.length;
  const [from, to] = [at(0.002), at(0.998)];
  if (from > 8) {
    low += from * bin;
  }
  if (to >= 0 && to < fine.length - 9) {
    high -= (fine.length - 1 - to) * bin;
  }
  return { low, high, bars: high > low ? spread(BARS) : [] };
}

function showScale({ low, high, bars }, { unit, digits }) {
  const highest = Math.max(...bars, 1e-9);
  const width = 240 / BARS;
  // The bars show roots, so that what is rare can be seen beside what is
  // common.
  const path = [...bars].map((bar, i) => {
    const tall = 36 * Math.sqrt(bar / highest);
    return tall > 0
      ? `M${i * width} 36v${-tall.toFixed(1)}h${width}v${tall.toFixed(1)}z`
      : "";
  });
  const shape = document.createElementNS("http://www.w3.org/2000/svg", "path");
  shape.setAttribute("d", path.join(""));
  $("histogram").replaceChildren(shape);
  $("ramp").style.background = `linear-gradient(90deg, ${RAMP.join(", ")})`;
  const say = number => number.toFixed(digits);
  $("scale-low").textContent = say(low);
  $("scale-middle").textContent = `${say((low + high) / 2)} ${unit}`;
  $("scale-high").textContent = say(high);
}

