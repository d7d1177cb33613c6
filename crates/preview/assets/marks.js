// Marks in the print: seams and retractions.
//
// A seam is where a closed stroke of an outer wall begins and ends. A
// retraction is where filament is pulled back; it comes from the file.

// Roles whose strokes have seams that are seen: outer walls and those that
// overhang.
const SEAMED = ["outer wall", "overhang"];
const MARKS = {
  seams: { colour: "#1d1f24", find: seams },
  retractions: { colour: "#c02fd0", find: () => moves.retracted },
};
// Diameter of a mark, mm; and in pixels at least and at most.
const MARK_SIZE = { mm: 0.5, least: 4, most: 12 };

// The moves with which closed strokes begin. Each is the number of moves before
// the seam, so that it lies where that many moves have led.
function seams() {
  const { points, roles, count } = moves;
  const seamed = told.role_names.map(name => SEAMED.includes(name));
  const found = [];
  let begin = -1;
  const closes = end => {
    // The stroke ends where it began, but for a gap of less than its width.
    const [a, b] = [4 * begin, 4 * end];
    const gap = told.unit
      * Math.hypot(points[a] - points[b], points[a + 1] - points[b + 1]);
    return end - begin > 2 && gap < 1.5 * moves.width(begin);
  };
  for (let i = 0; i <= count; i++) {
    const prints = i < count && roles[i] < TRAVEL && seamed[roles[i]];
    if (prints && begin < 0) {
      begin = i;
    } else if (!prints && begin >= 0) {
      if (closes(i)) {
        found.push(begin);
      }
      begin = -1;
    }
  }
  return Uint32Array.from(found);
}

// The marks of each kind, found once for a print.
class Marks {
  constructor() {
    this.found = {};
  }

  of(kind) {
    return this.found[kind] ??= MARKS[kind].find();
  }

  // Where the marks are, mm, for the graphics card.
  places(kind) {
    const all = this.of(kind);
    const places = new Float32Array(3 * all.length);
    all.forEach((before, i) => places.set(moves.place(before - 1), 3 * i));
    return places;
  }
}

// How many numbers of a rising list are less than `limit`.
function countBelow(list, limit) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < limit) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

function toggleMark(kind) {
  state.marks[kind] = !state.marks[kind];
  listMarks();
  redraw(false);
}

function listMarks() {
  const body = $("roles").tBodies[1];
  body.replaceChildren();
  for (const kind of Object.keys(MARKS)) {
    const row = body.insertRow();
    const button = element("button", "", { className: "role" });
    button.append(
      element("span", "", { className: "swatch" }), element("span", kind));
    button.title = `Mark ${kind} (${kind[0].toUpperCase()})`;
    button.addEventListener("click", () => {
      toggleMark(kind);
      $("roles").querySelector(`[data-mark="${kind}"] button`).focus();
    });
    button.setAttribute("aria-pressed", state.marks[kind]);
    row.dataset.mark = kind;
    row.insertCell().append(button);
    // Seams are looked for when they are shown.
    row.insertCell().textContent = kind === "retractions"
      ? String(figures.retractions)
      : state.marks[kind] ? String(marks.of(kind).length) : "";
    row.insertCell();
    row.classList.add("mark");
    row.classList.toggle("off", !state.marks[kind]);
    row.style.setProperty("--colour", MARKS[kind].colour);
  }
}
