# Sourced by tests that need more than Rust, and leave themselves out where they
# cannot have it:
#
#     . tests/others.sh NAME VARIABLE [ISOSLICE]
#
# NAME is what is tested, in words. If VARIABLE=required is in the environment,
# it is an error to leave the test out. ISOSLICE is the program, by default
# target/release/isoslice. Defines `root` (the repository), `isoslice` (the
# program), and `skip WHY`.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isoslice=$(realpath "${3:-${CARGO_TARGET_DIR:-$root/target}/release/isoslice}")
tested=$1
required=${!2:-}

skip() {
    printf 'SKIPPED: %s: %s\n' "$tested" "$*"
    [ "$required" != required ] || exit 1
    exit 0
}

[ -x "$isoslice" ] || { echo "no $isoslice; build it first" >&2; exit 1; }
