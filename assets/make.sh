#!/usr/bin/env bash
# Makes the pictures in this folder from the examples.
# Needs rsvg-convert (Debian: librsvg2-bin) beside Rust, for the preview's
# picture also what tests/browser/run.sh needs, and Python with Pillow.
# Not made here: junctions.png and strokes.png, of which half shows what an earlier
# version printed.
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

# patterns: a layer of a square with two holes in each of the infill patterns.
patterns() {
    local plate='max(max(max(abs(x) - 15, abs(y) - 15), abs(z - 3) - 3),
        -min(sqrt((x - 5)^2 + (y - 3)^2) - 5, sqrt((x + 8)^2 + (y + 7)^2) - 3))'
    local column=0 row=0 name
    {
        echo '<svg xmlns="http://www.w3.org/2000/svg" width="1600"
            height="1200" viewBox="0 0 1600 1200">'
        echo '<rect width="100%" height="100%" fill="#fff"/>'
        for name in concentric cubic diamond grid gyroid hexagons lidinoid \
            neovius rectilinear schwarz-p triangles; do
            cargo run --release --quiet -- slice -e "$plate" \
                -o "$work/p.gcode" --svg "$work/$name" --quiet \
                --set infill="$name" --set infill_density=20 \
                --set skirt.loops=0 --layers 12..12
            echo "<g transform=\"translate($((400 * column)) $((400 * row)))\">"
            sed -e 's/width="[0-9]*" height="[0-9]*"/width="370" height="370"/' \
                -e 's/stroke="#16e"/stroke="none"/' \
                "$work/$name"/layer-*12.svg
            echo "<text x=\"185\" y=\"388\" font-family=\"sans-serif\"
                font-size=\"22\" text-anchor=\"middle\">$name</text></g>"
            column=$((column + 1))
            if [ $column = 4 ]; then column=0 row=$((row + 1)); fi
        done
        echo '</svg>'
    } >"$work/infill.svg"
    rsvg-convert --width 1200 "$work/infill.svg" -o assets/infill.png
}

patterns

# The preview's page, in few enough colours to be small.
cargo build --release --quiet
SCREENSHOTS=$work tests/browser/run.sh
python3 - "$work/ball.png" assets/preview.png <<'END'
import sys
from PIL import Image
picture = Image.open(sys.argv[1]).convert("RGB")
small = picture.quantize(
    255, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
small.save(sys.argv[2], optimize=True)
END

# gallery: a small picture of each model in examples/gallery, and the page that
# shows them. A model's first line is its caption.
gallery() {
    local model name caption
    mkdir -p assets/gallery
    {
        echo '# Gallery'
        echo
        echo 'Each of these is a script of a few lines in `examples/gallery`, whose head'
        echo 'says how it is sliced. The pictures are made by `isoslice render`.'
        echo
        echo '| picture | script | what it shows |'
        echo '|---|---|---|'
        for model in examples/gallery/*.rhai; do
            name=$(basename "$model" .rhai)
            target/release/isoslice render "$model" --pixels 240x180 \
                -o "assets/gallery/$name.png" --quiet
            caption=$(sed -n '1s|^// \(.*\)\.$|\1|p' "$model")
            echo "| ![$name](../assets/gallery/$name.png) |" \
                "[$name](../$model) | ${caption//|/\\|} |"
        done
    } >docs/gallery.md
}

gallery

# textures: a tile with each pattern of docs/textures.md.
textures() {
    local name
    mkdir -p assets/textures
    for name in $(sed -n 's/^| `\([a-z]*\)(.*assets.*/\1/p' docs/textures.md); do
        echo "box([-15, -15, 0], [15, 15, 4])
            .textured(1, $name(), #{projection: \"z\"})
            & box([-15, -15, 0.5], [15, 15, 9])" >"$work/$name.rhai"
        target/release/isoslice render "$work/$name.rhai" --pixels 180x135 \
            -o "assets/textures/$name.png" --quiet
    done
}

textures
