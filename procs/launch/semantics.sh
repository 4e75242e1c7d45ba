# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: what the semantic map needs beside runs. Labelled data is not part of the repository.

semantic_data() {
  local folder=${MODSLAM_SHARED:-$HOUSE/../shared}/data/semantic
  [[ -z ${1:-} || $1 == --* ]] || folder=$(here "$1")
  echo "$folder"
}

annotate() {
  local map=${1:-}
  [[ -n $map && $map != --* ]] || die "annotate: which map? ./run.sh annotate MAP.yaml --out DIR"
  map=$(here "$map"); shift
  parse_run_options annotate "$@"
  exec "$BIN/modslam-annotate" "$map" --out "$OUT" --config "$CONFIG" "${OVERRIDES[@]}"
}

# [FOLDER] with maps/, plans/, robot_maps/: what is missing is left out. Tours of config/worlds are always driven.
bench_semantics() {
  install_packages config/debian-packages-semantics.txt
  ensure_built semantics-bench
  /usr/bin/python3 tests/bench/semantics/bench.py "$BUILD" "$(semantic_data "${1:-}")" logs/bench/semantics
  write_section semantics logs/bench/semantics/semantics.md
}

# [FOLDER] as for the bench, which must have run: it drives the tours that are learned from.
train_semantics() {
  install_packages config/debian-packages-semantics.txt
  [[ -f logs/bench/semantics/semantics.json ]] || bench_semantics "$@"
  /usr/bin/python3 tests/bench/semantics/train_openings.py "$BUILD" "$(semantic_data "${1:-}")" logs/bench/semantics --held-out
  ensure_built programs
  train_thresholds "$@"
}

# [FOLDER] with plans/; worlds of the repository are always driven. The model goes into config/.
train_places() {
  install_packages config/debian-packages-semantics.txt
  /usr/bin/python3 tests/bench/semantics/places.py "$BUILD" "$(semantic_data "${1:-}")" logs/train/places --model config/places.yml
}

# [FOLDER] as for training: each building is scored by classifiers that never saw it.
bench_places() {
  install_packages config/debian-packages-semantics.txt
  /usr/bin/python3 tests/bench/semantics/places.py "$BUILD" "$(semantic_data "${1:-}")" logs/bench/places
  write_section places logs/bench/places/places.md
}

# [FOLDER] as for the bench of semantics, which must have run. Resumable; MODSLAM_SSH=":,other-machine" spreads it (GNU parallel's sshlogin).
train_thresholds() {
  install_packages config/debian-packages-semantics.txt
  [[ -f logs/bench/semantics/semantics.json ]] || bench_semantics "${1:-}"
  /usr/bin/python3 tests/bench/semantics/search.py "$BUILD" "$(semantic_data "${1:-}")" logs/bench/semantics --out logs/train/thresholds
}

train() {
  local name=${1:-}
  declare -F "train_$name" >/dev/null || die "train: what? ./run.sh train semantics|thresholds|places [FOLDER]"
  shift
  "train_$name" "$@"
}
