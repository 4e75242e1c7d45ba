# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: one run. Its folder, its processes under supervisor, its end and its results.

readonly CURRENT=${MODSLAM_CURRENT:-$HOUSE/logs/.current}  # names the folder of the run that is going on
OUT="" SPEED=1 OVERRIDES=() SUPERVISOR_PID="" WAITING_PID="" PLAYER_PID="" ENDED="" BUS=udp BUS_URL="" ONLY="" MAP="" LOCALIZE=""

# Options that all runs share; sets OUT, SPEED, CONFIG, OVERRIDES.
parse_options() {
  local kind=$1; shift
  while (($#)); do
    case $1 in
      --out) OUT=$(here "${2:?--out: which folder?}"); shift 2 ;;
      --speed) SPEED=${2:?--speed: how fast?}; shift 2 ;;
      --config) CONFIG=$(here "${2:?--config: which file?}"); shift 2 ;;
      --url) BUS_URL=${2:?--url: which LCM url?}; shift 2 ;;
      --map) MAP=$(here "${2:?--map: which folder of a run?}"); shift 2 ;;
      --localize-only) LOCALIZE=yes; shift ;;
      --only) ONLY=${2:?--only: which processes, with commas between?}; shift 2 ;;
      --set) OVERRIDES+=(--set "${2:?--set: table.key=value}"); shift 2 ;;
      *) die "$kind: unknown option '$1'" ;;
    esac
  done
  [[ $SPEED =~ ^[0-9]*[.]?[0-9]+$ && $SPEED == *[1-9]* ]] || die "--speed $SPEED: not a positive number"
}

parse_run_options() {
  parse_options "$@"
  "$BIN/modslam-config" --config "$CONFIG" "${OVERRIDES[@]}" >/dev/null || exit 1
  OUT=${OUT:-$HOUSE/logs/$(date +%Y-%m-%d_%H-%M-%S)_$1}
  if ! mkdir -p "$OUT" 2>/dev/null || [[ ! -w $OUT ]]; then die "$OUT: cannot be written"; fi
  OUT=$(readlink -f "$OUT")
}

setting() { "$BIN/modslam-config" --config "$CONFIG" "${OVERRIDES[@]}" --get "$1"; }

# shellcheck disable=SC2034  # run.sh reads LOG and LOG_CODE
# Sets LOG to what can be played: the log itself, or a copy without its damaged places, which the stock player would end at.
check_log() {
  local code=0
  LOG=$1 LOG_CODE=0
  "$BIN/modslam-check-log" "$1" --needs LASER --mended "$OUT/mended.lcm" || code=$?
  case $code in
    0) ;;
    2) LOG=$OUT/mended.lcm LOG_CODE=2 ;;
    *) exit 1 ;;
  esac
}

simulated_sources() { echo "simulator laser odometry ins"; }
live_sources() { echo "$([[ $(setting laser.driver) == simulated ]] && echo simulator) laser odometry ins"; }

estimator_process() {
  local estimator; estimator=$(setting launch.estimator)
  case $estimator in graph_optimizer | localizer) echo "$estimator" ;; *) echo yardstick ;; esac
}

# The processes between the sensors and the person, in the order in which data flows.
mapping_processes() {
  echo scan_matcher
  estimator_process
  [[ $(estimator_process) == graph_optimizer && $(setting launch.loops) == true ]] && echo loop_detector
  echo map_builder
  [[ $(setting launch.semantics) == true ]] && echo semantic_classifier
  [[ $(setting launch.viewer) == true ]] && echo viewer
  return 0
}

