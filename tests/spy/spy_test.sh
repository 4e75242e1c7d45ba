#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# spy_test.sh BUILD_DIR [PICTURE.png]: lcm-spy starts on a screen of its own, knows every message type of lcmtypes/, and
# opens a channel's fields on a double click. Exit 77: skipped, tools are missing.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
build=$1
picture=${2:-}

for tool in Xvfb xdotool import java; do
  command -v $tool >/dev/null || { echo "skipped: $tool is missing (apt: xvfb xdotool imagemagick default-jre)"; exit 77; }
done
[ -f "$build/modslam-types.jar" ] || { echo "skipped: no modslam-types.jar was built (apt: default-jdk-headless liblcm-java)"; exit 77; }
[ -f /usr/share/java/jchart2d.jar ] || { echo "skipped: apt install libjchart2d-java"; exit 77; }

work=$(mktemp -d)
pids=()
# shellcheck disable=SC2317  # the trap calls it
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  wait 2>/dev/null
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAIL $1"; cat "$work/spy.log" 2>/dev/null; exit 1; }

Xvfb -displayfd 3 -screen 0 1200x900x24 3>"$work/display" 2>/dev/null & pids+=($!)
for _ in $(seq 50); do [ -s "$work/display" ] && break; sleep 0.1; done
DISPLAY=:$(cat "$work/display")
export DISPLAY
export LCM_DEFAULT_URL="udpm://239.255.76.67:$((40000 + $$ % 20000))?ttl=0"

mkfifo "$work/orders"
"$build/bin/publish_sample" --url "$LCM_DEFAULT_URL" --speed 2 <"$work/orders" >/dev/null & pids+=($!)
exec 4>"$work/orders"  # held open: the sample plays on
"$root/procs/spy/spy.sh" "$build" >"$work/spy.log" 2>&1 & pids+=($!)

window=
for _ in $(seq 150); do
  window=$(xdotool search --name "LCM Spy" 2>/dev/null | head -1)
  [ -n "$window" ] && break
  kill -0 "${pids[2]}" 2>/dev/null || fail "spy ended at once"
  sleep 0.2
done
[ -n "$window" ] || fail "spy opened no window within 30 s"
echo "ok   spy opens its window"

types=$(find "$root/lcmtypes" -name "*.lcm" | wc -l)
for _ in $(seq 50); do grep -q "Found .* LCM types" "$work/spy.log" && break; sleep 0.1; done
found=$(sed -n 's/.*Found \([0-9]*\) LCM types.*/\1/p' "$work/spy.log")
[ "$found" = "$types" ] || fail "spy found '$found' message types, lcmtypes/ has $types"
echo "ok   spy knows all $types message types"

# Rows stand in the order of names, 16 pixels each.
channels=(GRAPH GROUND_TRUTH LASER LOOP MAP_TILE NODE POSE SEMANTIC_DOORS SEMANTIC_OBJECTS SEMANTIC_PLACES SEMANTIC_ROOMS SEMANTIC_WALLS SENSOR_INFO STATUS)
row_of() {
  local i
  for i in "${!channels[@]}"; do [ "${channels[i]}" != "$1" ] || echo $((31 + 16 * i)); done
}

xdotool windowmove "$window" 0 0 windowsize "$window" 1200 900 2>/dev/null
sleep 4
# $1: a window's name, $2 $3: where to move it.
move() {
  local id
  for _ in $(seq 50); do
    id=$(xdotool search --onlyvisible --name "^$1\$" 2>/dev/null | head -1)
    [ -n "$id" ] && { xdotool windowmove "$id" "$2" "$3"; return; }
    sleep 0.1
  done
  fail "no window '$1' was opened"
}
# $1: channel, $2: its view, $3 $4: where to move the view. Spy opens the fields at the same time.
open_views() {
  xdotool mousemove 100 "$(row_of "$1")" click --repeat 2 --delay 60 1
  move "$1" 810 420
  move "$2" "$3" "$4"
  sleep 0.6  # a further click would count as a third one
}
open_views GRAPH "Pose graph" 0 610
open_views SEMANTIC_ROOMS "Semantic map" 0 240
open_views POSE "POSE trace" 810 0
open_views LASER "LASER scan" 465 240
xdotool mousemove 100 "$(row_of GROUND_TRUTH)" click --repeat 2 --delay 60 1
move GROUND_TRUTH 700 420
echo "ok   a double click opens a channel's fields, and a view of scan, path, graph or semantic map"
if [ -n "$picture" ]; then
  sleep 3
  import -window root "$picture"
fi
grep -iE "exception|unrecognized" "$work/spy.log" && fail "spy complained"
exit 0
