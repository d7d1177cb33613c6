// A slider with one handle or two, lying or standing.
//
// `low` and `high` are whole numbers from `min` to `max`; with one handle,
// `low` stays at `min`.

class Slider {
  constructor(element, { vertical = false, two = false, names, say, change }) {
    Object.assign(this, { element, vertical, two, say, change });
    this.min = this.low = 0;
    this.max = this.high = 0;
    const part = name => {
      const div = document.createElement("div");
      div.className = name;
      element.append(div);
      return div;
    };
    part("track");
    this.fill = part("fill");
    const handle = (end, name) => {
      const div = part("handle");
      div.tabIndex = 0;
      div.setAttribute("role", "slider");
      div.setAttribute("aria-label", name);
      div.setAttribute(
        "aria-orientation", vertical ? "vertical" : "horizontal");
      div.dataset.end = end;
      return div;
    };
    this.handles = two
      ? { low: handle("low", names[0]), high: handle("high", names[1]) }
      : { high: handle("high", names[0]) };

    let held = null;
    element.addEventListener("pointerdown", event => {
      element.setPointerCapture(event.pointerId);
      const value = this.at(event);
      const nearLow = this.two
        && (Math.abs(value - this.low) < Math.abs(value - this.high)
          || (this.low === this.high && value < this.low));
      held = event.target.dataset.end || (nearLow ? "low" : "high");
      // If two handles are in one place, the one that can move.
      if (this.two && this.low === this.high && this.high === this.max) {
        held = "low";
      }
      this.handles[held].focus({ preventScroll: true });
      this.move(held, value);
    });
    element.addEventListener("pointermove", event => {
      if (held && element.hasPointerCapture(event.pointerId)) {
        this.move(held, this.at(event));
      }
    });
    const release = () => { held = null; };
    element.addEventListener("pointerup", release);
    element.addEventListener("pointercancel", release);
  }

  // The value under a pointer.
  at(event) {
    const box = this.element.getBoundingClientRect();
    const share = this.vertical
      ? (box.bottom - event.clientY) / box.height
      : (event.clientX - box.left) / box.width;
    const clipped = Math.max(0, Math.min(1, share));
    return Math.round(this.min + clipped * (this.max - this.min));
  }

  // Moves an end; it pushes the other one before it.
  move(end, to) {
    const value = Math.max(this.min, Math.min(this.max, to));
    if (value === this[end]) {
      return;
    }
    this[end] = value;
    if (end === "high") {
      this.low = Math.min(this.low, value);
    } else {
      this.high = Math.max(this.high, value);
    }
    this.show();
    this.change(end);
  }

  set(min, max, low, high) {
    Object.assign(this, { min, max, low, high });
    this.show();
  }

  show() {
    const size = this.max - this.min;
    const percent = value =>
      size > 0 ? 100 * (value - this.min) / size : (value === this.low && this.two ? 0 : 100);
    const [low, high] = [percent(this.low), percent(this.high)];
    const [start, extent] =
      this.vertical ? ["bottom", "height"] : ["left", "width"];
    const from = this.two ? low : 0;
    this.fill.style[start] = `${from}%`;
    this.fill.style[extent] = `${high - from}%`;
    for (const [end, handle] of Object.entries(this.handles)) {
      handle.style[start] = `${end === "low" ? low : high}%`;
      handle.setAttribute("aria-valuemin", this.min);
      handle.setAttribute("aria-valuemax", this.max);
      handle.setAttribute("aria-valuenow", this[end]);
      handle.setAttribute("aria-valuetext", this.say(this[end]));
    }
  }
}
