// Draws the moves.
//
// Each move is an instance of a bead: a roof of two strips that turns to the
// eye, from one silhouette of the bead's round section over its nearest line
// to the other, with a tip at either end. Its normals are those of the
// section, so that it looks round. The points are in one buffer, read twice,
// a point apart; a range of moves is drawn from where it begins in it.

const TRAVEL = 16;
const JUMP = 17;

const BEAD_VERTEX = `#version 300 es
precision highp float;
precision highp int;
uniform mat4 to_clip;
uniform vec3 eye;
uniform vec3 origin;
uniform float unit;
uniform float length_unit;
uniform float pixel;
uniform float stretch;
uniform uint hidden;
uniform float pallor;
uniform bool by_value;
uniform vec3 colours[17];
uniform vec3 ramp[8];
uniform vec3 pale;
in vec4 from;
in vec4 to;
in float height;
in vec2 what;
out vec3 normal;
out vec3 colour;
void main() {
  uint role = uint(what.x);
  if ((hidden >> role & 1u) != 0u) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  bool travel = role == ${TRAVEL}u;
  vec3 a = origin + unit * from.xyz;
  vec3 b = origin + unit * to.xyz;
  bool first = gl_VertexID < 3 || gl_VertexID == 6;
  vec3 end = first ? a : b;
  float size = distance(a, b);
  vec3 along = size > 1e-6 ? (b - a) / size : vec3(1.0, 0.0, 0.0);
  vec3 right = cross(along, vec3(0.0, 0.0, 1.0));
  float flatness = length(right);
  right = flatness > 1e-3 ? right / flatness : vec3(1.0, 0.0, 0.0);
  vec3 up = cross(right, along);

  vec2 radius = 0.5 * vec2(to.w, height * stretch) * length_unit;
  if (travel) {
    radius = vec2(0.7 * pixel * distance(eye, end));
  } else {
    end.z -= radius.y;
  }

  // Directions in the section: to the eye, and to the silhouettes.
  vec3 back = eye - end;
  vec2 seen = vec2(dot(back, right), dot(back, up));
  seen = dot(seen, seen) > 1e-9 ? normalize(seen) : vec2(0.0, 1.0);
  int corner = gl_VertexID % 3;
  vec3 facing = seen.x * right + seen.y * up;
  if (gl_VertexID >= 6) {
    vec3 outward = first ? -along : along;
    normal = normalize(outward + 0.3 * facing);
    end += outward * radius.x * 0.9;
  } else {
    vec2 n = corner == 1 ? seen : vec2(-seen.y, seen.x) * float(1 - corner);
    vec2 scaled = radius * n;
    vec2 place = radius * scaled / max(length(scaled), 1e-9);
    normal = n.x * right + n.y * up;
    end += place.x * right + place.y * up;
  }

  colour = colours[role];
  if (by_value && !travel) {
    float at = what.y / 255.0 * 7.0;
    int step = min(int(at), 6);
    colour = mix(ramp[step], ramp[step + 1], at - float(step));
  }
  colour = mix(colour, pale, pallor);
  gl_Position = to_clip * vec4(end, 1.0);
}`;

const SHADED = `#version 300 es
precision highp float;
uniform vec3 light;
uniform vec3 side;
in vec3 normal;
in vec3 colour;
out vec4 shown;
void main() {
  vec3 n = normalize(normal);
  float key = max(dot(n, light), 0.0);
  float fill = max(dot(n, side), 0.0);
  float sky = 0.5 + 0.5 * n.z;
  shown = vec4(colour * (0.40 + 0.14 * sky + 0.46 * key + 0.10 * fill), 1.0);
}`;

const LINE_VERTEX = `#version 300 es
uniform mat4 to_clip;
in vec3 position;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
}`;

