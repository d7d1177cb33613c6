#!/usr/bin/env python3
"""isoslice against the way through a mesh: processor time, and accuracy.

    benches/incumbents.py [RUNS]

Needs prusa-slicer (Debian and Ubuntu: apt-get install prusa-slicer) and
cargo. The gyroid ball is meshed by fidget with 0.47 mm cells and sliced by
PrusaSlicer; sphere, torus, ellipsoid and cone are given to PrusaSlicer as
meshes within 3.5 um of the surface, which is what isoslice's outlines are
allowed, and the meshing is not counted. Layers, widths, walls, infill and
skins are the same. Of RUNS runs (3) the fastest counts.

The second table is how far the outer walls' edges are from the true circles of
these models: points every 0.1 mm along the outer walls of the G-code.
"""

import math
import os
import struct
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SAGITTA = 0.0035

PRUSA = [
    "prusa-slicer", "--export-gcode", "--center", "110,110",
    "--nozzle-diameter", "0.4", "--layer-height", "0.2",
    "--first-layer-height", "0.2", "--perimeters", "2",
    "--fill-density", "15%", "--fill-pattern", "rectilinear",
    "--top-solid-layers", "4", "--bottom-solid-layers", "3",
    "--skirts", "1", "--elefant-foot-compensation", "0",
    "--extrusion-width", "0.45", "--first-layer-extrusion-width", "0.45",
    "--perimeter-extrusion-width", "0.45",
    "--external-perimeter-extrusion-width", "0.45",
    "--infill-extrusion-width", "0.45",
    "--solid-infill-extrusion-width", "0.45",
    "--top-infill-extrusion-width", "0.45",
]
ISOSLICE = [
    os.path.join(ROOT, "target/release/isoslice"), "slice", "-q",
    "--set", "skirt.loops=1", "--set", "infill_density=15%",
    "--set", "top_thickness=0.8", "--set", "bottom_thickness=0.6",
]


def timed(command):
    """Processor and wall seconds of a command."""
    start = time.monotonic()
    pid = os.posix_spawnp(
        command[0], command, os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
    _, status, usage = os.wait4(pid, 0)
    wall = time.monotonic() - start
    if status != 0:
        sys.exit(f"failed: {' '.join(command)}")
    return usage.ru_utime + usage.ru_stime, wall


def fastest(command, runs):
    results = [timed(command) for _ in range(runs)]
    return tuple(min(r[i] for r in results) for i in (0, 1))


def turned(path, profile, closed):
    """The surface that a line of (radius, z) leaves when turned about z."""
    largest = max(r for r, _ in profile)
    n = math.ceil(math.pi / math.acos(1 - SAGITTA / largest))
    turn = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n))
            for k in range(n)]
    ends = profile + profile[:1] if closed else profile
    out = bytearray()
    count = 0
    for (r, z), (s, w) in zip(ends, ends[1:]):
        for k in range(n):
            a, b = turn[k], turn[(k + 1) % n]
            p, q = (r * a[0], r * a[1], z), (r * b[0], r * b[1], z)
            u, v = (s * a[0], s * a[1], w), (s * b[0], s * b[1], w)
            for t in ((p, q, v), (p, v, u)):
                if len(set(t)) == 3:
                    out += struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0)
                    count += 1
    with open(path, "wb") as f:
        f.write(bytes(80) + struct.pack("<I", count) + out)
    return count


def arc(a, b, start, end, centre=0.0):
    """Points of an ellipse in the plane of radius and z."""
    n = math.ceil(abs(end - start) / 2 / math.acos(1 - SAGITTA / max(a, b)))
    points = []
    for k in range(n + 1):
        t = start + (end - start) * k / n
        r = centre + a * math.cos(t)
        points.append((0.0 if abs(r) < 1e-9 else r, b * math.sin(t)))
    return points


def root(value):
    return math.sqrt(max(value, 0.0))


QUARTER = math.pi / 2
ROUND = {
    # name: formula, profile from the bottom up, closed, and the radii of the
    # circles at a height above the bed
    "sphere": ("sqrt(x^2 + y^2 + z^2) - 15",
               arc(15, 15, -QUARTER, QUARTER), False,
               lambda z: [root(15**2 - (z - 15)**2)]),
    "torus": ("sqrt((sqrt(x^2 + y^2) - 18)^2 + z^2) - 6",
              arc(6, 6, 0, 4 * QUARTER, 18)[:-1], True,
              lambda z: [18 + side * root(6**2 - (z - 6)**2)
                         for side in (-1, 1)]),
    "ellipsoid": ("sqrt((x/16)^2 + (y/16)^2 + (z/10)^2) - 1",
                  arc(16, 10, -QUARTER, QUARTER), False,
                  lambda z: [16 * root(1 - ((z - 10) / 10)**2)]),
    "cone": ("max(sqrt(x^2 + y^2) - 0.5*(30 - z), -z)",
             [(0.0, 0.0), (15.0, 0.0), (0.0, 30.0)], False,
             lambda z: [0.5 * (30 - z)]),
}


