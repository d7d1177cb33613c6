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
uniform int base;
uniform int bright_from;
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
  if (base + gl_InstanceID < bright_from) {
    colour = mix(colour, pale, 0.72);
  }
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
  vec3 p = position.xzy * vec3(1.0, 1.0, -1.0) + vec3(0.0, 0.0, 0.5);
  gl_Position = to_clip * vec4(tip + size * p, 1.0);
}`;

// Two triangles for each of two strips, and two for each of two tips.
const BEAD_TRIANGLES = [
  0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4,
  0, 1, 6, 1, 2, 6, 3, 4, 7, 4, 5, 7,
];
const STRIPS = 12;

// How fast the picture is to change while it is turned, milliseconds.
const SMOOTH = 40;
// Greatest step down: so many layers in one.
const COARSEST = 7;

class Scene {
  constructor(canvas, told, moves, box) {
    this.canvas = canvas;
    this.told = told;
    this.moves = moves;
    this.box = box;
    this.detail = new ArrayBuffer(4 * moves.count);
    const short = new Uint16Array(this.detail);
    const bytes = new Uint8Array(this.detail);
    for (let i = 0; i < moves.count; i++) {
      short[2 * i] = moves.heights[i];
      bytes[4 * i + 2] = moves.roles[i];
    }
    this.byValue = false;
    // 0: everything; 1: without tips; then 2, 4, 8, … layers as one.
    this.level = 0;
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
    const points = buffer(this.moves.points);
    const detail = buffer(new Uint8Array(this.detail));
    const attribute = (buffer, numComponents, type, stride) => ({
      buffer, numComponents, type, stride,
      normalize: false, offset: 0, divisor: 1,
    });
    this.detailBuffer = detail;
    this.beads = {
      elementType: gl.UNSIGNED_BYTE,
      indices: twgl.createBufferFromTypedArray(
        gl, new Uint8Array(BEAD_TRIANGLES), gl.ELEMENT_ARRAY_BUFFER),
      attribs: {
        from: attribute(points, 4, gl.UNSIGNED_SHORT, 8),
        to: attribute(points, 4, gl.UNSIGNED_SHORT, 8),
        height: attribute(detail, 1, gl.UNSIGNED_SHORT, 4),
        what: attribute(detail, 2, gl.UNSIGNED_BYTE, 4),
      },
    };
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

  // Colours by a number for each move, from `low` to `high`, or by role.
  colourBy(number, low, high) {
    this.byValue = number !== null;
    if (number) {
      const bytes = new Uint8Array(this.detail);
      const scale = high > low ? 255 / (high - low) : 0;
      for (let i = 0; i < this.moves.count; i++) {
        const at = (number(i) - low) * scale;
        bytes[4 * i + 3] = at < 0 ? 0 : at > 255 ? 255 : Math.round(at);
      }
    }
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.detailBuffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Uint8Array(this.detail));
  }

  // Remembers how long frames take while the view changes.
  pace(milliseconds) {
    const slow = milliseconds > SMOOTH;
    const fast = milliseconds < SMOOTH / 3;
    this.tooSlow = slow ? (this.tooSlow || 0) + 1 : 0;
    this.fastEnough = fast ? (this.fastEnough || 0) + 1 : 0;
    if (this.tooSlow > 1 || milliseconds > 4 * SMOOTH) {
      this.level = Math.min(COARSEST, this.level + 1);
      this.tooSlow = 0;
    } else if (this.fastEnough > 20 && this.level > 0) {
      this.level--;
      this.fastEnough = 0;
    }
  }

  // `show`: what is shown, and how; `moving`: while the view changes.
  draw(camera, show, moving) {
    const { gl, canvas, told } = this;
    const level = moving ? this.level : 0;
    const density =
      level > 0 ? 1 : Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * density));
    const height = Math.max(1, Math.round(canvas.clientHeight * density));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const aspect = width / height;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...show.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);

    const [right, up, back] = camera.axes;
    const toward = (x, y, z) => twgl.v3.normalize(
      right.map((r, i) => x * r + y * up[i] + z * back[i]));
    const shared = {
      to_clip: camera.matrix(aspect),
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
      bright_from: show.brightFrom,
    });
    this.uniforms = { hidden: show.hidden, stretch: 1, base: 0 };
    this.triangles = 0;
    const stride = level > 1 ? 2 ** (level - 1) : 1;
    const elements = level > 0 ? STRIPS : BEAD_TRIANGLES.length;
    if (stride === 1) {
      this.range(told.first[show.low], show.end, 1, elements);
    } else {
      for (let layer = show.high; layer >= show.low; layer -= stride) {
        const end = layer === show.high ? show.end : told.first[layer + 1];
        const reach = Math.min(stride, layer - show.low + 1);
        this.range(told.first[layer], end, reach, elements);
      }
    }

    if (show.marker) {
      gl.useProgram(this.solid.program);
      twgl.setBuffersAndAttributes(gl, this.solid, this.cone);
      twgl.setUniforms(this.solid, {
        ...shared,
        tip: show.marker,
        size: 0.022 * camera.distance,
        marker_colour: show.accent,
      });
      twgl.drawBufferInfo(gl, this.cone);
    }
  }

  // The moves from `first` to before `end`.
  range(first, end, stretch, elements) {
    if (end <= first) {
      return;
    }
    const { gl, beads } = this;
    const { from, to, height, what } = beads.attribs;
    from.offset = 8 * first;
    to.offset = 8 * first + 8;
    height.offset = 4 * first;
    what.offset = 4 * first + 2;
    twgl.setBuffersAndAttributes(gl, this.bead, beads);
    this.uniforms.base = first;
    this.uniforms.stretch = stretch;
    twgl.setUniforms(this.bead, this.uniforms);
    gl.drawElementsInstanced(
      gl.TRIANGLES, elements, gl.UNSIGNED_BYTE, 0, end - first);
    this.triangles += (end - first) * elements / 3;
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
