#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# ModSLAM's one launcher. Every verb is a short function below, or a program that it calls. ./run.sh help
set -euo pipefail
shopt -s inherit_errexit  # a failure inside $(...) counts too
readonly CALLER=$PWD  # paths that a person types start there
cd "$(dirname "$(readlink -f "$0")")"
readonly HOUSE=$PWD
readonly BUILD=${MODSLAM_BUILD:-$HOUSE/build}
readonly BIN=$BUILD/bin
CONFIG=$HOUSE/config/modslam.toml
source procs/launch/setup.sh    # packages and build
source procs/launch/network.sh  # port, multicast route
source procs/launch/semantics.sh  # annotate, train; the bench of the semantic map
source procs/launch/run.sh      # one run: folder, processes under supervisor, results
source procs/launch/bench.sh    # bench NAME
source procs/launch/sanitize.sh # test --sanitize

help() {
  cat <<'TXT'
ModSLAM: 2D laser SLAM with a semantic map, as processes on an LCM bus.

  ./run.sh demo [--out DIR] [--set T.K=V]...  drive the simulated Apartment, map it, show what was found
  ./run.sh test [--verbose] [NAME]...         everything that must hold, or some suites of it
  ./run.sh test --sanitize address|thread|debug [LOG...]
                                              unit tests and offline runs, built with checks into a folder of their own
  ./run.sh live [--out DIR] [--url URL] [--only NAME,NAME]
                                              the same processes with the drivers of config/modslam.toml, until Ctrl-C;
                                              --url and --only: several machines share the work (docs/several-machines.md)
  ./run.sh replay LOG [--drive] [--speed S] [--out DIR] [--map DIR [--localize-only]]
                                              play an LCM log through the processes with lcm-logplayer;
                                              --drive: with our own player, which the page pauses, steps and slows;
                                              --map: go on with the graph of an earlier run on the bus;
                                              --localize-only: find the robot in it, from anywhere, and change nothing
  ./run.sh offline LOG --out DIR              the same in one program, as fast as the machine, same bytes every time
  ./run.sh import FILE OUT.lcm [--laser-x M --laser-y M --laser-yaw RAD]
                                              CARMEN .log/.clf (.gz, .xz) or MRPT .rawlog to an LCM log
  ./run.sh annotate MAP.yaml --out DIR        walls, rooms, doors, objects of a finished grid map: GeoJSON, SVG
  ./run.sh train semantics|thresholds|places [FOLDER]
                                              learn from labelled maps which openings part rooms and which thresholds fit best;
                                              which places look like rooms, corridors, doorways
  ./run.sh ask room X Y | route A to B | map  of the run that is going on: which room is there, which way leads from A to B (a place is
                                              "X Y", a room's name or its id), all rooms
  ./run.sh polish                             compare all scans of the run that is going on and refine all its poses together, as at its end
  ./run.sh export DIR [--format geotiff,dxf,svg,pgm] [--out DIR]
                                              the map of a run for other programs
  ./run.sh simulate OUT.lcm [--set T.K=V]...  a simulated log without the network
  ./run.sh evaluate ...                       scores: --relations, --truth, --semantic (evaluate --help)
  ./run.sh optimize FILE.g2o [--robust] [--method toro] [--out OUT.g2o] [--json OUT.json]
                                              a pose graph to its optimum, with a proof where there is one
  ./run.sh bench NAME                         graph, slam, semantics, viewer, bus, soak: measured anew, written to docs/benchmarks.md;
                                              peers DIR: MRPT's rbpf-slam and icp-slam on a run's log, drawn in its report
  ./run.sh report DIR...                      make the results in a run's folder from its run.lcm again;
                                              of several: comparison.html, their errors, run times and parameters
  ./run.sh record OUT.lcm                     lcm-logger on the run that is going on, until Ctrl-C
  ./run.sh spy [--text]                       lcm-spy with our message types and views; --text: in this terminal
  ./run.sh view                               where the page of the run that is going on is
  ./run.sh status                             processes, restarts, rates, losses, latencies; exit code 1 when one is in trouble
  ./run.sh doctor                             what is wrong with this machine or the run, in plain words
  ./run.sh stop                               stop the run that is going on
  ./run.sh build                              install what is missing and build
All that start modules take --config FILE and --set table.key=value (repeatable). Results: logs/<run>/ or --out DIR.
TXT
}

demo() {
  parse_run_options demo --set simulator.speed=8 "$@"
  start_run "$(simulated_sources)"
  echo "The robot drives. Page: $(page_url)   Stop: Ctrl-C"
  wait_for_simulation
  end_run
}

live() {
  parse_run_options live "$@"
  start_run "$(live_sources)"
  echo "Running. Page: $(page_url)   Stop: Ctrl-C"
  wait "$SUPERVISOR_PID" || true
}

here() { [[ $1 == /* ]] && echo "$1" || echo "$CALLER/$1"; }

replay() {
  local log=${1:-}
  [[ -n $log && $log != --* ]] || die "replay: which log? ./run.sh replay LOG [--speed S] [--out DIR]"
  log=$(here "$log"); shift
  [[ -r $log ]] || die "replay: $log: there is no such file"
  local play=play_log
  [[ ${1:-} == --drive ]] && { play=drive_log; shift; }
  parse_run_options replay "$@"
  [[ $play != drive_log ]] || "$BIN/modslam-config" --config "$CONFIG" "${OVERRIDES[@]}" --set "player.speed=$SPEED" >/dev/null || exit 1
  [[ $(setting launch.loops) != true ]] || OVERRIDES+=(--set launch.lockstep=true)  # the speed of the player changes nothing
  check_log "$log"
  awk "BEGIN {exit !($SPEED > $MOST_UDP_SPEED)}" && BUS=tcp
  start_run ""
  echo "Replaying $log at $SPEED times real time. Page: $(page_url)   Stop: Ctrl-C"
  "$play" "$LOG"
  end_run
  return "$LOG_CODE"
}

offline() {
  local log=${1:-}
  [[ -n $log && $log != --* ]] || die "offline: which log? ./run.sh offline LOG --out DIR"
  log=$(here "$log"); shift
  parse_run_options offline "$@"
  local code=0
  "$BIN/modslam-offline" "$log" --out "$OUT" --config "$CONFIG" "${OVERRIDES[@]}" || code=$?
  ((code == 0 || code == 2)) || exit "$code"
  make_results "$OUT" || code=$?
  exit "$code"
}

import_log() { cd "$CALLER"; exec "$BIN/modslam-import" "$@"; }
simulate() {
  local log=${1:?simulate: which log shall be written?}; shift
  parse_options simulate "$@"
  exec "$BIN/modslam-simulate" "$(here "$log")" --config "$CONFIG" "${OVERRIDES[@]}"
}
optimize() { cd "$CALLER"; exec "$BIN/modslam-optimize" "$@"; }
export_map() { cd "$CALLER"; exec "$BIN/modslam-export" "$@"; }
evaluate() { cd "$CALLER"; exec "$BIN/modslam-evaluate" "$@"; }
report() {
  local folders=() folder
  for folder in "${@:?report: which folder?}"; do folders+=("$(here "$folder")"); done
  if ((${#folders[@]} == 1)); then make_results "${folders[0]}"; return; fi
  "$BIN/modslam-report" --compare "${folders[@]}" --out "$CALLER/comparison.html"
  echo "Written: $CALLER/comparison.html"
}
record() { attach; exec lcm-logger "$(here "${1:?record: which file?}")"; }
spy() {
  attach_or_default
  if [[ ${1:-} == --text ]]; then shift; exec "$BIN/modslam-text-spy" "$@"; fi
  exec procs/spy/spy.sh "$BUILD"
}
ask() { attach; exec "$BIN/modslam-ask" "$@"; }
polish() { attach; exec "$BIN/modslam-conduct" tell graph_optimizer polish; }
view() { attach; page_url; }
# shellcheck disable=SC2086
status() { attach; exec "$BIN/modslam-conduct" status --supervisor-log "$OUT/log/supervisord.log" $PROCESSES; }
# shellcheck disable=SC2086
doctor() {
  mkdir -p logs
  [[ -e $CURRENT ]] || exec "$BIN/modslam-doctor" --no-run --folder "$HOUSE/logs"
  attach
  exec "$BIN/modslam-doctor" --folder "$OUT" $PROCESSES
}
stop() { stop_current; }
run_tests() { exec python3 tests/run_all.py "$BUILD" "$@"; }

main() {
  local verb=${1:-help}; shift || true
  case $verb in
    help | -h | --help) help ;;
    stop) stop ;;
    build) ensure_built "${1:-all}" ;;
    test) if [[ ${1:-} == --sanitize ]]; then shift; sanitize "$@"; else ensure_built all; run_tests "$@"; fi ;;
    bench) bench "$@" ;;
    demo | live | replay | offline | simulate | annotate | train | evaluate | optimize | report | record | ask | spy | view | status | polish | doctor) ensure_built programs; "$verb" "$@" ;;
    import) ensure_built programs; import_log "$@" ;;
    export) ensure_built programs; export_map "$@" ;;
    *) echo "run.sh: '$verb' is no verb" >&2; help >&2; exit 2 ;;
  esac
}
main "$@"
