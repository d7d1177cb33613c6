// The page: what is shown, and how it is asked for.

// Time without a change after which the picture is drawn in full, milliseconds.
const REST = 160;
// Time after which a click is no longer the first of two, milliseconds.
const ONE_CLICK = 220;
// Width of a window up to which the panel is below the part, as in style.css.
const NARROW = 640;
// Height of what is written at the top, pixels.
const HEAD = 76;

// What belongs to the print that is shown. A page of `watch` has none at first.
let told = null;
let figures, layerCount, moves, scene, marks;
let camera, layerSlider, moveSlider;
const cut = new Cut();
// Asks the program that serves this page; null if the page is a file.
const live = typeof Live === "undefined" ? null : new Live();

const state = {
  mode: "role",
  // The amount that the table of roles tells.
  amount: "time",
  marks: { seams: false, retractions: false },
  // The move that was picked, and the place that a warning names.
  picked: -1,
  pointed: null,
  hidden: 1 << TRAVEL | 1 << JUMP,
  playing: false,
  // Whether only the highest layer is shown, and the lowest layer before that.
  only: false,
  lowBefore: 0,
};

// The heights that are shown, while there is only a glimpse of a part and the
// user has not moved the slider.
let kept = null;

const layerEnd = layer =>
  layer + 1 < layerCount ? told.first[layer + 1] : told.moves;

// --- drawing

// Nothing is drawn before the page knows how much the graphics card can draw.
let ready = false;
let wanted = false;
let lastFrame = 0;
let lastDrawn = 0;
let moving = false;
let restTimer = 0;
let pickTimer = 0;

// Asks for a picture; `brisk` while the view or the range changes.
function redraw(brisk = true) {
  moving = brisk;
  live?.turned(brisk);
  // Layers that the part's picture hides need not be drawn.
  if (ready && !wanted && !live?.showsPart) {
    wanted = true;
    requestAnimationFrame(frame);
  }
}

function frame(now) {
  wanted = false;
  // Frames that follow each other tell how long one takes.
  if (moving && now - lastFrame < 1000 && lastFrame > 0) {
    lastDrawn = now - lastFrame;
    scene.pace(lastDrawn);
  }
  lastFrame = moving ? now : 0;
  scene.draw(camera, shown(), moving);
  if (moving) {
    clearTimeout(restTimer);
    restTimer = setTimeout(() => {
      lastFrame = 0;
      redraw(false);
    }, REST);
  }
}

let colours = null;

function readColours() {
  const style = getComputedStyle(document.documentElement);
  const read = name => rgb(style.getPropertyValue(name));
  const ground = read("--ground");
  colours = {
    ground,
    grid: read("--grid"),
    edge: read("--edge"),
    accent: read("--accent"),
    pale: ground.map((g, i) => 0.82 * g + 0.18 * read("--soft")[i]),
    colours: COLOURS.map(rgb),
    ramp: RAMP.map(rgb),
  };
}

function shown() {
  const [low, high] = [layerSlider.low, layerSlider.high];
  const end = moveSlider.high;
  const partly = end < layerEnd(high);
  return {
    ...colours,
    low,
    high,
    end,
    hidden: state.hidden >>> 0,
    partly,
    marker: partly ? moves.place(end - 1) : state.pointed,
    marks: Object.keys(MARKS).filter(kind => state.marks[kind]),
    picked: state.picked,
    plane: cut.plane(figures.printed),
  };
}

// --- layers and moves

function sayLayer(layer) {
  return `layer ${layer + 1}, ${told.z[layer].toFixed(2)} mm`;
}

function layersChanged() {
  if (!told) {
    return;
  }
  kept = null;
  state.pointed = null;
  const { low, high } = layerSlider;
  moveSlider.set(told.first[high], layerEnd(high), told.first[high],
    layerEnd(high));
  const say = (output, layer) => output.replaceChildren(
    element("b", String(layer + 1)),
    ` ${told.z[layer].toFixed(2)} mm`);
  say($("layer-high"), high);
  say($("layer-low"), low);
  $("only").setAttribute("aria-pressed", state.only);
  live?.looked();
  movesChanged();
}

