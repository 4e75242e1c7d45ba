# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: test --sanitize KIND [LOG...]. Builds with checks into a folder of its own; runs the unit tests and offline runs with them.

sanitize() {
  local kind=${1:-} options="-DCMAKE_BUILD_TYPE=Checked -DMODSLAM_WERROR=OFF" code=0  # the checks make compilers see things that are not there
  case $kind in
    address) options+=" -DMODSLAM_SANITIZE=address,undefined" ;;
    thread) options=-DMODSLAM_SANITIZE=thread ;;
    debug) options+=" -DCMAKE_CXX_FLAGS=-D_GLIBCXX_ASSERTIONS" ;;  # _GLIBCXX_DEBUG changes the vectors that Debian's libraries take
    *) die "test --sanitize: address (and undefined behaviour), thread or debug (the standard library's own checks)?" ;;
  esac
  shift
  export MODSLAM_BUILD=$BUILD-$kind MODSLAM_CMAKE_OPTIONS=$options
  export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
  ./run.sh build checked
  if [[ $kind == thread ]]; then
    "$MODSLAM_BUILD/bin/modslam-thread-tests" || code=1  # the viewer alone has threads
  else
    "$MODSLAM_BUILD/bin/modslam-tests" || code=1
    sanitized_offline "$@" || code=1
  fi
  ((code == 0)) && echo "ok: nothing found with --sanitize $kind"
  return "$code"
}

# The simulated demo and the logs that were named.
sanitized_offline() {
  local log code=0 made=$MODSLAM_BUILD/demo.lcm
  [[ -r $made ]] || "$MODSLAM_BUILD/bin/modslam-simulate" "$made" --config "$CONFIG"
  for log in "$made" "$@"; do
    echo "offline, $log:"
    "$MODSLAM_BUILD/bin/modslam-offline" "$log" --out "$MODSLAM_BUILD/offline" --config "$CONFIG" || code=1
  done
  return "$code"
}