const LINE_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec3 line_colour;
out vec4 shown;
void main() {
  shown = vec4(line_colour, 1.0);
}`;

const MARKER_VERTEX = `#version 300 es
uniform mat4 to_clip;
uniform vec3 tip;
uniform float size;
uniform vec3 marker_colour;
in vec3 position;
in vec3 point_normal;
out vec3 normal;
out vec3 colour;
void main() {
  normal = point_normal.xzy * vec3(1.0, 1.0, -1.0);
  colour = marker_colour;
  vec3 p = position.xzy * vec3(0.34, 0.34, -1.0) + vec3(0.0, 0.0, 0.5);
  gl_Position = to_clip * vec4(tip + size * p, 1.0);
}`;

// Two triangles for each of two strips, and two for each of two tips.
const BEAD_TRIANGLES = [
  0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4,
  0, 1, 6, 1, 2, 6, 3, 4, 7, 4, 5, 7,
];
const STRIPS = 12;

// How fast the picture is to change while it is turned, milliseconds.
const SMOOTH = 33;
// How long a picture may take once it is at rest, milliseconds.
const PATIENCE = 700;
// What is drawn at each level: of all moves or of the coarser ones, with tips
// or without, so many layers as one.
const LEVELS = [
  { coarse: false, elements: BEAD_TRIANGLES.length, stride: 1 },
  { coarse: false, elements: STRIPS, stride: 1 },
  { coarse: true, elements: STRIPS, stride: 1 },
  { coarse: true, elements: STRIPS, stride: 2 },
  { coarse: true, elements: STRIPS, stride: 4 },
  { coarse: true, elements: STRIPS, stride: 8 },
];
// The last one for a picture at rest: it still has every layer.
const LAST_AT_REST = 2;

class Scene {
  constructor(canvas, told, moves, box) {
    this.canvas = canvas;
    this.told = told;
    this.moves = moves;
    this.box = box;
    this.whole = { ...moves, first: told.first, of: null };
    this.coarse = coarsen(moves, told);
    for (const set of [this.whole, this.coarse]) {
      set.detail = new ArrayBuffer(4 * set.count);
      const short = new Uint16Array(set.detail);
      const bytes = new Uint8Array(set.detail);
      for (let i = 0; i < set.count; i++) {
        const move = set.of ? set.of[i] : i;
        short[2 * i] = moves.heights[move];
        bytes[4 * i + 2] = moves.roles[move];
      }
    }
    this.byValue = false;
    // Of LEVELS: while the view changes, and at rest.
    this.level = 0;
    this.restLevel = 0;
    this.triangles = 0;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (this.gl) {
      this.build();
    }
  }

  // Everything that is in the graphics card.
  build() {
    const gl = this.gl;
    const program = (vertex, fragment) =>
      twgl.createProgramInfo(gl, [vertex, fragment]);
    this.bead = program(BEAD_VERTEX, SHADED);
    this.line = program(LINE_VERTEX, LINE_FRAGMENT);
    this.solid = program(MARKER_VERTEX, SHADED);
    const buffer = data => twgl.createBufferFromTypedArray(gl, data);
    const attribute = (buffer, numComponents, type, stride) => ({
      buffer, numComponents, type, stride,
      normalize: false, offset: 0, divisor: 1,
    });
    const indices = twgl.createBufferFromTypedArray(
      gl, new Uint8Array(BEAD_TRIANGLES), gl.ELEMENT_ARRAY_BUFFER);
    for (const set of [this.whole, this.coarse]) {
      const points = buffer(set.points);
      const detail = buffer(new Uint8Array(set.detail));
      set.detailBuffer = detail;
      set.beads = {
        elementType: gl.UNSIGNED_BYTE,
        indices,
        attribs: {
          from: attribute(points, 4, gl.UNSIGNED_SHORT, 8),
          to: attribute(points, 4, gl.UNSIGNED_SHORT, 8),
          height: attribute(detail, 1, gl.UNSIGNED_SHORT, 4),
          what: attribute(detail, 2, gl.UNSIGNED_BYTE, 4),
        },
      };
    }
    this.grid = twgl.createBufferInfoFromArrays(gl, {
      position: { numComponents: 3, data: gridLines(this.box) },
    });
    const cone = twgl.primitives.createTruncatedConeVertices(1, 0, 1, 24, 1);
    this.cone = twgl.createBufferInfoFromArrays(gl, {
      position: { numComponents: 3, data: cone.position },
      point_normal: { numComponents: 3, data: cone.normal },
      indices: { numComponents: 3, data: cone.indices },
    });
    gl.enable(gl.DEPTH_TEST);
  }

  // Gives back what is in the graphics card.
  release() {
    const gl = this.gl;
    const shared = [this.grid, this.cone];
    const own = [this.whole.beads, this.coarse.beads];
    for (const { attribs, indices } of [...shared, ...own]) {
      for (const { buffer } of Object.values(attribs)) {
        gl.deleteBuffer(buffer);
      }
      gl.deleteBuffer(indices ?? null);
    }
    for (const { program } of [this.bead, this.line, this.solid]) {
      gl.deleteProgram(program);
    }
  }

  // Colours by a number for each move, from `low` to `high`, or by role.
  colourBy(number, low, high) {
    this.byValue = number !== null;
    if (!number) {
      return;
    }
    const scale = high > low ? 255 / (high - low) : 0;
    const gl = this.gl;
    for (const set of [this.whole, this.coarse]) {
      const bytes = new Uint8Array(set.detail);
      for (let i = 0; i < set.count; i++) {
        const at = (number(set.of ? set.of[i] : i) - low) * scale;
        bytes[4 * i + 3] = at < 0 ? 0 : at > 255 ? 255 : Math.round(at);
      }
      gl.bindBuffer(gl.ARRAY_BUFFER, set.detailBuffer);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, bytes);
    }
  }

  // Finds out how much the graphics card can do, before it is asked for more.
  async calibrate(camera, show) {
    if (this.whole.count < 20000) {
      return;
    }
    const gl = this.gl;
    const measured = async times => {
      const start = performance.now();
      for (let i = 0; i < times; i++) {
        this.draw(camera, show, true);
      }
      const done = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      while (gl.clientWaitSync(done, 0, 0) === gl.TIMEOUT_EXPIRED
        && performance.now() - start < 3000) {
        await new Promise(resolve => setTimeout(resolve, 1));
      }
      gl.deleteSync(done);
      return (performance.now() - start) / (times * this.triangles);
    };
    // The first picture also compiles. Few triangles tell little of a fast
    // card, many would keep a slow one busy.
    this.level = LEVELS.length - 1;
    await measured(1);
    let perTriangle = await measured(1);
    if (perTriangle * this.triangles < 30) {
      this.level = LAST_AT_REST;
      perTriangle = await measured(4);
    }
    const within = milliseconds => {
      const level = LEVELS.findIndex(
        level => this.size(level) * perTriangle < milliseconds);
      return level < 0 ? LEVELS.length - 1 : level;
    };
    this.level = within(SMOOTH);
    this.restLevel = Math.min(LAST_AT_REST, within(PATIENCE));
  }

  // Triangles of the whole print at a level.
  size({ coarse, elements, stride }) {
    const set = coarse ? this.coarse : this.whole;
    return set.count * elements / 3 / stride;
  }

  // Remembers how long frames take while the view changes.
  pace(milliseconds) {
    const slow = milliseconds > SMOOTH;
    const fast = milliseconds < SMOOTH / 2;
    this.slowFrames = slow ? (this.slowFrames || 0) + 1 : 0;
    this.fastFrames = fast ? (this.fastFrames || 0) + 1 : 0;
    if (this.slowFrames > 2 || milliseconds > 5 * SMOOTH) {
      this.level = Math.min(LEVELS.length - 1, this.level + 1);
      this.slowFrames = 0;
    } else if (this.fastFrames > 30 && this.level > 0) {
      this.level--;
      this.fastFrames = 0;
    }
  }

  // `show`: what is shown, and how; `moving`: while the view changes.
  draw(camera, show, moving) {
    const { gl, canvas, told } = this;
    const level =
      moving ? this.level : Math.min(this.level, this.restLevel);
    const density =
      level > 0 ? 1 : Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * density));
    const height = Math.max(1, Math.round(canvas.clientHeight * density));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(...show.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);

    const [right, up, back] = camera.axes;
    const toward = (x, y, z) => twgl.v3.normalize(
      right.map((r, i) => x * r + y * up[i] + z * back[i]));
    const shared = {
      to_clip: camera.matrix(canvas.clientWidth, canvas.clientHeight),
      light: toward(-0.45, 0.65, 0.62),
      side: toward(0.8, -0.1, 0.6),
    };

    gl.useProgram(this.line.program);
    twgl.setBuffersAndAttributes(gl, this.line, this.grid);
    twgl.setUniforms(this.line, { ...shared, line_colour: show.grid });
    twgl.drawBufferInfo(gl, this.grid, gl.LINES);

    gl.useProgram(this.bead.program);
    twgl.setUniforms(this.bead, {
      ...shared,
      eye: camera.eye,
      origin: told.origin,
      unit: told.unit,
      length_unit: told.length_unit,
      pixel: 2 * Math.tan(FIELD_OF_VIEW / 2) / height,
      by_value: this.byValue,
      colours: show.colours.flat(),
      ramp: show.ramp.flat(),
      pale: show.pale,
    });
    this.uniforms = { hidden: show.hidden };
    this.triangles = 0;
    this.drawBeads(LEVELS[level], show);

    if (show.marker) {
      gl.useProgram(this.solid.program);
      twgl.setBuffersAndAttributes(gl, this.solid, this.cone);
      twgl.setUniforms(this.solid, {
        ...shared,
        tip: show.marker,
        size: 0.032 * camera.distance,
        marker_colour: show.accent,
      });
      twgl.drawBufferInfo(gl, this.cone);
    }
  }

  drawBeads({ coarse, elements, stride }, { low, high, end, partly }) {
    const { whole } = this;
    // The highest layer shows every move: it may end anywhere. While it does,
    // those below it are pale.
    const reach = Math.min(stride, high - low + 1);
    this.range(whole, whole.first[high], end, { reach, elements, pallor: 0 });
    const set = coarse ? this.coarse : whole;
    const pallor = partly ? 0.72 : 0;
    if (stride === 1) {
      this.range(set, set.first[low], set.first[high],
        { reach: 1, elements, pallor });
      return;
    }
    for (let layer = high - stride; layer >= low; layer -= stride) {
      const reach = Math.min(stride, layer - low + 1);
      this.range(set, set.first[layer], set.first[layer + 1],
        { reach, elements, pallor });
    }
  }

  // The moves of a set from `begin` to before `end`.
  range(set, begin, end, { reach, elements, pallor }) {
    if (end <= begin) {
      return;
    }
    const gl = this.gl;
    const { from, to, height, what } = set.beads.attribs;
    from.offset = 8 * begin;
    to.offset = 8 * begin + 8;
    height.offset = 4 * begin;
    what.offset = 4 * begin + 2;
    twgl.setBuffersAndAttributes(gl, this.bead, set.beads);
    twgl.setUniforms(this.bead, { ...this.uniforms, stretch: reach, pallor });
    gl.drawElementsInstanced(
      gl.TRIANGLES, elements, gl.UNSIGNED_BYTE, 0, end - begin);
    this.triangles += (end - begin) * elements / 3;
  }
}

// A grid of centimetres on the bed, a little larger than the box.
function gridLines([min, max]) {
  const start = [0, 1].map(i => Math.floor(min[i] / 10 - 1) * 10);
  const end = [0, 1].map(i => Math.ceil(max[i] / 10 + 1) * 10);
  const lines = [];
  for (let x = start[0]; x <= end[0]; x += 10) {
    lines.push(x, start[1], 0, x, end[1], 0);
  }
  for (let y = start[1]; y <= end[1]; y += 10) {
    lines.push(start[0], y, 0, end[0], y, 0);
  }
  return lines;
}