function movesChanged() {
  if (!told) {
    return;
  }
  const output = $("move-text");
  const { low: first, high: end } = moveSlider;
  const count = layerEnd(layerSlider.high) - first;
  const at = end - 1;
  if (end >= first + count || at < first) {
    const time = told.time[layerSlider.high];
    output.replaceChildren(
      element("b", `Layer ${layerSlider.high + 1} of ${layerCount}`),
      ` · ${count} moves · ${duration(time)}`);
  } else {
    const role = moves.roles[at];
    const parts = [role < TRAVEL ? told.role_names[role] : "travel"];
    if (role < TRAVEL) {
      parts.push(
        `${moves.width(at).toFixed(2)} × ${moves.height(at).toFixed(2)} mm`,
        `${moves.flow(at).toFixed(1)} mm³/s`);
    }
    parts.push(
      `${moves.speed(at).toFixed(0)} mm/s`,
      `${moves.length(at).toFixed(1)} mm`,
      `line ${moves.lines[at]}`);
    output.replaceChildren(
      element("b", `Move ${end - first} of ${count}`),
      ` · ${parts.join(" · ")}`);
  }
  redraw();
}

function toLayer(to) {
  const layer = Math.max(0, Math.min(layerCount - 1, to));
  const low = state.only ? layer : Math.min(layerSlider.low, layer);
  layerSlider.set(0, layerCount - 1, low, layer);
  layersChanged();
}

function onlyThis() {
  const { low, high } = layerSlider;
  state.only = !state.only;
  if (state.only) {
    state.lowBefore = low;
  }
  layerSlider.set(0, layerCount - 1,
    state.only ? high : Math.min(state.lowBefore, high), high);
  layersChanged();
}

function toMove(to) {
  moveSlider.move("high", to);
}

function play() {
  state.playing = !state.playing;
  if (state.playing && moveSlider.high === moveSlider.max) {
    toMove(moveSlider.min);
  }
  // A layer plays within some seconds, however many moves it has.
  const start = performance.now();
  const from = moveSlider.high;
  const perSecond = Math.max(8, (moveSlider.max - moveSlider.min) / 8);
  const step = now => {
    if (!state.playing) {
      return;
    }
    const to = Math.round(from + (now - start) / 1000 * perSecond);
    toMove(to);
    if (to >= moveSlider.max) {
      state.playing = false;
    } else {
      requestAnimationFrame(step);
    }
  };
  requestAnimationFrame(step);
}

// --- figures

function listFigures() {
  const list = $("figures");
  list.replaceChildren();
  const add = (name, text, title = "") => list.append(
    element("dt", name), element("dd", text, { title }));
  const time = figures.said_time ?? figures.time;
  add("Time", duration(time), figures.said_time === null
    ? "Estimated from the moves, without heating"
    : `As the file says; estimated from the moves: ${duration(figures.time)}`);
  const mass = figures.mass === null ? "" : ` · ${figures.mass.toFixed(1)} g`;
  add("Filament", `${(figures.filament / 1000).toFixed(2)} m${mass}`);
  if (figures.cost !== null) {
    add("Cost", figures.cost.toFixed(2));
  }
  if (figures.part) {
    const [min, max] = figures.part;
    const size = min.map((low, i) => (max[i] - low).toFixed(1));
    add("Size", `${size.join(" × ")} mm`);
  }
  add("Layers", String(layerCount));
  add("Retractions", String(figures.retractions));
  const heat = [
    figures.nozzle === null ? "" : `${figures.nozzle.toFixed(0)} °C`,
    figures.bed === null ? "" : `bed ${figures.bed.toFixed(0)} °C`,
  ].filter(Boolean);
  if (heat.length > 0) {
    add("Heat", heat.join(", "));
  }
  $("summary").textContent = [
    figures.generator, `${layerCount} layers`, duration(time),
  ].filter(Boolean).join(" · ");
}

// --- light and dark

function remembered() {
  try {
    return localStorage.getItem("isoslice-theme");
  } catch {
    return null;
  }
}