def deviations(path, radii):
    """How far the outer walls' edges are outside of the circles, in um."""
    found = []
    x = y = z = e = 0.0
    role, width, relative = "", 0.0, False
    for line in open(path, encoding="utf-8", errors="replace"):
        if line.startswith(";TYPE:"):
            role = line[6:].strip()
        elif line.startswith(";WIDTH:"):
            width = float(line[7:])
        words = line.split(";")[0].split()
        if not words:
            continue
        if words[0] in ("M82", "M83"):
            relative = words[0] == "M83"
        values = {}
        if words[0] in ("G0", "G1", "G92"):
            values = {w[0]: float(w[1:]) for w in words[1:] if w[1:]}
        if words[0] == "G92":
            e = values.get("E", e)
            continue
        to = values.get("X", x), values.get("Y", y)
        z = values.get("Z", z)
        now = values.get("E", 0.0 if relative else e)
        fed = now if relative else now - e
        e = 0.0 if relative else now
        length = math.dist((x, y), to)
        # Walls of another width fill what is too thin for two.
        if (role == "External perimeter" and fed > 0 and length > 0
                and abs(width - 0.45) < 0.002):
            steps = math.ceil(length / 0.1)
            for k in range(steps):
                t = (k + 0.5) / steps
                r = math.hypot(x + t * (to[0] - x) - 110,
                               y + t * (to[1] - y) - 110)
                circles = radii(z - 0.1)
                near = min(circles, key=lambda c: abs(r - c))
                # The part is inside the larger circle, outside the smaller.
                sign = -1 if len(circles) == 2 and near == circles[0] else 1
                found.append(1e3 * (sign * (r - near) + width / 2))
        x, y = to
    return sorted(found)


def spread(path, radii):
    found = deviations(path, radii)
    if not found:
        return "-"
    size = sorted(map(abs, found))
    mean = sum(found) / len(found)
    return f"{mean:+.1f} / {size[int(0.99 * (len(size) - 1))]:.1f}"


def row(name, ours, theirs, note):
    cpu, wall = theirs[0] / ours[0], theirs[1] / ours[1]
    print(f"| {name} | {ours[0]:.2f} s | {theirs[0]:.2f} s | {cpu:.0f} x "
          f"| {wall:.0f} x | {note} |", flush=True)


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    for target in (["--bin", "isoslice"], ["--example", "mesh"]):
        subprocess.run(["cargo", "build", "--release", *target], cwd=ROOT,
                       check=True, stderr=subprocess.DEVNULL)
    mesher = os.path.join(ROOT, "target/release/examples/mesh")
    print("| model | isoslice | through a mesh | ratio | wall | mesh |")
    print("|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        stl, gcode = (os.path.join(folder, n) for n in ("m.stl", "m.gcode"))
        slicing = PRUSA + ["-o", gcode, stl]
        accuracy = []
        for name, (formula, profile, closed, radii) in ROUND.items():
            count = turned(stl, profile, closed)
            ours = fastest(ISOSLICE + ["-e", formula, "-o", gcode], runs)
            figures = [name, spread(gcode, radii)]
            theirs = fastest(slicing, runs)
            accuracy.append(figures + [spread(gcode, radii)])
            row(name, ours, theirs, f"{count} triangles, not counted")
        ball = os.path.join(ROOT, "examples/gyroid-ball.rhai")
        ours = fastest(ISOSLICE + [ball, "-o", gcode], runs)
        meshing = timed([mesher, ball, stl, "7"])
        # It takes minutes: once.
        sliced = timed(slicing)
        both = [m + s for m, s in zip(meshing, sliced)]
        row("gyroid ball", ours, both,
            f"{meshing[0]:.0f} s of it for the mesh, "
            f"{os.path.getsize(stl) / 1e6:.0f} MB")
    print("\nOuter wall's edge, mean / 99 % of the points within, um:\n")
    print("| model | isoslice | through a mesh |\n|---|---|---|")
    for figures in accuracy:
        print("| " + " | ".join(figures) + " |")


if __name__ == "__main__":
    main()
