#!/usr/bin/env bash
# Slices a part on several machines over ssh, with GNU parallel.
#
#     contrib/parallel/slice.sh HOSTS PARTS OUTPUT MODEL [OPTION]...
#
# HOSTS   machines as parallel's --sshlogin takes them: 2/ada,4/grace for 2
#         ranges at a time on ada and 4 on grace; localhost is this machine
# PARTS   greatest number of ranges
# OUTPUT  the file to write, .gcode or .bgcode
# OPTION  options of isoslice for the model, its place and its settings
#
# isoslice has to be on each machine, of the same version, and so has rsync, which
# parallel copies with. The model is copied there, and the files of the ranges come
# back. A range that fails, or whose machine goes away, is tried on another one; what
# it had written stays there, in ~/isoslice-HOST-NUMBER. What the model reads besides,
# as settings with --config, is named with FILES="a.toml b.toml" to be copied, too.
set -euo pipefail
[ $# -ge 4 ] || { sed -n '2,18s/^# \{0,1\}//p' "$0" >&2; exit 2; }
hosts=$1 parts=$2 output=$3 model=$4
shift 3
kind=${output##*.}
isoslice=${ISOSLICE:-isoslice}

work=$(mktemp -d)
# Files of ranges come back into this folder, under names of this run alone.
own=isoslice-$(hostname)-$$
trap 'rm -rf "$work"; rm -f "$own".*."$kind"' EXIT
files=()
for file in "$model" ${FILES:-}; do
    [ ! -f "$file" ] || files+=(--basefile "$file")
done
printf -v arguments '%q ' "$@"
"$isoslice" split --parts "$parts" "$@" > "$work/ranges"
parallel --sshlogin "$hosts" --workdir "$own" "${files[@]}" \
    --retries 3 --halt soon,fail=1 --joblog "$output.joblog" \
    --return "$own.{#}.$kind" --cleanup \
    "$isoslice -qq slice $arguments --layers {} --threads 1 -o $own.{#}.$kind" \
    :::: "$work/ranges"
count=$(wc -l < "$work/ranges")
returned=()
for ((k = 1; k <= count; k++)); do returned+=("$own.$k.$kind"); done
"$isoslice" join "${returned[@]}" -o "$output"