const prefersDark = matchMedia("(prefers-color-scheme: dark)");

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  readColours();
  redraw(false);
}

function otherTheme() {
  const dark = document.documentElement.dataset.theme === "dark";
  const theme = dark ? "light" : "dark";
  setTheme(theme);
  try {
    localStorage.setItem("isoslice-theme", theme);
  } catch {
    // Some browsers have no storage for pages that are files.
  }
}

// --- the rest of the page

function fit(look) {
  const canvas = $("view");
  const width = canvas.clientWidth - 2 * camera.aside;
  const height = canvas.clientHeight;
  const free = camera.above > 0 ? height - 2 * camera.above - HEAD : height;
  camera.fit(Math.min(width, free) / height, look);
  redraw(false);
}

// The part stands in the middle of what the panel leaves free: beside it, or
// above it on a phone.
function placeView() {
  const { clientWidth: width, clientHeight: height } = $("view");
  const { top, right } = $("panel").getBoundingClientRect();
  const shown = !$("panel").hidden;
  camera.aside = shown && width > 800 ? right / 2 : 0;
  const below = shown && width <= NARROW;
  camera.above = below ? Math.max(0, height - top - HEAD) / 2 : 0;
  redraw(false);
}

function showPanel(open) {
  $("panel").hidden = !open;
  $("show-panel").setAttribute("aria-expanded", open);
  placeView();
}

function help() {
  const million = (scene.triangles / 1e6).toFixed(2);
  $("drawn").textContent =
    `${moves.count} moves, ${figures.lines} lines; last drawn: ${million} `
    + `million triangles${lastDrawn ? `, ${lastDrawn.toFixed(0)} ms` : ""}`
    + `, detail ${scene.level}.`;
  $("help").showModal();
}

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || $("help").open) {
    return;
  }
  const field = "input, select, textarea";
  if (event.target.matches?.(field)) {
    return;
  }
  const onButton = event.target instanceof HTMLButtonElement;
  const end = event.target.dataset?.end;
  const layers = event.shiftKey ? 10 : 1;
  const step = event.shiftKey ? 50 : 1;
  const up = by => {
    if (end === "low") {
      layerSlider.move("low", layerSlider.low + by);
    } else {
      toLayer(layerSlider.high + by);
    }
  };
  const keys = {
    ArrowUp: () => up(layers),
    ArrowDown: () => up(-layers),
    PageUp: () => up(10),
    PageDown: () => up(-10),
    ArrowRight: () => toMove(moveSlider.high + step),
    ArrowLeft: () => toMove(moveSlider.high - step),
    Home: () => toLayer(0),
    End: () => toLayer(layerCount - 1),
    " ": play,
    o: onlyThis,
    t: () => toggleRole(TRAVEL),
    s: () => toggleMark("seams"),
    r: () => toggleMark("retractions"),
    x: nextCut,
    Enter: pickLast,
    Escape: () => pick(-1),
    f: () => fit(),
    v: () => fit((camera.look + 1) % LOOKS.length),
    d: otherTheme,
    p: () => showPanel($("panel").hidden),
    "?": help,
    h: help,
  };
  Object.keys(MODES).forEach((mode, i) => {
    keys[i + 1] = () => setMode(mode);
  });
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  // Space and Enter press the button that has the focus.
  if (!keys[key] || (onButton && (key === " " || key === "Enter"))) {
    return;
  }
  if (!told && !"dfvp".includes(key)) {
    return;
  }
  event.preventDefault();
  if (key !== " ") {
    state.playing = false;
  }
  keys[key]();
}

