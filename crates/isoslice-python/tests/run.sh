#!/usr/bin/env bash
# Builds the wheel, installs it in an environment of its own, and tests it.
#
#     crates/isoslice-python/tests/run.sh [ISOSLICE]
#
# ISOSLICE is the program to compare with, default target/release/isoslice. It
# needs python3 with venv, and PyPI for maturin, pytest and numpy. Where one of
# them cannot be had, it says so, leaves the test out and exits with 0; with
# ISOSLICE_PYTHON=required that is an error.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/../../../tests/others.sh" "the Python package" ISOSLICE_PYTHON "${1:-}"
# Bytes of the largest wheel.
most=10000000

command -v python3 >/dev/null || skip "there is no python3"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' \
    || skip "python3 is older than 3.10"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv" >"$work/log" 2>&1 \
    || skip "python3 cannot make an environment (apt-get install python3-venv)"
pip=("$work/venv/bin/pip" --quiet --disable-pip-version-check)
"${pip[@]}" install 'maturin>=1.9,<2' pytest numpy >"$work/log" 2>&1 \
    || skip "pip cannot get maturin, pytest and numpy"

# The crates that the program is made of are compiled already.
PATH="$work/venv/bin:$PATH" "${pip[@]}" wheel --no-deps --no-build-isolation \
    --wheel-dir "$work/wheel" "$root" 2>&1 | tee "$work/log"
wheel=$(echo "$work"/wheel/isoslice-*.whl)
size=$(stat -c %s "$wheel" 2>/dev/null || stat -f %z "$wheel")
echo "$(basename "$wheel"): $size bytes"
[ "$size" -le "$most" ] || { echo "the wheel is too large" >&2; exit 1; }
"${pip[@]}" install --no-index "$wheel"

# Not in the root, so that the package is the installed one.
cd "$work"
ISOSLICE=$isoslice "$work/venv/bin/python" -m pytest -q -p no:cacheprovider \
    -c "$root/pyproject.toml" --rootdir "$root" "$here"
