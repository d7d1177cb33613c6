#!/usr/bin/env bash
# Makes the two libraries in this folder from what their authors publish.
# Needs node and npm. Only the parts that the preview uses are kept.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{ "private": true }' >package.json
npm install --no-audit --no-fund --ignore-scripts --save-exact \
    twgl.js@7.0.0 fflate@0.8.3 esbuild@0.28.2 >/dev/null
(cd node_modules/esbuild && node install.js)

# bundle NAME SOURCE EXPORTS
bundle() {
    echo "export { $3 } from '$2';" >"$1.js"
    npx esbuild "$1.js" --bundle --minify --format=iife --global-name="$1" \
        --target=es2020 --legal-comments=inline --log-level=warning \
        --outfile="$here/$1.min.js"
}
bundle twgl twgl.js 'createProgramInfo, createBufferInfoFromArrays,
    createBufferFromTypedArray, setAttribInfoBufferFromArray,
    setBuffersAndAttributes, setUniforms, drawBufferInfo,
    resizeCanvasToDisplaySize, primitives, m4, v3'
bundle fflate fflate 'unzlibSync'

{
    echo 'twgl.js 7.0.0, https://twgljs.org'
    echo
    cat node_modules/twgl.js/LICENSE.md
    echo
    echo 'fflate 0.8.3, https://github.com/101arrowz/fflate'
    echo
    cat node_modules/fflate/LICENSE
} >"$here/LICENSES.txt"
cd "$here"
sha256sum twgl.min.js fflate.min.js >SHA256SUMS