// Makes the page ready for a print in this box.
function begin(box) {
  const canvas = $("view");
  camera = new Camera(box);
  layerSlider = new Slider($("layer-slider"), {
    vertical: true, two: true, say: sayLayer,
    names: ["Lowest layer shown", "Highest layer shown"],
    change: end =>
      state.only ? toLayer(layerSlider[end]) : layersChanged(),
  });
  moveSlider = new Slider($("move-slider"), {
    names: ["Last move shown"],
    say: move => `move ${move - told.first[layerSlider.high]}`,
    change: movesChanged,
  });
  setTheme(remembered() ?? (prefersDark.matches ? "dark" : "light"));
  prefersDark.addEventListener("change", () => {
    if (!remembered()) {
      setTheme(prefersDark.matches ? "dark" : "light");
    }
  });
  showPanel(innerWidth > NARROW);
  fit(0);

  lead(camera, canvas, redraw, (x, y) => {
    clearTimeout(pickTimer);
    const can = () => told && !live?.showsPart;
    pickTimer = setTimeout(() => can() && pickAt(x, y), ONE_CLICK);
  });
  canvas.addEventListener("dblclick", () => {
    clearTimeout(pickTimer);
    fit();
  });
  beginCut();
  $("go-to-picked").addEventListener("click", goToPicked);
  $("close-picked").addEventListener("click", () => {
    pick(-1);
    $("view").focus();
  });
  for (const button of $("amounts").children) {
    button.addEventListener("click", () => setAmount(button.dataset.amount));
  }
  addEventListener("resize", placeView);
  addEventListener("keydown", onKey);
  for (const button of $("modes").children) {
    button.addEventListener("click", () => setMode(button.dataset.mode));
  }
  $("only").addEventListener("click", () => told && onlyThis());
  $("fit").addEventListener("click", () => fit());
  $("look").addEventListener(
    "click", () => fit((camera.look + 1) % LOOKS.length));
  $("theme").addEventListener("click", otherTheme);
  $("help-button").addEventListener("click", () => told && help());
  $("show-panel").addEventListener("click", () => showPanel($("panel").hidden));
  canvas.addEventListener("webglcontextlost", event => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    scene?.build();
    redraw(false);
  });
}

// The layer nearest to a height, or the top one.
function layerAt(z) {
  const above = told.z.findIndex(at => at >= z - 1e-6);
  return above < 0 ? layerCount - 1 : above;
}

// Shows a print. If there is one already, the new one takes its place: the
// camera, the colours and the heights that are shown stay. The tables stay as
// well if there is just a glimpse of it.
async function show(data, packed, glimpse = false) {
  const unpacked = await unpack(data, packed);
  const before = kept ?? (told && {
    low: layerSlider.low > 0 ? told.z[layerSlider.low] : -Infinity,
    high: layerSlider.high < layerCount - 1
      ? told.z[layerSlider.high] : Infinity,
  });
  [told, figures, moves] = [data, data.statistics, unpacked];
  layerCount = told.first.length;
  marks = new Marks();
  const box = figures.printed;
  if (!camera) {
    begin(box);
  } else {
    camera.hold(box);
  }
  state.playing = false;
  state.picked = -1;
  state.pointed = null;
  $("picked").hidden = true;
  const last = scene;
  last?.release();
  scene = new Scene($("view"), told, moves, box);
  if (last) {
    [scene.level, scene.restLevel] = [last.level, last.restLevel];
  }
  if (!scene.gl) {
    throw new Error("This browser has no WebGL 2, which the preview needs.");
  }
  if (!glimpse) {
    listRoles();
    listMarks();
    listFigures();
  }
  if (!live) {
    listWarnings(figures.warnings);
  }
  const [low, high] = before
    ? [layerAt(before.low), layerAt(before.high)] : [0, layerCount - 1];
  layerSlider.set(0, layerCount - 1, Math.min(low, high), high);
  layersChanged();
  // The heights in a glimpse are not those of the layers to come.
  kept = glimpse ? before : null;
  setMode(state.mode);
  if (!ready) {
    await scene.calibrate(camera, shown());
  }
  ready = true;
  redraw(false);
  $("notice").hidden = true;
  document.documentElement.dataset.ready = "true";
  document.documentElement.dataset.glimpse = glimpse;
}

async function start() {
  if (live) {
    await live.begin();
    return;
  }
  const element = $("moves");
  const packed = fromBase64(element.textContent);
  element.remove();
  await show(JSON.parse($("told").textContent), packed);
}

start().catch(error => {
  $("notice").hidden = false;
  $("notice").textContent = error.message;
  throw error;
});
