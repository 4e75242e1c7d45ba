# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: benchmarks. Each bench_NAME below writes logs/bench/NAME.json and its section of docs/benchmarks.md.

bench() {
  local name=${1:-}
  declare -F "bench_$name" >/dev/null || die "bench: which one? $(declare -F | sed -n 's/^declare -f bench_/ /p' | tr -d '\n')"
  shift
  install_packages config/debian-packages.txt config/debian-packages-bench.txt
  ensure_built programs
  mkdir -p logs/bench
  "bench_$name" "$@"
}

# $1: target. Configures again when the packages of benchmarks came after the first time.
build_bench() {
  ninja -C "$BUILD" -t query "$1" >/dev/null 2>&1 || quietly "$BUILD/configure.log" cmake "$BUILD"
  run_ninja "$1"
}

# $1: name, $2: file with the text. What it was measured with goes in front.
write_section() {
  {
    echo "Commit $(git rev-parse --short HEAD 2>/dev/null || echo unknown), $(nproc) cores of $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1)."
    echo
    cat "$2"
  } | python3 tests/bench/write_section.py docs/benchmarks.md "bench $1"
}

# [FOLDER] of g2o files. Sections are written for the default folder only.
bench_graph() {
  local default=${MODSLAM_SHARED:-$HOUSE/../shared}/data/graphs
  local folder=$default
  [[ -z ${1:-} ]] || folder=$(here "$1")
  [[ -d $folder ]] || { echo "bench graph: skipped, there is no folder $folder; name one with g2o files: ./run.sh bench graph FOLDER"; return 0; }
  build_bench graph-bench
  "$BIN/graph-bench" "$folder" --json logs/bench/graph.json --markdown logs/bench/graph.md
  echo "Written: logs/bench/graph.json, logs/bench/graph.md"
  [[ $folder != "$default" ]] || write_section graph logs/bench/graph.md
}

# [--seeds N]: public logs, the simulator, tours of floor plans, and whether the matcher's opinion of itself is right.
bench_slam() {
  install_packages config/debian-packages-semantics.txt  # tours of floor plans
  build_bench to_rawlog
  build_bench matcher-bench
  local code=0
  python3 tests/bench/slam_bench.py "$BUILD" "${MODSLAM_SHARED:-$HOUSE/../shared}/data/slam" --json logs/bench/slam.json --markdown logs/bench/slam.md "$@"
  "$BIN/matcher-bench" --json logs/bench/matcher.json --markdown logs/bench/matcher.md || code=$?
  { cat logs/bench/slam.md; printf '\n### The matcher about itself\n\n'; cat logs/bench/matcher.md; } >logs/bench/slam_all.md
  write_section slam logs/bench/slam_all.md
  echo "Written: logs/bench/slam.json, logs/bench/matcher.json, the section in docs/benchmarks.md"
  return "$code"
}

# MRPT's rbpf-slam and icp-slam on the log of a run; its report then shows them beside ours.
bench_peers() {
  local folder
  folder=$(here "${1:?bench peers: which folder of a run?}")
  build_bench to_rawlog
  python3 tests/bench/peers.py "$BIN" "$folder"
  make_results "$folder"
}

# The page and the viewer with ten thousand nodes and a thousand rooms.
bench_viewer() {
  command -v chromedriver >/dev/null || die "bench viewer: apt install chromium chromium-driver"
  build_bench publish_big
  python3 tests/viewer/viewer_bench.py "$BIN" --json logs/bench/viewer.json --markdown logs/bench/viewer.md
  write_section viewer logs/bench/viewer.md
}

# Latency at 40 Hz, CPU and memory at 10 Hz: a demo in real time each.
bench_bus() {
  { printf '| real time, all processes | |\n|---|---|\n'
    python3 tests/bench/bus.py "$BUILD" latency | grep '^|'
    python3 tests/bench/bus.py "$BUILD" load | grep '^|'
  } | tee logs/bench/bus.md
  write_section bus logs/bench/bus.md
}

# Ten passes of an hour over one drive, there and back: what each process needs after each pass.
bench_soak() { python3 tests/bench/soak.py "$BUILD"; }
