#!/usr/bin/env bash
# Makes the pictures in this folder from the examples.
# Needs rsvg-convert (Debian: librsvg2-bin) beside Rust.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# picture MODEL LAYER: one layer of an example, as `slice --svg` draws it.
picture() {
    cargo run --release --quiet -- slice "examples/$1.rhai" \
        -o "$work/$1.gcode" --svg "$work/$1" --quiet
    rsvg-convert --width 800 "$work/$1/layer-$2.svg" -o "assets/$1.png"
}

picture lattice-part 00090
