#!/usr/bin/env bash
# The studio as a real window, on a display without a screen (Xvfb) and a software renderer: it starts, plays, takes keys, keeps unsaved
# work before it is killed, and ends in order. Usage: studio_check.sh PROGRAM OUT_FOLDER. Needs Xvfb, xdotool and ImageMagick.
set -euo pipefail
program="$(realpath "$1")"
out="$2"
mkdir -p "$out"
for tool in Xvfb xdotool import identify; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 0; }
done

home="$(mktemp -d)"
# The server picks a display that is free, and writes its number when it takes clients. `-noreset`: without it, the server starts over when
# its last client leaves, as a killed studio does, and refuses whoever comes meanwhile.
Xvfb -displayfd 3 -noreset -screen 0 1280x800x24 3>"$home/display" >"$home/server" 2>&1 &
server=$!
studio=""
trap 'kill $studio $server 2>/dev/null || true; rm -rf "$home"' EXIT
for _ in $(seq 100); do [ -s "$home/display" ] && break; sleep 0.1; done
[ -s "$home/display" ] || { echo "FAILED: Xvfb does not start" >&2; exit 1; }
export DISPLAY=":$(cat "$home/display")" HOME="$home" XDG_DATA_HOME="$home/data" XDG_RUNTIME_DIR="$home"
unset WAYLAND_DISPLAY
fail() { echo "FAILED: $*" >&2; kill -0 $server || cat "$home/server" >&2; import -window root "$out/failed.png" || true; exit 1; }

# Starts it and waits for its window.
start() {
  "$program" studio "$@" >"$home/out" 2>"$home/err" &
  studio=$!
  for _ in $(seq 300); do
    window="$(xdotool search --onlyvisible --name Surefoot 2>/dev/null | head -1)" && [ -n "$window" ] && break
    kill -0 $studio 2>/dev/null || { cat "$home/err" >&2; fail "it ended before its window was there"; }
    sleep 0.1
  done
  [ -n "${window:-}" ] || fail "no window within 30 s"
  xdotool windowfocus --sync "$window" || true
}

ends() {
  for _ in $(seq 100); do kill -0 $studio 2>/dev/null || break; sleep 0.1; done
  kill -0 $studio 2>/dev/null && fail "$1: it does not end"
  wait $studio || fail "$1: exit $?"
  studio=""
}

echo "times, as the program measures them itself:"
"$program" studio --measure 8 | tee "$out/times.json"
python3 - "$out/times.json" <<'PY'
import json, sys
times = json.load(open(sys.argv[1]))
assert times["edits"] >= 3 and times["frames"] > 20, times
PY

start
sleep 4
xdotool key --window "$window" p
sleep 3
import -window root "$out/window.png"
colours="$(identify -format %k "$out/window.png")"
[ "$colours" -gt 2000 ] || fail "the window shows only $colours colours"
xdotool key --window "$window" ctrl+z
sleep 2
xdotool key --window "$window" ctrl+q
ends "it was told to quit"
echo "played, edited, undid, quit: $colours colours, $out/window.png"

# Killed at random moments: what was done two seconds before is kept.
for round in 1 2 3; do
  rm -rf "$home/data"
  start
  sleep 2
  end=$((SECONDS + 3 + RANDOM % 3))
  done_at=()
  while [ $SECONDS -lt $end ]; do
    xdotool key --window "$window" p
    done_at+=("$(date +%s%N)")
    sleep 0.2
  done
  killed="$(date +%s%N)"
  kill -9 $studio
  wait $studio 2>/dev/null || true
  studio=""
  before=0
  for at in "${done_at[@]}"; do [ $((killed - at)) -gt 2000000000 ] && before=$((before + 1)); done
  kept="$(cat "$home"/data/surefoot/studio/unsaved/session-*.json 2>/dev/null | grep -o '\[\[push\]\]' | wc -l)"
  # The example has one push of its own.
  [ "$kept" -ge $((before + 1)) ] || fail "round $round: killed after ${#done_at[@]} pushes, $before of them 2 s before; $kept kept"
  echo "killed after ${#done_at[@]} pushes, $before of them 2 s before: $((kept - 1)) kept"
done
