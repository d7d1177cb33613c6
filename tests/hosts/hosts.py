"""Slices a part for every firmware, and asks each host's parser what it is.

The part is a block of 20 x 20 x 9.6 mm; the end of the print moves the head
higher, which is not the part's height.
"""

import importlib.util
import json
import subprocess
import sys
import sysconfig
from pathlib import Path

ISOSLICE, WORK = sys.argv[1], Path(sys.argv[2])
PACKAGES = Path(sysconfig.get_path("purelib"))
METADATA = PACKAGES / "moonraker/components/file_manager/metadata.py"
INTERPRETER = PACKAGES / "octoprint/util/gcodeInterpreter.py"
BLOCK = "max(max(abs(x) - 10, abs(y) - 10), abs(z) - 4.8)"
# A cone whose last layer by its height is thinner than a line.
CONE = "max(sqrt(x^2 + y^2) - 10 + z, -z)"


def module(path, name):
    """A file as a module, without the package around it and what that needs."""
    spec = importlib.util.spec_from_file_location(name, path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


octoprint = module(INTERPRETER, "gcodeInterpreter")
faults = []


def sliced(name, *words, formula=BLOCK):
    path = WORK / f"{name}.gcode"
    command = [ISOSLICE, "slice", "-e", formula, "-o", path, "--json", *words]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return path, json.loads(done.stdout)


def same(host, what, found, expected, within=0.0):
    if isinstance(expected, (int, float)) and isinstance(found, (int, float)):
        good = abs(found - expected) <= within
    else:
        good = found == expected
    if not good:
        faults.append(f"{host}: {what} is {found!r} and not {expected!r}")


def moonraker(path, summary, layers, height):
    command = [sys.executable, METADATA, "-p", path.parent, "-f", path.name]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    # Read and written as Moonraker's file manager does.
    found = json.loads(done.stdout.strip().splitlines()[-1])["metadata"]
    name = f"Moonraker, {path.stem}"
    same(name, "slicer", found.get("slicer"), "isoslice")
    same(name, "layers", found.get("layer_count"), layers)
    same(name, "height", found.get("object_height"), height, 1e-6)
    time, length = summary["print_time_s"], summary["filament_mm"]
    same(name, "time", found.get("estimated_time"), time, 1.0)
    same(name, "filament", found.get("filament_total"), length, 0.01)
    weight = summary["filament_g"]
    same(name, "weight", found.get("filament_weight_total"), weight, 0.01)
    for key, expected in {
        "layer_height": 0.2,
        "first_layer_height": 0.2,
        "nozzle_diameter": 0.4,
        "first_layer_extr_temp": 215.0,
        "first_layer_bed_temp": 60.0,
        "filament_temps": [210],
        "filament_type": "PLA",
        "filament_name": "PLA",
        "filament_change_count": 0,
    }.items():
        same(name, key, found.get(key), expected, 1e-9)
    return found


def prusa_link(path, summary, height):
    from gcode_metadata import get_metadata

    found = get_metadata(str(path), save_cache=False)
    name, data = f"PrusaLink, {path.stem}", found.data
    length, mass = summary["filament_mm"], summary["filament_g"]
    same(name, "filament", data.get("filament used [mm]"), length, 0.01)
    same(name, "weight", data.get("filament used [g]"), mass, 0.01)
    for key, expected in {
        "layer_height": 0.2,
        "max_layer_z": height,
        "nozzle_diameter": 0.4,
        "filament_type": "PLA",
        "temperature": 210,
        "bed_temperature": 60,
        "fill_density": "15%",
        "brim_width": 0,
        "ironing": 0,
        "support_material": 0,
        "layer_info_present": True,
    }.items():
        same(name, key, data.get(key), expected, 1e-9)
    if "estimated printing time (normal mode)" not in data:
        faults.append(f"{name}: there is no time")
    return found


def octo_print(path, summary, height):
    reader = octoprint.gcode(incl_layers=True)
    reader.load(str(path))
    found = reader.get_result()
    name = f"OctoPrint, {path.stem}"
    same(name, "height", found["printing_area"]["maxZ"], height, 1e-6)
    # The last retraction is not fed again.
    length = summary["filament_mm"]
    same(name, "filament", found["extrusion_length"][0], length, 1.0)
    # It plans no moves, and knows no accelerations.
    minutes = summary["print_time_s"] / 60
    if not 0.4 * minutes < found["total_time"] < 1.2 * minutes:
        faults.append(f"{name}: {found['total_time']} of {minutes} min")
    for side in ("width", "depth"):
        # With the skirt, 5 mm round the part.
        if not 20 <= found["dimensions"][side] <= 35:
            faults.append(f"{name}: {side} {found['dimensions'][side]}")


for flavour in ("marlin", "klipper", "rrf", "prusa"):
    for comments in ("prusa", "orca", "cura"):
        path, summary = sliced(
            f"{flavour}-{comments}",
            "--set", f"gcode.flavour={flavour}",
            "--set", f"gcode.comments={comments}",
            "--set", "gcode.thumbnails=32x32, 64x48/QOI, 96x96/JPG",
        )
        found = moonraker(path, summary, 48, 9.6)
        sizes = [[t["width"], t["height"]] for t in found["thumbnails"]]
        same(path.stem, "pictures", sizes, [[32, 32], [64, 48], [96, 96]])
        octo_print(path, summary, 9.6)
        if comments != "cura":
            link = prusa_link(path, summary, 9.6)
            pictures = ["32x32_PNG", "64x48_QOI", "96x96_JPG"]
            same(path.stem, "pictures", list(link.thumbnails), pictures)

# Some of a part's layers, and a part that ends before its height does.
path, summary = sliced("range", "--layers", "11..20")
moonraker(path, summary, 10, 4.0)
path, summary = sliced("cone", formula=CONE)
moonraker(path, summary, summary["layer_count"], 9.8)
same("cone", "layers", summary["layer_count"], 49)
octo_print(path, summary, 9.8)

# The first line has a date: with --timestamp that of the file.
path, summary = sliced("dated", "--timestamp")
moonraker(path, summary, 48, 9.6)

for fault in faults:
    print(f"FAULT: {fault}")
if faults:
    sys.exit(1)
print("Moonraker, OctoPrint and PrusaLink read what they show")
