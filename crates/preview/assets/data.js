// The moves, unpacked. crates/preview/src/pack.rs says how they are packed.

function fromBase64(text) {
  if (Uint8Array.fromBase64) {
    return Uint8Array.fromBase64(text);
  }
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) {
    bytes[i] = binary.charCodeAt(i);
  }
  return bytes;
}

async function inflate(packed, size) {
  if (typeof DecompressionStream === "function") {
    const stream = new Blob([packed]).stream()
      .pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }
  return fflate.unzlibSync(packed, { out: new Uint8Array(size) });
}

// Takes planes of bytes off an array, one after the other.
class Planes {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  take(count) {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }

  // Numbers of 16 bits, each `stride` from the one before it in `out`.
  short(count, out, start, stride) {
    const low = this.take(count);
    const high = this.take(count);
    for (let i = 0, at = start, last = 0; i < count; i++, at += stride) {
      const folded = low[i] | high[i] << 8;
      last = last + ((folded >>> 1) ^ -(folded & 1)) & 0xffff;
      out[at] = last;
    }
    return out;
  }

  long(count) {
    const planes = [0, 1, 2, 3].map(() => this.take(count));
    const out = new Uint32Array(count);
    for (let i = 0, last = 0; i < count; i++) {
      const folded = planes[0][i] | planes[1][i] << 8
        | planes[2][i] << 16 | planes[3][i] << 24;
      last = last + ((folded >>> 1) ^ -(folded & 1)) | 0;
      out[i] = last;
    }
    return out;
  }
}

// The layer of each move.
function layersOf({ moves, first }) {
  const layers = new Uint32Array(moves);
  first.forEach((start, layer) => layers.fill(layer, start, first[layer + 1]));
  return layers;
}

// All moves. `points` has x, y, z and, for the move that ends there, the
// width of its bead: as the graphics card gets it.
async function unpack(told, packed) {
  const planes = new Planes(await inflate(packed, told.size));
  const count = told.moves;
  const points = new Uint16Array(4 * (count + 1));
  for (let axis = 0; axis < 3; axis++) {
    planes.short(count + 1, points, axis, 4);
  }
  planes.short(count, points, 7, 4);
  const numbers = () => planes.short(count, new Uint16Array(count), 0, 1);
  return {
    count,
    points,
    heights: numbers(),
    areas: numbers(),
    speeds: numbers(),
    heats: numbers(),
    roles: planes.take(count),
    fans: planes.take(count),
    lines: planes.long(count),
    // How many moves were made before each retraction.
    retracted: planes.long(told.retracted),
    layers: layersOf(told),
    width(i) { return points[4 * i + 7] * told.length_unit; },
    height(i) { return this.heights[i] * told.length_unit; },
    heat(i) { return this.heats[i] * told.heat_unit; },
    speed(i) { return this.speeds[i] * told.speed_unit; },
    flow(i) { return this.areas[i] * told.area_unit * this.speed(i); },
    // Place after move i; before the first is -1.
    place(i) {
      const at = 4 * (i + 1);
      return [0, 1, 2].map(
        axis => told.origin[axis] + told.unit * points[at + axis]);
    },
    length(i) {
      const at = 4 * i;
      return told.unit * Math.hypot(
        points[at + 4] - points[at],
        points[at + 5] - points[at + 1],
        points[at + 6] - points[at + 2]);
    },
  };
}
