// A plane that cuts the print open, so that one sees into it.
//
// What lies on the plane's far side along its normal is left out.

const CUT_NORMALS = { x: [1, 0, 0], y: [0, -1, 0], view: null };

class Cut {
  constructor() {
    this.kind = "off";
    // Where the plane is, from one end of the print's box (0) to the other (1).
    this.share = 0.5;
    this.flipped = false;
    this.normal = [0, 0, 0];
  }

  get isOn() {
    return this.kind !== "off";
  }

  set(kind) {
    this.kind = kind;
    if (this.isOn) {
      const [, , back] = camera.axes;
      this.normal = CUT_NORMALS[kind] ?? back;
    }
  }

  // Normal and distance from the origin, for the print in this box. Without a
  // cut, everything is on the near side.
  plane([min, max]) {
    if (!this.isOn) {
      return [0, 0, 0, 1];
    }
    const sign = this.flipped ? -1 : 1;
    const normal = this.normal.map(n => sign * n);
    // How far the box reaches along the normal, either way.
    const ends = normal.map((n, i) => [n * min[i], n * max[i]]);
    const low = ends.reduce((sum, e) => sum + Math.min(...e), 0);
    const high = ends.reduce((sum, e) => sum + Math.max(...e), 0);
    const share = this.flipped ? 1 - this.share : this.share;
    return [...normal, low + share * (high - low)];
  }

  // From where to where a ray is on the near side, in multiples of its
  // direction.
  stretch({ from, along }) {
    const [x, y, z, d] = this.plane(figures.printed);
    const speed = x * along[0] + y * along[1] + z * along[2];
    const at = x * from[0] + y * from[1] + z * from[2] - d;
    if (Math.abs(speed) < 1e-9) {
      return at <= 0 ? { from: 0, to: Infinity } : { from: 1, to: 0 };
    }
    const meets = -at / speed;
    return speed < 0
      ? { from: Math.max(0, meets), to: Infinity } : { from: 0, to: meets };
  }
}

function setCut(kind) {
  cut.set(kind);
  for (const button of $("cuts").children) {
    button.setAttribute("aria-pressed", button.dataset.cut === kind);
  }
  $("cut-place").hidden = !cut.isOn;
  redraw(false);
}

function beginCut() {
  for (const button of $("cuts").children) {
    button.addEventListener("click", () => setCut(button.dataset.cut));
  }
  $("cut-at").addEventListener("input", () => {
    cut.share = Number($("cut-at").value) / 1000;
    redraw();
  });
  $("cut-flip").addEventListener("click", () => {
    cut.flipped = !cut.flipped;
    $("cut-flip").setAttribute("aria-pressed", cut.flipped);
    redraw(false);
  });
}

// The next kind of cut, for a key.
function nextCut() {
  const kinds = [...$("cuts").children].map(button => button.dataset.cut);
  setCut(kinds[(kinds.indexOf(cut.kind) + 1) % kinds.length]);
}
