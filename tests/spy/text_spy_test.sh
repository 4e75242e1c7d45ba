#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# text_spy_test.sh BUILD_DIR: the terminal spy in tmux lists channels with their rates, decodes the chosen one's newest message, and leaves
# the terminal as it was. Exit 77: skipped, tmux is missing.
set -uo pipefail
build=$1
command -v tmux >/dev/null || { echo "skipped: tmux is missing (apt install tmux)"; exit 77; }
work=$(mktemp -d)
url="udpm://239.255.76.67:$((40000 + $$ % 20000))?ttl=0"
tmux() { command tmux -S "$work/socket" "$@"; }
# shellcheck disable=SC2317  # the trap calls it
finish() {
  tmux kill-server 2>/dev/null
  kill "$sample" 2>/dev/null
  wait 2>/dev/null
  rm -rf "$work"
}
trap finish EXIT
mkfifo "$work/orders"
"$build/bin/publish_sample" --url "$url" --speed 2 <"$work/orders" >/dev/null &
sample=$!
exec 4>"$work/orders"  # held open: the sample plays on

screen() { tmux capture-pane -p -t spy; }
until_seen() {  # pattern, seconds, sentence
  for _ in $(seq $(($2 * 10))); do
    if screen | grep -Eq -- "$1"; then echo "ok   $3"; return; fi
    sleep 0.1
  done
  screen
  echo "FAIL $3"
  exit 1
}

tmux new-session -d -s spy -x 110 -y 40 "'$build/bin/modslam-text-spy' --url '$url' --channel LASER; echo the end of it; sleep 20"
until_seen '^> LASER +[0-9]+ +(1[89]|2[01])\.[0-9]' 10 "a channel's rate is counted (20 scans a second)"
until_seen 'beams +361 from -3\.14' 3 "the chosen channel's newest message is decoded"
until_seen '^  POSE .* 0 +[0-9.]+$' 3 "a numbered stream says how many messages are missing"
tmux send-keys -t spy Down Down
until_seen '^> (MAP_TILE|NODE|LOOP|POSE)' 3 "arrow keys choose another channel"
tmux send-keys -t spy q
until_seen 'the end of it' 3 "q ends it"
if screen | grep -q 'newest message'; then echo "FAIL the terminal is as it was"; exit 1; fi
echo "ok   the terminal is as it was"
