#!/usr/bin/env bash
# Slices a part on a Slurm cluster: a job array with a task for each range of
# layers, and a job after it that joins the files.
#
#     contrib/slurm/slice.sh PARTS OUTPUT MODEL [OPTION]...
#
# PARTS   greatest number of tasks
# OUTPUT  the file to write, .gcode or .bgcode
# OPTION  options of isoslice for the model, its place and its settings
#
# The folder that it is started in must be the same on all nodes. SBATCH_…
# variables (man sbatch) choose a partition, an account or a time limit; CPUS is
# the number of processors of a task (1), MEMORY its memory (1G).
#
# A task that is killed, up to 3 times, or whose node fails, is begun again: its
# file is there as a whole or not at all. The number of the joining job is printed.
set -euo pipefail
[ $# -ge 3 ] || { sed -n '2,16s/^# \{0,1\}//p' "$0" >&2; exit 2; }
parts=$1
output=$(realpath "$2")
shift 2
cpus=${CPUS:-1}
memory=${MEMORY:-1G}
isoslice=$(command -v "${ISOSLICE:-isoslice}")

work=$(mktemp -d "$PWD/isoslice-XXXXXX")
printf '%s\0' "$@" > "$work/arguments"
"$isoslice" split --parts "$parts" "$@" > "$work/ranges"
count=$(wc -l < "$work/ranges")

cat > "$work/task" <<'TASK'
#!/usr/bin/env bash
set -euo pipefail
isoslice=$1 work=$2 kind=$3
range=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$work/ranges")
mapfile -d '' -t arguments < "$work/arguments"
code=0
"$isoslice" -qq slice "${arguments[@]}" --layers "$range" \
    --threads "$SLURM_CPUS_ON_NODE" --time-limit none \
    -o "$work/$SLURM_ARRAY_TASK_ID.$kind" || code=$?
# Slurm begins again what has lost its node, not what a signal has ended.
if [ "$code" -gt 128 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ]; then
    echo "ended by signal $((code - 128)); to be begun again"
    scontrol requeue "$SLURM_JOB_ID"
    sleep 60
fi
exit "$code"
TASK

cat > "$work/join" <<'JOIN'
#!/usr/bin/env bash
set -euo pipefail
isoslice=$1 work=$2 kind=$3 output=$4
"$isoslice" join "$work"/*."$kind" --time-limit none -o "$output"
rm -r "$work"
JOIN

kind=${output##*.}
array=$(sbatch --parsable --requeue --array="1-$count" \
    --cpus-per-task="$cpus" --mem="$memory" \
    --job-name="slice" --output="$work/%a.log" --open-mode=append \
    "$work/task" "$isoslice" "$work" "$kind")
join=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes \
    --mem="$memory" --job-name="join" --output="$output.log" \
    "$work/join" "$isoslice" "$work" "$kind" "$output")
echo "$count tasks of job $array write to $work; job $join joins them" >&2
echo "$join"
