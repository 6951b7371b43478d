#!/bin/sh
# Writes the Open Job Description bundle of a small sweep and has the specification's own tool check and run it: chunks first,
# then the merge. What comes out must be, byte for byte, what one run of the whole sweep makes. Then bundles of awkward sizes
# are checked, up to ten thousand tasks.
#
#   tests/tools/openjd_check.sh target/release/surefoot [FOLDER OF A PYTHON ENVIRONMENT]
#
# The environment is made where it lacks, with openjd-cli from PyPI.
set -eu
surefoot=$(CDPATH='' cd -- "$(dirname -- "$1")" && pwd -P)/$(basename -- "$1")
venv=${2:-${XDG_CACHE_HOME:-$HOME/.cache}/surefoot-ci/openjd}
version=0.8.0
if [ ! -x "$venv/bin/openjd" ]; then
  command -v python3 >/dev/null || { echo "skipped: openjd needs python3"; exit 0; }
  python3 -m venv "$venv" && "$venv/bin/pip" install --quiet "openjd-cli==$version" || { echo "skipped: no openjd-cli"; exit 0; }
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Names that a shell would split or expand.
place="$work/it's a \$farm"
mkdir -p "$place"
cd "$place"

cat >shove.toml <<'TOML'
title = "shove"
duration = 2.0
[[push]]
start = 0.4
duration = 0.2
force = 200.0
toward = "left"
at = "chest"
TOML
sweep() { # file, seeds
  cat >"$1" <<TOML
scenario = "shove.toml"
rigs = ["builtin"]
name = "{push.0.toward}_s{seed}"
[vary]
"push.0.toward" = ["left", "back", "front"]
seed = { from = 1, to = $2, count = $2 }
TOML
}

sweep sweep.toml 3
"$surefoot" batch sweep.toml -o whole >/dev/null 2>&1
"$surefoot" batch sweep.toml -o farm --openjd bundle --chunk 4
"$venv/bin/openjd" check bundle/template.json
"$venv/bin/openjd" summary bundle/template.json -p file://bundle/openjd_parameters.json >summary.txt
grep -q "Total tasks: *4" summary.txt || { cat summary.txt; echo "FAILED: nine variations by four are three chunks and a merge"; exit 1; }
"$venv/bin/openjd" run bundle/template.json --step Merge --run-dependencies \
  -p file://bundle/openjd_parameters.json -p "Surefoot=$surefoot" >run.txt 2>&1 || { cat run.txt; echo "FAILED: openjd run"; exit 1; }
for numbers in "1 to 4" "5 to 8" "9 to 9"; do
  grep -q "chunk  *$numbers of 9" run.txt || { cat run.txt; echo "FAILED: no chunk of $numbers was run"; exit 1; }
done
diff -r whole farm || { echo "FAILED: the farm's files differ from those of one run"; exit 1; }
echo "openjd run: $(find farm -name '*.glb' | wc -l) clips in 3 chunks and a merge, the same bytes as one run"

# A chunk that dies half-way and is run again, and a chunk that two workers get.
"$surefoot" batch sweep.toml -o again --openjd bundle_again --chunk 4 2>/dev/null
chunk() {
  "$venv/bin/openjd" run bundle_again/template.json --step Chunks -tp "First=$1" -tp "Last=$2" \
    -p file://bundle_again/openjd_parameters.json -p "Surefoot=$surefoot" >"$3" 2>&1
}
"$surefoot" batch sweep.toml -o again --only 1-4 --jobs 1 >/dev/null 2>&1 &
dying=$!
sleep 0.4
kill -9 "$dying" 2>/dev/null || true
wait "$dying" 2>/dev/null || true
chunk 5 8 one.txt & one=$!
chunk 5 8 two.txt & two=$!
wait "$one" || { cat one.txt; echo "FAILED: the first of two workers on a chunk"; exit 1; }
wait "$two" || { cat two.txt; echo "FAILED: the second of two workers on a chunk"; exit 1; }
"$venv/bin/openjd" run bundle_again/template.json --step Merge --run-dependencies \
  -p file://bundle_again/openjd_parameters.json -p "Surefoot=$surefoot" >run.txt 2>&1 || { cat run.txt; exit 1; }
diff -r whole again || { echo "FAILED: a chunk that died or was run twice left other bytes"; exit 1; }
echo "openjd run: a chunk that was killed and one that two workers had leave the same bytes"

for size in 1 7 24 5000; do
  for seeds in 1 8 3333; do
    sweep many.toml "$seeds"
    "$surefoot" batch many.toml -o many --openjd "many_$size" --chunk "$size" 2>/dev/null
    "$venv/bin/openjd" check "many_$size/template.json" >/dev/null
    "$venv/bin/openjd" summary "many_$size/template.json" -p "file://many_$size/openjd_parameters.json" >summary.txt
    tasks=$(((3 * seeds + size - 1) / size + 1))
    grep -q "Total tasks: *$tasks" summary.txt || { cat summary.txt; echo "FAILED: $tasks tasks were wanted"; exit 1; }
  done
done
echo "openjd check: 1 to 10000 tasks"
