#!/usr/bin/env bash
# Builds a Debian package of isoslice, with manual pages, completions, an
# icon, and an entry that opens scripts with `isoslice watch`:
#
#     cargo install cargo-deb
#     contrib/debian/build.sh
#     sudo apt install ./target/debian/isoslice_*.deb
#
# `Cargo.toml` says what is in it ([package.metadata.deb]). Words given to this
# script are passed on to cargo deb, as in `--output DIR`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

cargo build --release --locked
isoslice=${CARGO_TARGET_DIR:-target}/release/isoslice

made=target/deb
rm -rf "$made"
mkdir -p "$made/man" "$made/completions"
"$isoslice" man --dir "$made/man"
for shell in bash zsh fish; do
    "$isoslice" completions "$shell" > "$made/completions/$shell"
done

cargo deb --no-build --locked "$@"
