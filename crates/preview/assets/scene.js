// Draws the moves.
//
// Each move is a bead: a roof of two strips that turns to the eye, from one
// silhouette of the bead's round section over its nearest line to the other, with
// a tip at either end. Its normals are those of the section, so that it looks
// round. Coarser still, a move is its nearest line alone.
//
// The points are in a texture, from which every corner takes what it needs: a
// corner's number tells its move. Instances would say the same, but cost
// twice as much where there is no graphics card.

const TRAVEL = 16;
const JUMP = 17;

// Texels in a row of the textures.
const ROW = 2048;

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
uniform vec4 plane;
uniform float swell;
uniform highp usampler2D points;
uniform highp usampler2D details;
uniform int begin;
uniform bool lines;
out vec3 normal;
out vec3 colour;
uvec4 of(highp usampler2D list, int i) {
  return texelFetch(list, ivec2(i % ${ROW}, i / ${ROW}), 0);
}
void main() {
  int move = begin + (lines ? gl_VertexID >> 1 : gl_VertexID >> 3);
  // A line has the middles of both ends.
  int vertex = lines ? 1 + 3 * (gl_VertexID & 1) : gl_VertexID & 7;
  uvec4 detail = of(details, move);
  vec4 from = vec4(of(points, move));
  vec4 to = vec4(of(points, move + 1));
  float height = float(detail.x | detail.y << 8);
  uint role = detail.z;
  if ((hidden >> role & 1u) != 0u) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  bool travel = role == ${TRAVEL}u;
  vec3 a = origin + unit * from.xyz;
  vec3 b = origin + unit * to.xyz;
  bool first = vertex < 3 || vertex == 6;
  // A bead ends where the plane cuts it.
  vec2 beyond = vec2(dot(plane.xyz, a), dot(plane.xyz, b)) - plane.w;
  if (min(beyond.x, beyond.y) > 0.0) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  bool cut = (first ? beyond.x : beyond.y) > 0.0;
  if (beyond.x > 0.0) {
    a = mix(a, b, beyond.x / (beyond.x - beyond.y));
  } else if (beyond.y > 0.0) {
    b = mix(b, a, beyond.y / (beyond.y - beyond.x));
  }
  vec3 end = first ? a : b;
  float size = distance(a, b);
  vec3 along = size > 1e-6 ? (b - a) / size : vec3(1.0, 0.0, 0.0);
  vec3 right = cross(along, vec3(0.0, 0.0, 1.0));
  float flatness = length(right);
  right = flatness > 1e-3 ? right / flatness : vec3(1.0, 0.0, 0.0);
  vec3 up = cross(right, along);

  vec2 radius = 0.5 * vec2(to.w, height * stretch) * length_unit * swell;
  if (travel) {
    radius = vec2(0.7 * pixel * distance(eye, end));
  } else {
    end.z -= radius.y / swell;
  }

  // Directions in the bead's section: to the eye, and to the two silhouettes.
  vec3 back = eye - end;
  vec2 seen = vec2(dot(back, right), dot(back, up));
  seen = dot(seen, seen) > 1e-9 ? normalize(seen) : vec2(0.0, 1.0);
  int corner = vertex % 3;
  vec3 facing = seen.x * right + seen.y * up;
  vec3 outward = first ? -along : along;
  if (vertex >= 6 && !cut) {
    normal = normalize(outward + 0.3 * facing);
    end += outward * radius.x * 0.9;
  } else if (vertex >= 6) {
    // The plane has cut the bead: this corner is the one away from the eye.
    vec2 scaled = radius * seen;
    vec2 place = radius * scaled / max(length(scaled), 1e-9);
    normal = outward;
    end -= place.x * right + place.y * up;
  } else {
    vec2 n = corner == 1 ? seen : vec2(-seen.y, seen.x) * float(1 - corner);
    vec2 scaled = radius * n;
    vec2 place = radius * scaled / max(length(scaled), 1e-9);
    normal = n.x * right + n.y * up;
    end += place.x * right + place.y * up;
  }

  colour = colours[role];
  if (by_value && !travel) {
    float at = float(detail.w) / 255.0 * 7.0;
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

// Marks are round, and lie a little nearer to the eye than what they mark.
const MARK_VERTEX = `#version 300 es
uniform mat4 to_clip;
uniform vec3 eye;
uniform vec4 plane;
uniform float pixel;
uniform vec3 size;
in vec3 position;
void main() {
  vec3 back = eye - position;
  float far = length(back);
  gl_Position = to_clip * vec4(position + back / far * min(0.6, far / 2.0), 1.0);
  gl_PointSize = clamp(size.x / (pixel * far), size.y, size.z);
  if (dot(plane.xyz, position) > plane.w) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  }
}`;

const MARK_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec3 mark_colour;
out vec4 shown;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float out_of = dot(at, at);
  if (out_of > 1.0) {
    discard;
  }
  shown = vec4(out_of > 0.55 ? vec3(1.0) : mark_colour, 1.0);
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

// Moves that are drawn at once: their corners have numbers of 16 bits.
const CHUNK = 8192;

// Time that a picture may take while the view changes, milliseconds.
const SMOOTH = 33;
// Time that a picture may take while the view is at rest, milliseconds.
const PATIENCE = 1500;
// What is drawn at each level: all moves or the coarser ones, with tips, as
// strips or as lines, and so many layers as one.
const LEVELS = [
  { coarse: false, elements: BEAD_TRIANGLES.length, stride: 1 },
  { coarse: false, elements: STRIPS, stride: 1 },
  { coarse: true, elements: STRIPS, stride: 1 },
  { coarse: true, elements: STRIPS, stride: 2 },
  { coarse: true, elements: STRIPS, stride: 4 },
  { coarse: true, elements: STRIPS, stride: 8 },
  ...[1, 2, 4, 8, 16, 32].map(stride => ({ coarse: true, elements: 0, stride })),
];
// The first level of lines, and the last one before them with every layer.
const LINES = 6;
const LAST_COARSE = 2;
// The levels that a picture at rest may have: they still have every layer.
const AT_REST = [0, 1, LAST_COARSE, LINES];
// Share of the window's pixels, along a side, in which lines are drawn.
const LINES_DENSITY = 0.5;

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
    // Indices of LEVELS: while the view changes, and at rest.
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
    this.mark = program(MARK_VERTEX, MARK_FRAGMENT);
    this.marks = {};
    // Eight corners for each move of a chunk. The triangles of the strips come
    // first, then those of the tips, each for all moves.
    const strips = BEAD_TRIANGLES.slice(0, STRIPS);
    const tips = BEAD_TRIANGLES.slice(STRIPS);
    const corners = list => {
      const all = new Uint16Array(CHUNK * list.length);
      for (let i = 0; i < all.length; i++) {
        all[i] = 8 * Math.floor(i / list.length) + list[i % list.length];
      }
      return twgl.createBufferFromTypedArray(gl, all, gl.ELEMENT_ARRAY_BUFFER);
    };
    this.strips = corners(strips);
    this.beads = corners([...strips, ...tips]);
    // The buffers have the corners' numbers only.
    this.noAttributes = gl.createVertexArray();
    for (const set of [this.whole, this.coarse]) {
      set.pointsTexture = texture(gl, set.points, gl.RGBA16UI, gl.UNSIGNED_SHORT);
      set.detailTexture = texture(
        gl, new Uint8Array(set.detail), gl.RGBA8UI, gl.UNSIGNED_BYTE);
    }
    const lines = bedLines(this.told.statistics.plate, this.box);
    const places = data =>
      twgl.createBufferInfoFromArrays(gl, { position: { numComponents: 3, data } });
    this.grid = places(lines.grid);
    this.edge = lines.edge.length > 0 ? places(lines.edge) : null;
    // How far the bed reaches beyond the box, at most.
    this.reach = 60;
    for (let i = 0; i < lines.grid.length; i++) {
      const axis = i % 3;
      this.reach = Math.max(this.reach,
        this.box[0][axis] - lines.grid[i], lines.grid[i] - this.box[1][axis]);
    }
    const cone = twgl.primitives.createTruncatedConeVertices(1, 0, 1, 24, 1);
    this.cone = twgl.createBufferInfoFromArrays(gl, {
      position: { numComponents: 3, data: cone.position },
      point_normal: { numComponents: 3, data: cone.normal },
      indices: { numComponents: 3, data: cone.indices },
    });
    gl.enable(gl.DEPTH_TEST);
  }

  // Frees what is in the graphics card.
  release() {
    const gl = this.gl;
    const infos = [
      this.grid, this.edge, this.cone, ...Object.values(this.marks),
    ].filter(Boolean);
    for (const { attribs, indices } of infos) {
      for (const { buffer } of Object.values(attribs)) {
        gl.deleteBuffer(buffer);
      }
      gl.deleteBuffer(indices ?? null);
    }
    gl.deleteBuffer(this.strips);
    gl.deleteBuffer(this.beads);
    gl.deleteVertexArray(this.noAttributes);
    for (const set of [this.whole, this.coarse]) {
      gl.deleteTexture(set.pointsTexture);
      gl.deleteTexture(set.detailTexture);
    }
    for (const { program } of [this.bead, this.line, this.solid, this.mark]) {
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
      gl.deleteTexture(set.detailTexture);
      set.detailTexture = texture(gl, bytes, gl.RGBA8UI, gl.UNSIGNED_BYTE);
    }
  }

  // Finds out how much the graphics card can do, before it is asked for more.
  async calibrate(camera, show) {
    if (this.whole.count < 20000) {
      return;
    }
    const gl = this.gl;
    const measured = async level => {
      this.level = level;
      const start = performance.now();
      this.draw(camera, show, true);
      const done = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      while (gl.clientWaitSync(done, 0, 0) === gl.TIMEOUT_EXPIRED
        && performance.now() - start < 3000) {
        await new Promise(resolve => setTimeout(resolve, 1));
      }
      gl.deleteSync(done);
      return performance.now() - start;
    };
    // The first picture also compiles. Every picture takes some time, however
    // few lines it has.
    const cheapest = LEVELS.length - 1;
    await measured(cheapest);
    let [level, took] = [cheapest, await measured(cheapest)];
    const few = this.triangles;
    const perLine =
      Math.max(0, await measured(LINES + 3) - took) / (this.triangles - few + 1);
    // Levels are tried from the cheapest one on, until one takes too long.
    for (let next = cheapest - 1; next >= 0 && took < SMOOTH; next--) {
      // On a card that draws all lines fast enough, levels with fewer beads are
      // not tried.
      if (next > LAST_COARSE && next < LINES) {
        continue;
      }
      took = await measured(next);
      if (took < SMOOTH) {
        level = next;
      }
    }
    this.level = level;
    const within = rest => {
      const { coarse, elements } = LEVELS[rest];
      const lines = elements / 3 + 1;
      const { count } = coarse ? this.coarse : this.whole;
      return count * lines * perLine < PATIENCE;
    };
    this.restLevel = AT_REST.find(within) ?? LINES;
    // A level that is fast enough while the view changes is fast enough at
    // rest.
    if (AT_REST.includes(level)) {
      this.restLevel = Math.min(this.restLevel, level);
    }
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
      moving ? this.level : this.restLevel;
    const lines = LEVELS[level].elements === 0;
    const density = moving && lines ? LINES_DENSITY
      : level > 0 ? 1 : Math.min(2, window.devicePixelRatio || 1);
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
      to_clip: camera.matrix(
        canvas.clientWidth, canvas.clientHeight, this.reach),
      light: toward(-0.45, 0.65, 0.62),
      side: toward(0.8, -0.1, 0.6),
    };

    gl.useProgram(this.line.program);
    twgl.setBuffersAndAttributes(gl, this.line, this.grid);
    twgl.setUniforms(this.line, { ...shared, line_colour: show.grid });
    twgl.drawBufferInfo(gl, this.grid, gl.LINES);
    if (this.edge) {
      twgl.setBuffersAndAttributes(gl, this.line, this.edge);
      twgl.setUniforms(this.line, { line_colour: show.edge });
      twgl.drawBufferInfo(gl, this.edge, gl.LINES);
    }

    const pixel = 2 * Math.tan(FIELD_OF_VIEW / 2) / height;
    gl.useProgram(this.bead.program);
    twgl.setUniforms(this.bead, {
      ...shared,
      eye: camera.eye,
      origin: told.origin,
      unit: told.unit,
      length_unit: told.length_unit,
      pixel,
      plane: show.plane,
      by_value: this.byValue,
      colours: show.colours.flat(),
      ramp: show.ramp.flat(),
    });
    this.uniforms = { hidden: show.hidden, pale: show.pale, swell: 1 };
    this.triangles = 0;
    // Beads that are cut show their sections.
    const tips = show.plane.slice(0, 3).some(n => n !== 0);
    const how = tips && !lines
      ? { ...LEVELS[level], elements: BEAD_TRIANGLES.length } : LEVELS[level];
    this.drawBeads(how, show);
    if (show.picked >= 0) {
      this.drawPicked(show);
    }
    if (show.marks.length > 0) {
      gl.useProgram(this.mark.program);
      const { mm, least, most } = MARK_SIZE;
      const size = [mm, least * density, most * density];
      twgl.setUniforms(this.mark, {
        ...shared, eye: camera.eye, plane: show.plane, pixel, size,
      });
      for (const kind of show.marks) {
        this.drawMarks(kind, show);
      }
    }

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

  // The bead that was picked, a little larger, so that it covers itself.
  drawPicked({ picked, accent }) {
    const { hidden } = this.uniforms;
    this.uniforms = { hidden: 0, pale: accent, swell: 1.12 };
    this.range(this.whole, picked, picked + 1,
      { reach: 1, elements: BEAD_TRIANGLES.length, pallor: 0.85 });
    this.uniforms = { ...this.uniforms, hidden };
  }

  // Marks of the layers and moves that are shown.
  drawMarks(kind, { low, end }) {
    const gl = this.gl;
    const all = marks.of(kind);
    if (all.length === 0) {
      return;
    }
    this.marks[kind] ??= twgl.createBufferInfoFromArrays(gl, {
      position: { numComponents: 3, data: marks.places(kind) },
    });
    const begin = countBelow(all, this.whole.first[low]);
    const stop = countBelow(all, end + 1);
    twgl.setBuffersAndAttributes(gl, this.mark, this.marks[kind]);
    twgl.setUniforms(this.mark, { mark_colour: rgb(MARKS[kind].colour) });
    if (stop > begin) {
      gl.drawArrays(gl.POINTS, begin, stop - begin);
    }
  }

  // The moves of a set from `begin` to before `end`.
  range(set, begin, end, { reach, elements, pallor }) {
    if (end <= begin) {
      return;
    }
    const gl = this.gl;
    gl.bindVertexArray(this.noAttributes);
    const lines = elements === 0;
    twgl.setUniforms(this.bead, {
      ...this.uniforms, stretch: reach, pallor, lines,
      points: set.pointsTexture, details: set.detailTexture,
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER,
      elements > STRIPS ? this.beads : this.strips);
    for (let at = begin; at < end; at += CHUNK) {
      const count = Math.min(CHUNK, end - at);
      twgl.setUniforms(this.bead, { begin: at });
      if (lines) {
        gl.drawArrays(gl.LINES, 0, 2 * count);
      } else {
        gl.drawElements(
          gl.TRIANGLES, elements * count, gl.UNSIGNED_SHORT, 0);
      }
    }
    gl.bindVertexArray(null);
    this.triangles += (end - begin) * (lines ? 1 : elements / 3);
  }
}

// Whole numbers, four to a texel, in rows of ROW texels.
function texture(gl, numbers, format, type) {
  const rows = Math.max(1, Math.ceil(numbers.length / 4 / ROW));
  const padded = new numbers.constructor(4 * ROW * rows);
  padded.set(numbers);
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texImage2D(gl.TEXTURE_2D, 0, format, ROW, rows, 0,
    gl.RGBA_INTEGER, type, padded);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  return made;
}
