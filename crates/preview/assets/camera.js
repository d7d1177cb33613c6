// A camera that turns round a place, and the gestures that lead it.

const FIELD_OF_VIEW = Math.PI / 6;
// Looks from the front left corner, from above, the front and the side.
const LOOKS = [[-1.05, 0.62], [-Math.PI / 2, 1.5695], [-Math.PI / 2, 0], [0, 0]];

function halfDiagonal([min, max]) {
  return Math.hypot(...min.map((low, i) => max[i] - low)) / 2;
}

class Camera {
  constructor(box) {
    this.box = box;
    this.look = 0;
    // Pixels that the middle of the view lies right of the window's.
    this.aside = 0;
    // And how many it lies above it.
    this.above = 0;
    this.fit(1);
  }

  // Sees another box from where the camera is.
  hold(box) {
    this.box = box;
    this.radius = halfDiagonal(box);
  }

  // Brings the whole box into sight, from where the camera is, or from a look.
  fit(aspect, look = this.look) {
    this.look = look;
    [this.yaw, this.pitch] = LOOKS[look];
    const [min, max] = this.box;
    this.target = min.map((low, i) => (low + max[i]) / 2);
    this.radius = halfDiagonal(this.box);
    const narrow = Math.min(1, Math.max(0.2, aspect));
    const half = Math.atan(Math.tan(FIELD_OF_VIEW / 2) * narrow);
    this.distance = 1.02 * this.radius / Math.sin(half);
  }

  get eye() {
    const flat = Math.cos(this.pitch) * this.distance;
    return [
      this.target[0] + flat * Math.cos(this.yaw),
      this.target[1] + flat * Math.sin(this.yaw),
      this.target[2] + Math.sin(this.pitch) * this.distance,
    ];
  }

  // The camera's axes in the world: right, up, back.
  get axes() {
    const camera = twgl.m4.lookAt(this.eye, this.target, [0, 0, 1]);
    return [0, 4, 8].map(i => [camera[i], camera[i + 1], camera[i + 2]]);
  }

  // The matrix of a window of this size in pixels, in which everything within
  // `reach` of the box is seen.
  matrix(width, height, reach) {
    const room = 1.5 * this.radius + reach;
    const near = Math.max(this.distance - room, this.distance / 100, 0.1);
    const far = this.distance + 3 * this.radius + 2 * reach + 500;
    const projection =
      twgl.m4.perspective(
        FIELD_OF_VIEW, width / height, near, far);
    const camera = twgl.m4.lookAt(this.eye, this.target, [0, 0, 1]);
    const moved = twgl.m4.translation(
      [2 * this.aside / width, 2 * this.above / height, 0]);
    return twgl.m4.multiply(
      twgl.m4.multiply(moved, projection), twgl.m4.inverse(camera));
  }

  // The ray from the eye through a place of the window: where it begins, and a
  // direction of length 1.
  ray(x, y, width, height) {
    const scale = 2 * Math.tan(FIELD_OF_VIEW / 2) / height;
    const [right, up, back] = this.axes;
    const across = (x - width / 2 - this.aside) * scale;
    const above = (height / 2 - y - this.above) * scale;
    return {
      from: this.eye,
      along: twgl.v3.normalize(
        back.map((b, i) => across * right[i] + above * up[i] - b)),
    };
  }

  turn(dx, dy) {
    this.yaw -= dx * 0.006;
    const steepest = Math.PI / 2 - 0.001;
    this.pitch =
      Math.max(-steepest, Math.min(steepest, this.pitch + dy * 0.006));
  }

  // Moves the camera by pixels of a window that is `height` pixels high.
  shift(dx, dy, height) {
    const scale =
      2 * this.distance * Math.tan(FIELD_OF_VIEW / 2) / height;
    const [right, up] = this.axes;
    for (let i = 0; i < 3; i++) {
      this.target[i] += scale * (dy * up[i] - dx * right[i]);
    }
  }

  // Moves the camera nearer by a factor. The place (x, y), in pixels from the
  // middle, stays where it is.
  zoom(factor, x, y, height) {
    const before = this.distance;
    this.distance = Math.max(
      1, Math.min(20 * this.radius, this.distance / factor));
    const kept = this.distance / before;
    this.shift(-x * (1 / kept - 1), -y * (1 / kept - 1), height);
  }
}

// Pixels that a pointer may move while it is pressed for a click.
const STILL = 4;

// Leads `camera` by mouse, pen and fingers on `canvas`; `clicked` is told of
// places that are pressed and let go.
function lead(camera, canvas, changed, clicked) {
  const held = new Map();
  let before = null;
  // Where the only pointer was pressed, until it moves.
  let pressed = null;

  const fromMiddle = (x, y) =>
    [x - canvas.clientWidth / 2 - camera.aside,
      y - canvas.clientHeight / 2 + camera.above];
  const summary = () => {
    const all = [...held.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    const spread = all.length > 1
      ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0;
    return { x, y, spread };
  };

  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add("held");
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    before = summary();
    const alone = held.size === 1 && event.button === 0 && !event.shiftKey;
    pressed = alone ? { x: event.clientX, y: event.clientY } : null;
  });
  canvas.addEventListener("pointermove", event => {
    if (!held.has(event.pointerId)) {
      return;
    }
    if (pressed) {
      const moved =
        Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y);
      if (moved <= STILL) {
        return;
      }
      pressed = null;
    }
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const now = summary();
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    const height = canvas.clientHeight;
    if (held.size > 1) {
      camera.shift(dx, dy, height);
      if (before.spread > 0 && now.spread > 0) {
        const [x, y] = fromMiddle(now.x, now.y);
        camera.zoom(now.spread / before.spread, x, y, height);
      }
    } else if (event.shiftKey || event.buttons & 6) {
      camera.shift(dx, dy, height);
    } else {
      camera.turn(dx, dy);
    }
    before = now;
    changed();
  });
  const release = event => {
    held.delete(event.pointerId);
    canvas.classList.toggle("held", held.size > 0);
    if (held.size > 0) {
      before = summary();
    }
  };
  canvas.addEventListener("pointerup", event => {
    release(event);
    if (pressed) {
      clicked(event.clientX, event.clientY);
    }
    pressed = null;
  });
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    const [x, y] = fromMiddle(event.clientX, event.clientY);
    const by = Math.max(-200, Math.min(200, event.deltaY * lines));
    camera.zoom(Math.exp(-by * 0.002), x, y, canvas.clientHeight);
    changed();
  }, { passive: false });
}
