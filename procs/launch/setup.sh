# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: installs missing Debian packages, configures and builds when something changed.

die() { echo "run.sh: $*" >&2; exit 1; }

# $@: files that list packages.
missing_packages() {
  local wanted have
  wanted=$(grep -hv "^#" "$@")
  # shellcheck disable=SC2086
  have=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $wanted 2>/dev/null | awk '$2 == "installed" {print $1}')
  comm -23 <(sort <<<"$wanted") <(sort <<<"$have")
}

install_packages() {
  local missing as_root=()
  missing=$(missing_packages "$@")
  [[ -n $missing ]] || return 0
  command -v apt-get >/dev/null || die "needs Debian packages: $(tr '\n' ' ' <<<"$missing")"
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "as root, type: apt-get install -y --no-install-recommends $(tr '\n' ' ' <<<"$missing")"
    as_root=(sudo)
  fi
  echo "Installing: $(tr '\n' ' ' <<<"$missing")" >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq >&2
  # shellcheck disable=SC2086
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
}

# ensure_built programs|all: does nothing, fast, when nothing changed since the last time.
ensure_built() {
  local stamp=$BUILD/.built-$1
  if [[ -e $stamp && -z $(find CMakeLists.txt config/debian-packages.txt lcmtypes common procs viewer tests \
      -newer "$stamp" \( -type f -o -type d \) -not -name '*.pyc' -not -name '__pycache__' -print -quit) ]]; then
    return 0
  fi
  install_packages config/debian-packages.txt $([[ $1 == all ]] && echo config/debian-packages-test.txt)
  mkdir -p "$BUILD"
  (
    flock 9  # two first uses at once: the second waits
    touch "$stamp.new"
    if [[ ! -e $BUILD/build.ninja ]]; then
      cmake -G Ninja -S . -B "$BUILD" ${MODSLAM_CMAKE_OPTIONS:-} >"$BUILD/configure.log" 2>&1 ||
        { tail -20 "$BUILD/configure.log" >&2; die "cmake failed: $BUILD/configure.log"; }
    fi
    if [[ -t 2 ]]; then
      NINJA_STATUS='building [%f/%t] ' ninja -C "$BUILD" "$1" >&2 || die "the build failed"
    else
      echo "Building ($1); the first time takes a few minutes" >&2
      ninja -C "$BUILD" "$1" >"$BUILD/build.log" 2>&1 || { tail -40 "$BUILD/build.log" >&2; die "the build failed: $BUILD/build.log"; }
    fi
    mv "$stamp.new" "$stamp"
  ) 9>"$BUILD/.lock"
}