# start_run "SOURCE...": writes the run's supervisor file and starts everything; returns when all processes have spoken.
start_run() {
  local sources=$1
  rm -rf "$OUT"/run.lcm "$OUT/journal" "$OUT/log/supervisord.log"
  mkdir -p "$OUT/log"
  continue_map
  open_bus
  if [[ $(setting launch.viewer) == true ]]; then
    claim_page_port "$(setting viewer.port)"
    OVERRIDES+=(--set "viewer.port=$PAGE_PORT")
  fi
  SOCKET_DIR=$(mktemp -d "${TMPDIR:-/tmp}/modslam-XXXXXX")
  # The simulated world waits until everybody listens: it is started after the others.
  local first=(recorder) late=() name
  OVERRIDES+=(--set "recorder.path=$OUT/run.lcm" --set "journal.folder=$OUT/journal")
  for name in $sources; do [[ $name == simulator ]] && late+=("$name") || first+=("$name"); done
  for name in $(mapping_processes); do first+=("$name"); done
  choose_processes
  write_supervisor_file "${first[*]}" "${late[*]:-}" >"$OUT/supervisor.conf"
  trap 'on_signal 130' INT
  trap 'on_signal 143' TERM
  trap 'stop_run' EXIT
  setsid supervisord -c "$OUT/supervisor.conf" >"$OUT/log/supervisord.out" 2>&1 &
  SUPERVISOR_PID=$!
  mkdir -p "$(dirname "$CURRENT")"
  printf '%s=%q\n' OUT "$OUT" PORT "$PORT" URL "$LCM_DEFAULT_URL" PAGE_PORT "${PAGE_PORT:-}" SUPERVISOR_PID "$SUPERVISOR_PID" LAUNCHER_PID $$ PROCESSES "${first[*]} ${late[*]:-}" >"$CURRENT"
  cp "$CURRENT" "$OUT/run.env"
  wait_for "$BIN/modslam-conduct" --timeout 30 up "${first[@]}" ||
    { tail -n 5 "$OUT"/log/*.log >&2; die "not all processes started; their logs are in $OUT/log"; }
  for name in "${late[@]}"; do supervisor_control start "$name" >/dev/null; done
}

# --map DIR: goes on with the graph of an earlier run, whose odometry frame is still the robot's. That run's files stay as they are.
# --localize-only: nothing is added to it, and the robot may start anywhere in it.
continue_map() {
  [[ -n $MAP || -z $LOCALIZE ]] || die "--localize-only: in which map? --map DIR"
  [[ -n $MAP ]] || return 0
  [[ -r $MAP/journal/graph_optimizer.journal ]] || die "--map $MAP: holds no journal of a run on the bus (journal/graph_optimizer.journal)"
  [[ $MAP != "$OUT" ]] || die "--map and --out are the same folder: a run does not write over the map that it goes on with"
  if [[ -n $LOCALIZE ]]; then
    OVERRIDES+=(--set launch.estimator=localizer --set "launch.map=$MAP" --set launch.lockstep=false)
    return
  fi
  mkdir -p "$OUT/journal"
  cp "$MAP/journal/graph_optimizer.journal" "$OUT/journal/"
  [[ ! -r $MAP/journal/loop_detector.journal ]] || cp "$MAP/journal/loop_detector.journal" "$OUT/journal/"
}

# --only: this machine runs a part of the system, the others run elsewhere on the same network.
choose_processes() {
  [[ -n $ONLY ]] || return 0
  local name known=" ${first[*]} ${late[*]:-} " chosen=() chosen_late=()
  for name in ${ONLY//,/ }; do [[ $known == *" $name "* ]] || die "--only: there is no process '$name' here; known:$known"; done
  for name in "${first[@]}"; do [[ ,$ONLY, == *,$name,* ]] && chosen+=("$name"); done
  for name in "${late[@]}"; do [[ ,$ONLY, == *,$name,* ]] && chosen_late+=("$name"); done
  first=("${chosen[@]}") late=("${chosen_late[@]}")
}

# Behind a hub a process is silent as long as another one is slow: the watchdog is more patient there.
write_supervisor_file() {
  cat <<INI
[supervisord]
nodaemon=true
logfile=$OUT/log/supervisord.log
pidfile=$SOCKET_DIR/supervisord.pid
$( ((EUID == 0)) && echo user=root )
[unix_http_server]
file=$SOCKET_DIR/supervisor.sock
[supervisorctl]
serverurl=unix://$SOCKET_DIR/supervisor.sock
[rpcinterface:supervisor]
supervisor.rpcinterface_factory = supervisor.rpcinterface:make_main_rpcinterface
[eventlistener:watchdog]
command="$BIN/modslam-watchdog" --supervisor "$SOCKET_DIR/supervisor.sock" --patience $([[ $BUS == udp ]] && echo 5 || echo 60)
events=PROCESS_STATE
buffer_size=100
priority=1
stdout_logfile=NONE
stderr_logfile=$OUT/log/watchdog.log
INI
  [[ $BUS == udp ]] || program hub 0 true "java -Xmx256m -cp $BUILD/modslam-hub.jar:/usr/share/java/lcm.jar lcm.lcm.LoopbackHub $PORT"
  local name priority=10  # supervisor starts in this order and stops in the other
  for name in $1; do program "$name" $((priority++)) true "$(command_of "$name")"; done
  for name in $2; do program "$name" $((priority++)) false "$(command_of "$name")"; done
}

command_of() {
  local words=("$BIN/modslam-${1//_/-}" --config "$CONFIG" "${OVERRIDES[@]}")
  printf '"%s" ' "${words[@]//\"/\\\"}"
}

program() {  # name priority autostart command
  cat <<INI
[program:$1]
command=${4//%/%%}
directory=$HOUSE
priority=$2
autostart=$3
autorestart=true
startsecs=0
startretries=20
stopsignal=TERM
stopwaitsecs=5
redirect_stderr=true
stdout_logfile=$OUT/log/$1.log
stdout_logfile_maxbytes=10MB
stdout_logfile_backups=1
INI
}

supervisor_control() { supervisorctl -c "$OUT/supervisor.conf" "$@"; }

page_url() { [[ -n ${PAGE_PORT:-} ]] && echo "http://127.0.0.1:$PAGE_PORT/" || echo "(no viewer)"; }

# Runs a command so that a signal to this script is answered at once, and not when the command ends.
wait_for() {
  local code=0
  "$@" &
  WAITING_PID=$!
  wait "$WAITING_PID" || code=$?
  WAITING_PID=""
  return "$code"
}

wait_for_simulation() {
  local name
  until wait_for "$BIN/modslam-conduct" --timeout 2 ended simulator; do
    kill -0 "$SUPERVISOR_PID" 2>/dev/null || die "the run was stopped"
    for name in simulator $(mapping_processes); do
      (($(grep -cE "exited: $name \(exit status [1-9]" "$OUT/log/supervisord.log") < 3)) ||
        die "$name cannot run: $(tail -n 1 "$OUT/log/$name.log")"
      supervisor_control status "$name" | grep -Eq 'RUNNING|STARTING|BACKOFF|EXITED' || die "$name does not run; see $OUT/log/$name.log"
    done
  done
}

play_log() {
  wait_for lcm-logplayer -s "$SPEED" -e 'LASER|ODOMETRY|INS|SENSOR_INFO|GROUND_TRUTH|SIM_INFO' "$1" >"$OUT/log/logplayer.log" 2>&1 ||
    die "lcm-logplayer failed; see $OUT/log/logplayer.log"
}

# Plays a log with a player that the page can drive, until it is at the log's end.
drive_log() {
  "$BIN/modslam-player" --config "$CONFIG" "${OVERRIDES[@]}" --set "player.log=$1" --set "player.speed=$SPEED" >"$OUT/log/player.log" 2>&1 &
  PLAYER_PID=$!
  until wait_for "$BIN/modslam-conduct" --timeout 2 ended player 2>>"$OUT/log/conduct.log"; do
    kill -0 "$PLAYER_PID" 2>/dev/null || die "the player ended; see $OUT/log/player.log"
  done
  stop_player
}

# The input has ended: let every process settle in the order in which data flows, stop all, make the results.
end_run() {
  local order=(scan_matcher "$(estimator_process)") name
  for name in $(mapping_processes); do
    case $name in
      loop_detector) order+=(loop_detector "$(estimator_process)") ;;
      map_builder | semantic_classifier) order+=("$name") ;;
    esac
  done
  local drain=()
  [[ $BUS == udp ]] || drain=(--drain)
  wait_for "$BIN/modslam-conduct" --timeout 60 settle "${drain[@]}" "${order[@]}" recorder || echo "run.sh: not every process settled; the result may lack its last part" >&2
  "$BIN/modslam-conduct" status --supervisor-log "$OUT/log/supervisord.log" >"$OUT/status.txt" 2>/dev/null || true
  stop_run
  ENDED=yes
  say_restarts
  make_results "$OUT"
}

# A process that died was started again; that is no secret.
say_restarts() {
  sed -n 's/.*exited: \([a-z_]*\) (\(.*\); not expected)/\1 \2/p' "$OUT/log/supervisord.log" 2>/dev/null | sort | uniq -c |
    while read -r times name how; do
      echo "run.sh: $name ended by itself ($how), $times times, and was started again; its log: $OUT/log/$name.log" >&2
    done
}

on_signal() {  # exit code
  trap '' INT TERM
  echo >&2
  stop_run
  trap - INT TERM
  # A run that was cut short still has its log; whoever wants results from it gets them.
  if [[ -z $ENDED && -s $OUT/run.lcm ]]; then
    echo "Stopped. The log is $OUT/run.lcm; making what results it gives." >&2
    make_results "$OUT" || true
  fi
  exit "$1"
}

stop_run() {
  trap - EXIT
  [[ -z $WAITING_PID ]] || kill "$WAITING_PID" 2>/dev/null || true
  stop_player
  is_program "$SUPERVISOR_PID" supervisord && kill -TERM "$SUPERVISOR_PID"
  [[ -z $SUPERVISOR_PID ]] || wait "$SUPERVISOR_PID" 2>/dev/null || true
  SUPERVISOR_PID=""
  [[ -n ${SOCKET_DIR:-} ]] && rm -rf "$SOCKET_DIR"
  rm -f "$OUT/mended.lcm"
  [[ -e $CURRENT ]] && grep -qF "OUT=$(printf '%q' "$OUT")" "$CURRENT" && rm -f "$CURRENT"
  return 0
}

is_program() { [[ -n $1 ]] && tr '\0' ' ' 2>/dev/null <"/proc/$1/cmdline" | grep -q "$2"; }  # pid, part of its command

# The world of a simulated run stands in its log; others have none.
make_results() {
  local dir=$1 truth=() world code=0
  world=$("$BIN/modslam-report" --world-of "$dir" 2>/dev/null) || world=""
  if [[ -n $world && -e $HOUSE/config/worlds/$world ]]; then
    if "$BIN/modslam-world-truth" "$HOUSE/config/worlds/$world" "$dir/truth.geojson"; then
      truth=(--world-truth "$dir/truth.geojson")
    else
      rm -f "$dir/truth.geojson"
    fi
  fi
  "$BIN/modslam-report" "$dir" "${truth[@]}" || code=$?
  make_pngs "$dir"
  "$BIN/modslam-report" --table "$dir" || true
  return "$code"
}

stop_player() {
  [[ -z $PLAYER_PID ]] || kill "$PLAYER_PID" 2>/dev/null || true
  PLAYER_PID=""
}

# Every figure of a run as PNG beside its SVG.
make_pngs() {
  local svg
  command -v rsvg-convert >/dev/null || return 0
  for svg in "$1"/figures/*.svg; do [[ ! -e $svg ]] || rsvg-convert -z 2 "$svg" -o "${svg%.svg}.png" || true; done
}

attach() {
  [[ -e $CURRENT ]] || die "no run is going on"
  # shellcheck disable=SC1090
  source "$CURRENT"
  export LCM_DEFAULT_URL=$URL
}

attach_or_default() {
  if [[ -e $CURRENT ]]; then attach; else export LCM_DEFAULT_URL=${LCM_DEFAULT_URL:-$(url_of_port 7667)}; fi
}

stop_current() {
  [[ -e $CURRENT ]] || { echo "no run is going on"; return 0; }
  # shellcheck disable=SC1090
  source "$CURRENT"
  # The launcher ends its run and makes the results; when it is gone itself, the processes are asked.
  local pid=$LAUNCHER_PID program=run.sh
  is_program "$pid" "$program" || pid=$SUPERVISOR_PID program=supervisord
  ! is_program "$pid" "$program" || kill -TERM "$pid"
  while is_program "$pid" "$program"; do sleep 0.1; done
  rm -f "$CURRENT"
  echo "stopped; log and results: $OUT"
}
