#!/usr/bin/env python3
"""isoslice against the way through a mesh: makes docs/benchmark.md.

    benches/benchmark.py [--runs N] [--into FOLDER] [--quick]

Needs cargo and, of Debian and Ubuntu, the packages prusa-slicer, python3-numpy
and python3-matplotlib. With cura-engine, and the definitions of its settings from
the package cura (CURA_DEFINITIONS names their folder if it is another),
CuraEngine slices the meshes of the ten models, too. It takes under an hour on two
cores; nothing else should run meanwhile. `--quick` leaves out what takes more than
a minute, which shows in a few minutes that all of it works.

Ten models are formulas, of which this file, isoslice and the mesher read the
same text. The round ones are given to PrusaSlicer as meshes within 3.5 um of the
surface, which is what isoslice's outlines are allowed; making these meshes is
not counted. The others are meshed by fidget with cells of at most 0.5 mm, which
is counted. Layers, widths, walls, infill and skins are the same.
"""

import argparse
import math
import os
import platform
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field

import matplotlib
import numpy as np

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BUILT = os.path.join(
    os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target")), "release")
# How far a round model's mesh may be from its surface, mm.
SAGITTA = 0.0035
# Largest cell of the mesher, mm.
CELL = 0.5
# A run that takes longer than this is not repeated, s.
LONG = 60.0
# What takes longer than this, by the clock, is not tried with a larger part or
# smaller cells, s.
TOO_LONG = 100.0
LAYER = 0.2
WIDTH = 0.45

PRUSA = [
    "prusa-slicer", "--export-gcode", "--center", "200,200",
    "--bed-shape", "0x0,400x0,400x400,0x400", "--max-print-height", "400",
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
    os.path.join(BUILT, "isoslice"), "slice", "-q",
    "--set", "printer.bed_x=400", "--set", "printer.bed_y=400",
    "--set", "printer.height=400",
    "--set", "skirt.loops=1", "--set", "infill_density=15%",
    "--set", "top_layers=0.8mm", "--set", "bottom_layers=0.6mm",
]
DEFINITIONS = os.environ.get(
    "CURA_DEFINITIONS", "/usr/share/cura/resources/definitions")
# On the command line CuraEngine does not work out settings from others, so all
# that depend on the width, and what they come to, are here.
CURA = ["CuraEngine", "slice",
        "-j", os.path.join(DEFINITIONS, "fdmprinter.def.json")]
for setting in (
        "machine_width=400", "machine_depth=400", "machine_height=400",
        "machine_nozzle_size=0.4", "material_diameter=1.75",
        "layer_height=0.2", "layer_height_0=0.2",
        *(f"{part}line_width=0.45" for part in (
            "", "wall_", "skin_", "infill_", "skirt_brim_", "roofing_")),
        "wall_line_width_0=0.45", "wall_line_width_x=0.45",
        "wall_line_count=2", "wall_thickness=0.9",
        "infill_sparse_density=15", "infill_pattern=lines",
        "infill_line_distance=3", "infill_sparse_thickness=0.2",
        "top_layers=4", "top_thickness=0.8", "bottom_layers=3",
        "initial_bottom_layers=3", "bottom_thickness=0.6",
        "skin_outline_count=0", "skin_overlap_mm=0.0225",
        "infill_overlap_mm=0.045",
        *(f"{part}skin_preshrink=0.9" for part in ("", "top_", "bottom_")),
        *(f"{part}_expand_distance=0.9" for part in (
            "expand_skins", "top_skin", "bottom_skin")),
        "adhesion_type=skirt", "skirt_line_count=1"):
    CURA += ["-s", setting]
MESHER = os.path.join(BUILT, "through-mesh")


# --- What is measured -------------------------------------------------------

class Failed(Exception):
    """A command that did not do its work."""


@dataclass
class Runs:
    """Processor seconds and wall seconds of each run, and the most memory."""
    cpu: list = field(default_factory=list)
    wall: list = field(default_factory=list)
    memory: float = 0.0     # MB

    def mean(self):
        return sum(self.cpu) / len(self.cpu)

    def interval(self):
        """Half of the 95 % confidence interval of the mean (Student's t)."""
        n = len(self.cpu)
        if n < 2:
            return None
        t = {2: 12.71, 3: 4.303, 4: 3.182, 5: 2.776, 6: 2.571, 7: 2.447,
             8: 2.365, 9: 2.306, 10: 2.262}.get(n, 1.96)
        return t * float(np.std(self.cpu, ddof=1)) / math.sqrt(n)

    def plus(self, other):
        """Both, one after the other; of unequally many runs the fewer."""
        both = Runs(memory=max(self.memory, other.memory))
        both.cpu = [a + b for a, b in zip(self.cpu, other.cpu)]
        both.wall = [a + b for a, b in zip(self.wall, other.wall)]
        return both

    def text(self):
        half = self.interval()
        shown = "" if half is None else f" ± {half:.2f}"
        return f"{self.mean():.2f}{shown}"


def held(pid):
    """The most memory that a process has held so far, MB; 0 if the system does
    not tell."""
    try:
        with open(f"/proc/{pid}/status", encoding="utf-8") as file:
            most = [line for line in file if line.startswith("VmHWM:")]
        return int(most[0].split()[1]) / 1024
    except (OSError, IndexError):
        return 0.0


def measured(command, runs):
    """A command's runs; one that takes long is run once."""
    found = Runs()
    told = tempfile.NamedTemporaryFile()
    while len(found.cpu) < runs:
        start = time.monotonic()
        both = [(os.POSIX_SPAWN_OPEN, n, told.name,
                 os.O_WRONLY | os.O_TRUNC, 0) for n in (1, 2)]
        pid = os.posix_spawnp(command[0], command, os.environ,
                              file_actions=both)
        memory = 0.0
        while True:
            # The most it has held, which the usage below does not tell: there
            # it is no less than what this process holds.
            memory = max(memory, held(pid))
            ended, status, usage = os.wait4(pid, os.WNOHANG)
            if ended:
                break
            time.sleep(0.005)
        if status != 0:
            said = told.read().decode(errors="replace")
            raise Failed(f"{' '.join(command)}\n{said}")
        found.cpu.append(usage.ru_utime + usage.ru_stime)
        found.wall.append(time.monotonic() - start)
        found.memory = max(found.memory, memory)
        if found.wall[-1] > LONG:
            break
    return found


@dataclass
class Lines:
    """What is read of a G-code file: moves that extrude, and outer walls."""
    moves: int = 0
    bytes: int = 0
    # Middles of outer walls of the nominal width: x, y, z.
    walls: list = field(default_factory=list)


# Names of outer walls. CuraEngine gives all of them the nominal width, and its
# files do not name it.
OUTER = ("External perimeter", "WALL-OUTER")


def read(path):
    lines = Lines(bytes=os.path.getsize(path))
    x = y = z = e = 0.0
    role, width, relative = "", WIDTH, False
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
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
            if fed > 0 and length > 0:
                lines.moves += 1
                # Walls of another width fill what is too thin for two.
                if role in OUTER and abs(width - WIDTH) < 0.002:
                    for k in range(math.ceil(length / 0.1)):
                        t = (k + 0.5) / math.ceil(length / 0.1)
                        lines.walls.append((x + t * (to[0] - x),
                                            y + t * (to[1] - y), z))
            x, y = to
    return lines


def deviation(model, walls):
    """How far the outer walls' edges are outside of the surface, in the plane
    of their layer, um: the mean, and what 99 % are within; None without walls
    of the nominal width."""
    if not walls:
        return None
    # Of many places some, evenly.
    p = np.array(walls[::max(1, len(walls) // 4000)])
    px, py = p[:, 0] - 200.0, p[:, 1] - 200.0
    pz = p[:, 2] - 0.5 * LAYER + model.below
    # Roughly the nearest place that is not inside, by rings of places around
    # the wall's middle. The formula is no distance: its gradient alone may lead
    # to a surface that is farther away.
    nearest = np.full(len(p), np.inf)
    x, y = px.copy(), py.copy()
    for turn in np.linspace(0, 2 * math.pi, 48, endpoint=False):
        for reach in np.linspace(0.02, 2 * WIDTH, 45):
            to = px + reach * math.cos(turn), py + reach * math.sin(turn)
            found = (reach < nearest) & (model.at(*to, pz) >= 0)
            nearest[found] = reach
            x[found], y[found] = to[0][found], to[1][found]
    h = 1e-4

    def slope(x, y):
        return ((model.at(x + h, y, pz) - model.at(x - h, y, pz)) / (2 * h),
                (model.at(x, y + h, pz) - model.at(x, y - h, pz)) / (2 * h))

    # From there along the gradient to f = 0, then along the outline to where
    # the gradient points at the wall's middle.
    for _ in range(12):
        gx, gy = slope(x, y)
        size = np.maximum(gx * gx + gy * gy, 1e-12)
        f = model.at(x, y, pz)
        along = ((px - x) * -gy + (py - y) * gx) / size
        move = np.clip(-f / size, -1.0, 1.0)
        x, y = x + move * gx - along * gy, y + move * gy + along * gx
    distance = np.minimum(np.hypot(px - x, py - y), nearest)
    off = 1e3 * (0.5 * WIDTH - distance[np.isfinite(nearest)])
    if not len(off):
        return None
    return float(off.mean()), float(np.percentile(np.abs(off), 99))


# --- The models -------------------------------------------------------------

def arc(a, b, start, end, centre=0.0):
    """Points of an ellipse in the plane of radius and z."""
    n = math.ceil(abs(end - start) / 2 / math.acos(1 - SAGITTA / max(a, b)))
    turns = (start + (end - start) * k / n for k in range(n + 1))
    radius = [(centre + a * math.cos(t), b * math.sin(t)) for t in turns]
    return [(0.0 if abs(r) < 1e-9 else r, z) for r, z in radius]


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
    with open(path, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", count) + out)


@dataclass
class Model:
    name: str
    size: float             # largest side, mm
    below: float            # lowest z, mm
    formula: str
    # Of a round one its profile, from the bottom up, and if that is closed.
    round: tuple = None
    # Largest cell of its mesh, mm.
    cell: float = CELL

    def at(self, x, y, z):
        names = {"x": x, "y": y, "z": z, "abs": np.abs, "max": np.maximum,
                 "min": np.minimum,
                 "sin": np.sin, "cos": np.cos, "sqrt": np.sqrt}
        return eval(self.formula, {"__builtins__": {}}, names)


def gyroid_ball(size, cell, sheet):
    """A ball of a gyroid whose sheets are about so thick, mm."""
    k = 2 * math.pi / cell
    level = 0.75 * k * sheet
    s = [f"sin({a}*{k:.6f})*cos({b}*{k:.6f})" for a, b in ("xy", "yz", "zx")]
    # It stands on a plate of 1 mm: PrusaSlicer refuses what touches the bed in
    # a point.
    below = -0.4 * size
    return Model(f"gyroid ball, {size:g} mm", size, below,
                 f"max(max(min(abs({' + '.join(s)}) - {level:.6f}, "
                 f"z - {below + 1:g}), sqrt(x*x + y*y + z*z) - {size / 2:g}), "
                 f"{below:g} - z)",
                 cell=min(CELL, 0.5 * sheet))


QUARTER = math.pi / 2
MODELS = [
    Model("sphere", 30, -15, "sqrt(x*x + y*y + z*z) - 15",
          (arc(15, 15, -QUARTER, QUARTER), False)),
    Model("torus", 48, -6,
          "sqrt((sqrt(x*x + y*y) - 18)*(sqrt(x*x + y*y) - 18) + z*z) - 6",
          (arc(6, 6, 0, 4 * QUARTER, 18)[:-1], True)),
    Model("ellipsoid", 32, -10,
          "sqrt(x*x/256 + y*y/256 + z*z/100) - 1",
          (arc(16, 10, -QUARTER, QUARTER), False)),
    Model("cone", 30, 0, "max(sqrt(x*x + y*y) - 0.5*(30 - z), -z)",
          ([(0.0, 0.0), (15.0, 0.0), (0.0, 30.0)], False)),
    Model("rounded cube", 30, -15,
          "sqrt(sqrt(x*x*x*x + y*y*y*y + z*z*z*z)) - 15"),
    Model("tangle", 30, -10,
          "max(x*x*x*x/1296 - 5*x*x/36 + y*y*y*y/1296 - 5*y*y/36"
          " + z*z*z*z/1296 - 5*z*z/36 + 11.8, -10 - z)"),
    Model("twisted bar", 36, 0,
          "max(max(abs(x*cos(z/15) + y*sin(z/15)),"
          " abs(y*cos(z/15) - x*sin(z/15))) - 8, max(z - 36, -z))"),
    Model("Schwarz block", 24, -12,
          "max(abs(cos(x*0.785398) + cos(y*0.785398) + cos(z*0.785398)) - 0.5,"
          " max(max(abs(x), abs(y)), abs(z)) - 12)"),
    Model("strut lattice", 24, -12,
          "max(cos(x*0.785398)*cos(y*0.785398) + cos(y*0.785398)*cos(z*0.785398)"
          " + cos(z*0.785398)*cos(x*0.785398) + 0.65,"
          " max(max(abs(x), abs(y)), abs(z)) - 12)"),
    gyroid_ball(36, 9, 1.0),
]


def has_cura():
    """Whether CuraEngine and the definitions of its settings are there."""
    return shutil.which(CURA[0]) is not None and os.path.exists(CURA[3])


class Bench:
    def __init__(self, folder, runs):
        self.runs = runs
        # How long the mesh took that was made last.
        self.meshing = Runs()
        self.script, self.stl, self.gcode = (
            os.path.join(folder, name)
            for name in ("model.rhai", "model.stl", "model.gcode"))

    def ours(self, model):
        self.write(model)
        return measured(ISOSLICE + [self.script, "-o", self.gcode], self.runs)

    def theirs(self, model):
        """Meshing, if it counts, and slicing."""
        slicing = PRUSA + ["-o", self.gcode, self.stl]
        if model.round:
            turned(self.stl, *model.round)
            self.meshing = Runs([0.0] * self.runs, [0.0] * self.runs)
        else:
            self.write(model)
            depth = math.ceil(math.log2(1.2 * model.size / model.cell))
            self.meshing = measured(
                [MESHER, self.script, self.stl, str(depth)], self.runs)
        return self.meshing.plus(measured(slicing, self.runs))

    def cura(self, model):
        """Slicing, with CuraEngine, of the mesh that was made last."""
        return measured(CURA + ["-o", self.gcode, "-l", self.stl, "-s",
                                f"mesh_position_z={-model.below}"], self.runs)

    def write(self, model):
        with open(self.script, "w", encoding="utf-8") as file:
            file.write(model.formula + "\n")


# --- The page ---------------------------------------------------------------

INK = {"isoslice": "#c2410c", "through a mesh": "#475569"}


def curves(axis, title, unit, points):
    """`points`: by way the x and y of its curve, and half the interval."""
    for way, (x, y, half) in points.items():
        half = [0.0 if h is None else h for h in half]
        axis.errorbar(x, y, yerr=half, marker="o", markersize=4, capsize=3,
                      color=INK[way], label=way)
    axis.set(title=title, ylabel=unit, xscale="log", yscale="log")
    ticks = sorted({t for x, _, _ in points.values() for t in x})
    axis.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axis.minorticks_off()
    # On a short scale there may be one power of ten, or none.
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter("{x:g}")
    axis.grid(alpha=0.3)


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    plt.close(figure)


def first_line(command):
    out = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    lines = (out.stdout + out.stderr).splitlines()
    wanted = [line for line in lines if "[trace]" not in line and line.strip()]
    return wanted[0].strip() if wanted else "?"


def machine():
    def field_of(path, key):
        try:
            with open(path, encoding="utf-8") as file:
                found = [line for line in file if line.startswith(key)]
            return found[0].split(":", 1)[1].strip()
        except (OSError, IndexError):
            return "?"
    memory = field_of("/proc/meminfo", "MemTotal").split()[0]
    gigabytes = f"{int(memory) / 1e6:.0f} GB" if memory.isdigit() else "?"
    return (f"{field_of('/proc/cpuinfo', 'model name')}, {os.cpu_count()} "
            f"cores, {gigabytes}; {platform.system()}")


def of_others():
    """Processor time that other programs have taken so far, s; None if the
    system does not tell."""
    try:
        with open("/proc/stat", encoding="utf-8") as file:
            ticks = [int(word) for word in file.readline().split()[1:]]
    except (OSError, ValueError):
        return None
    # Of the first seven columns two are idle.
    busy = sum(ticks[:7]) - ticks[3] - ticks[4]
    usages = map(resource.getrusage,
                 (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    own = sum(usage.ru_utime + usage.ru_stime for usage in usages)
    return busy / os.sysconf("SC_CLK_TCK") - own


def compared(bench):
    """The tables of the ten models, and what their picture needs."""
    rows, cura_rows, ratios = [], [], []
    with_cura = has_cura()

    def edge(off):
        return "–" if off is None else f"{off[0]:+.1f} / {off[1]:.1f}"

    for model in MODELS:
        print(model.name, file=sys.stderr, flush=True)
        figures = []
        for way in (bench.ours, bench.theirs):
            runs = way(model)
            lines = read(bench.gcode)
            off = deviation(model, lines.walls)
            figures.append((runs, lines, off))
        (ours, a, off), (theirs, b, their_off) = figures
        ratio = theirs.mean() / ours.mean()
        ratios.append((model.name, ratio))
        rows.append(
            f"| {model.name} | {ours.text()} | {theirs.text()} | {ratio:.0f} "
            f"| {ours.memory:.0f} | {theirs.memory:.0f} "
            f"| {a.bytes / 1e6:.2f} | {b.bytes / 1e6:.2f} "
            f"| {a.moves / 1e3:.1f} | {b.moves / 1e3:.1f} "
            f"| {edge(off)} | {edge(their_off)} |")
        if with_cura:
            runs = bench.meshing.plus(bench.cura(model))
            lines = read(bench.gcode)
            cura_rows.append(
                f"| {model.name} | {runs.text()} "
                f"| {runs.mean() / ours.mean():.0f} | {runs.memory:.0f} "
                f"| {lines.bytes / 1e6:.2f} | {lines.moves / 1e3:.1f} "
                f"| {edge(deviation(model, lines.walls))} |")
    return rows, cura_rows, ratios


def grown(bench, models, limit):
    """Both ways along a row of models, the largest last; a way ends where it
    takes longer than `limit` seconds of the clock."""
    found = {way: ([], [], [], []) for way in INK}
    for way, run in zip(INK, (bench.ours, bench.theirs)):
        for at, model in models:
            print(way, model.name, at, file=sys.stderr, flush=True)
            try:
                runs = run(model)
            except Failed as failed:
                print(failed, file=sys.stderr)
                break
            for column, value in zip(found[way], (
                    at, runs.mean(), runs.interval(), runs.memory)):
                column.append(value)
            if runs.wall[-1] > limit:
                break
    return found


def growth_table(name, found):
    lines = [f"| {name} | isoslice, s | MB | through a mesh, s | MB |",
             "|---|---|---|---|---|"]
    ours, theirs = found.values()
    for k, at in enumerate(ours[0]):
        def pair(way):
            if k >= len(way[0]):
                return "– | –"
            half = way[2][k]
            shown = "" if half is None else f" ± {half:.2f}"
            return f"{way[1][k]:.2f}{shown} | {way[3][k]:.0f}"
        lines.append(f"| {at:g} | {pair(ours)} | {pair(theirs)} |")
    return lines


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--into", default=os.path.join(ROOT, "docs"))
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    for target in (["--bin", "isoslice"], ["-p", "through-mesh"]):
        subprocess.run(["cargo", "build", "--release", *target], cwd=ROOT,
                       check=True, stderr=subprocess.DEVNULL)
    sizes = [20, 50] if asked.quick else [20, 40, 80, 150, 300]
    cells = [10, 5] if asked.quick else [10, 7, 5, 3, 2]
    limit = 20.0 if asked.quick else TOO_LONG
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "isoslice",
                         "font.size": 9})
    pictures = os.path.join(asked.into, "benchmark")
    os.makedirs(pictures, exist_ok=True)
    began, before = time.monotonic(), of_others()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, asked.runs)
        rows, cura_rows, ratios = compared(bench)
        by_size = grown(bench, [
            (s, gyroid_ball(s, s / 4, s / 25)) for s in sizes], limit)
        by_cell = grown(bench, [
            (c, gyroid_ball(30, c, c / 5)) for c in cells], limit)

    figure, axes = plt.subplots(2, 2, figsize=(8, 6))
    for k, (found, label) in enumerate((
            (by_size, "size of the part, mm"), (by_cell, "size of a cell, mm"))):
        time_of = {way: (f[0], f[1], f[2]) for way, f in found.items()}
        memory = {way: (f[0], f[3], [0] * len(f[0])) for way, f in found.items()}
        curves(axes[0][k], "processor time", "s", time_of)
        curves(axes[1][k], "memory", "MB", memory)
        for row in axes:
            row[k].set_xlabel(label)
    axes[0][0].legend()
    save(figure, os.path.join(pictures, "growth.svg"))
    figure, axis = plt.subplots(figsize=(8, 3))
    names = [name for name, _ in ratios][::-1]
    axis.barh(names, [ratio for _, ratio in ratios][::-1], color=INK["isoslice"])
    axis.set(title="processor time through a mesh, in units of isoslice's")
    axis.grid(axis="x", alpha=0.3)
    save(figure, os.path.join(pictures, "ratio.svg"))

    cura = ""
    if cura_rows:
        cura = f"""

### With CuraEngine

The same meshes, sliced by {first_line([CURA[0], "help"])} with the settings above.
Meshing is counted as above, and the ratio is to isoslice's time.

| model | time | ratio | memory | file | moves | edges |
|---|---|---|---|---|---|---|
""" + "\n".join(cura_rows)
    minutes = (time.monotonic() - began) / 60
    others = ""
    if before is not None:
        share = (of_others() - before) / (60 * minutes * os.cpu_count())
        others = (f"\nMeanwhile other programs took {100 * max(share, 0):.0f} % "
                  "of the machine's processor time.")
    needs = "`prusa-slicer`, `python3-numpy` and `python3-matplotlib`"
    if cura:
        needs += ",\nand for one of the tables `cura-engine` and `cura`"
    page = f"""# Benchmark

isoslice against the way through a mesh: fidget's mesher and PrusaSlicer. All
of this page is made by one command:

    benches/benchmark.py

which needs {needs}.
This run took {minutes:.0f} minutes, with at most {asked.runs} runs of each command; one of
more than a minute was run once.{others}
Times are processor time of all threads in seconds, the mean and its 95 %
confidence interval (Student's t).

- Machine: {machine()}
- {first_line([ISOSLICE[0], "--version"])}, {first_line(["rustc", "--version"])}
- {first_line(["prusa-slicer", "--help"])}; fidget-mesh as in `Cargo.lock`
- Python {platform.python_version()}, NumPy {np.__version__}, Matplotlib {matplotlib.__version__}

Layers of 0.2 mm, lines of 0.45 mm, two walls, 15 % rectilinear infill, four
layers of skin above and three below, for both{", and for CuraEngine" if cura else ""}.{"" if cura else " CuraEngine is not compared."}

## Ten models

Time (s), memory (MB), file (MB), thousands of moves that extrude, and how far
the edges of outer walls are from the true surface (um: mean, positive outside,
and what 99 % of them are within), isoslice first, the way through a mesh second.
The deviation is measured against the formula, in the plane of each layer, of
walls of the nominal width.

The first four models are turned bodies; PrusaSlicer got them as meshes within
3.5 um of the surface, and making these is not counted. The others were meshed
with cells of at most {CELL} mm, which is counted.

| model | time | mesh | ratio | memory | mesh | file | mesh | moves | mesh | edges | mesh |
|---|---|---|---|---|---|---|---|---|---|---|---|
""" + "\n".join(rows) + cura + f"""

![Processor time by model](benchmark/ratio.svg)

## Growth

A ball of gyroid on a plate of 1 mm. By size: the ball is scaled, with four cells
across and sheets of a 25th of its size. By cell: a ball of 30 mm whose sheets are
a fifth of a cell thick. The mesher's cells are at most half of a sheet. A way
that took longer than {limit:.0f} s, or that ended with an error, was not tried any
further.

![Growth of time and memory](benchmark/growth.svg)

""" + "\n".join(growth_table("size, mm", by_size)) + "\n\n" \
        + "\n".join(growth_table("cell, mm", by_cell)) + "\n"
    with open(os.path.join(asked.into, "benchmark.md"), "w",
              encoding="utf-8") as file:
        file.write(page)


if __name__ == "__main__":
    try:
        main()
    except Failed as failed:
        sys.exit(f"failed: {failed}")
