#!/usr/bin/env bash
# What hosts make of our files: the real parsers of Moonraker, OctoPrint and
# PrusaLink, from PyPI, read them, and these hosts themselves are sent some.
#
#     tests/hosts/run.sh [ISOSLICE]       the program, default target/release/isoslice
#
# Needs python3 with venv, and PyPI. Where one of them cannot be had, it says
# so, leaves the test out and exits with 0; with ISOSLICE_HOSTS=required that
# is an error. VENV names a folder in which the parsers stay for the next time.
# KLIPPER names a folder with Klipper's sources; otherwise they are got from
# GitHub, with git, make and gcc. Without them Moonraker prints nothing, and a line
# says so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/../others.sh" "the hosts" ISOSLICE_HOSTS "${1:-}"
# Their own dependencies are not needed to read a file; Pillow makes small
# pictures of large ones.
parsers=(moonraker==0.11.0 OctoPrint==1.11.8 py-gcode-metadata==0.2.0 pillow)

command -v python3 >/dev/null || skip "there is no python3"

work=$(mktemp -d)
# PrusaLink keeps no files in /tmp.
kept=$(mktemp -d -p /var/tmp)
trap 'rm -rf "$work" "$kept"' EXIT
venv=${VENV:-$work/venv}
[ -x "$venv/bin/pip" ] || python3 -m venv "$venv" >"$work/log" 2>&1 \
    || skip "python3 cannot make an environment (apt-get install python3-venv)"
"$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
    "${parsers[@]}" >"$work/log" 2>&1 \
    || skip "pip cannot get ${parsers[*]}"

"$venv/bin/python" "$here/hosts.py" "$isoslice" "$work"

# Klipper, whose sources describe its micro-controller once they are compiled.
klipper() {
    local venv=${VENV:-$work/venv}-klipper
    if [ -z "${KLIPPER:-}" ]; then
        KLIPPER=$work/klipper
        timeout 120 git clone --quiet --depth 1 --branch v0.13.0 \
            https://github.com/Klipper3d/klipper "$KLIPPER" || return 1
    fi
    [ -x "$venv/bin/pip" ] || python3 -m venv "$venv" || return 1
    "$venv/bin/pip" install --quiet --disable-pip-version-check \
        cffi==2.1.1 greenlet==3.5.6 jinja2==3.1.6 markupsafe==3.0.4 \
        pyserial==3.5 || return 1
    if [ ! -f "$KLIPPER/out/klipper.dict" ]; then
        printf 'CONFIG_LOW_LEVEL_OPTIONS=y\nCONFIG_MACH_LINUX=y\n' \
            >"$KLIPPER/.config" || return 1
        make -C "$KLIPPER" olddefconfig || return 1
        make -C "$KLIPPER" || return 1
    fi
    export KLIPPER KLIPPER_PYTHON=$venv/bin/python
}
klipper >"$work/log" 2>&1 || {
    echo "SKIPPED: printing with Klipper: its sources cannot be got or compiled"
    unset KLIPPER
}

# The hosts themselves, to send files to. What they depend on does not go
# together, so each has an environment of its own.
for host in octoprint==1.11.8 moonraker==0.11.0 prusalink==0.8.1; do
    name=${host%%=*}
    venv=${VENV:-$work/venv}-$name
    mkdir "$kept/$name"
    [ -x "$venv/bin/pip" ] || python3 -m venv "$venv" >"$work/log" 2>&1
    "$venv/bin/pip" install --quiet --disable-pip-version-check "$host" \
        >"$work/log" 2>&1 || skip "pip cannot get $host and what it needs"
    if [ "$name" = prusalink ] \
        && ! "$venv/bin/python" -c "import magic, pyudev; pyudev.Context()" >"$work/log" 2>&1; then
        skip "PrusaLink needs libmagic and libudev (apt-get install libmagic1 libudev1)"
    fi
    "$venv/bin/python" "$here/send.py" "$name" "$isoslice" "$kept/$name"
done
