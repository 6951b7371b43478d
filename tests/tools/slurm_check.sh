#!/bin/sh
# Writes the Slurm scripts of a small sweep, submits them to the cluster that this machine belongs to, and compares what comes
# out, byte for byte, with one run of the whole sweep; then kills a chunk on its node and has it queued again. By hand: it needs
# a cluster. One node from Debian's packages (slurm-wlm, munge) will do; exports/gallery/sweep/README.md says how.
#
#   tests/tools/slurm_check.sh target/release/surefoot [FOLDER THAT THE NODES SEE]
set -eu
surefoot=$(CDPATH='' cd -- "$(dirname -- "$1")" && pwd -P)/$(basename -- "$1")
sinfo >/dev/null 2>&1 || { echo "skipped: no Slurm cluster here"; exit 0; }
work=$(mktemp -d "${2:-/tmp}/surefoot_slurm_XXXXXX")
trap 'rm -rf "$work"' EXIT
# Names that a shell would split or expand.
place="$work/it's a \$farm"
mkdir -p "$place"
cd "$place"

cat >shove.toml <<'TOML'
title = "shove"
duration = 3.0
[[push]]
start = 0.4
duration = 0.2
force = 200.0
toward = "left"
at = "chest"
TOML
cat >sweep.toml <<'TOML'
scenario = "shove.toml"
rigs = ["builtin"]
name = "{push.0.toward}_s{seed}"
[vary]
"push.0.toward" = ["left", "back", "front"]
seed = { from = 1, to = 9, count = 9 }
TOML

# Waits for a job to leave the queue, and for what depends on it.
wait_for() {
  for _ in $(seq 600); do
    [ -n "$(squeue --noheader --jobs="$1" 2>/dev/null)" ] || return 0
    sleep 0.5
  done
  squeue; echo "FAILED: job $1 did not end"; exit 1
}

"$surefoot" batch sweep.toml -o whole >/dev/null 2>&1
"$surefoot" batch sweep.toml -o farm --slurm scripts --chunk 4
./scripts/submit.sh | tee submitted.txt
merge=$(sed -n 's/^merge: *job //p' submitted.txt)
wait_for "$merge"
diff -r whole farm || { cat scripts/logs/*; echo "FAILED: the farm's files differ from those of one run"; exit 1; }
logs=$(find scripts/logs -name 'chunk_*.log' | wc -l)
[ "$logs" = 7 ] || { ls scripts/logs; echo "FAILED: 27 variations by four are 7 chunks, $logs ran"; exit 1; }
echo "sbatch: 27 clips in 7 chunks and a merge, the same bytes as one run"

# A chunk that is killed on its node and queued again, as Slurm does when a node goes down.
"$surefoot" batch sweep.toml -o again --slurm scripts_again --chunk 9 2>/dev/null
./scripts_again/submit.sh >submitted.txt
chunks=$(sed -n 's/^chunks: *job //p' submitted.txt)
merge=$(sed -n 's/^merge: *job //p' submitted.txt)
for _ in $(seq 100); do
  [ "$(find again -name '*.glb' 2>/dev/null | wc -l)" -lt 2 ] || break
  sleep 0.05
done
scontrol requeue "${chunks}_0" && requeued=yes || requeued=no
wait_for "$merge"
diff -r whole again || { cat scripts_again/logs/*; echo "FAILED: a requeued chunk left other bytes"; exit 1; }
echo "sbatch: a chunk was killed and queued again ($requeued): the same bytes"
