# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: installs missing Debian packages, configures and builds when something changed. Says one line when it starts and one
# when it is done; the tools' own words go to files in the build folder and are shown, cut to what matters, only when something failed.

die() { echo "run.sh: $*" >&2; exit 1; }

# quietly FILE COMMAND...: runs the command with its words in FILE; when it fails, shows the last of them and ends.
quietly() {
  local words=$1; shift
  "$@" >"$words" 2>&1 || { tail -n 20 "$words" >&2; die "failed: $*  (all it said: $words)"; }
}

# $@: files that list packages.
missing_packages() {
  local wanted have
  wanted=$(sed '/^#/d;/^$/d' "$@" | sort -u)
  # shellcheck disable=SC2086  # dpkg-query fails when it does not know one of them: that one is missing
  have=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $wanted 2>/dev/null || true)
  comm -23 <(echo "$wanted") <(awk '$2 == "installed" {print $1}' <<<"$have" | sort -u)
}

install_packages() {
  local missing as_root=()
  missing=$(missing_packages "$@" | tr '\n' ' ')
  [[ -n $missing ]] || return 0
  command -v apt-get >/dev/null || die "needs Debian packages: $missing"
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "as root, type: apt-get install -y --no-install-recommends $missing"
    as_root=(sudo)
  fi
  echo "Installing: $missing" >&2
  as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0)
  quietly "$BUILD/install.log" "${as_root[@]}" update
  # shellcheck disable=SC2086
  quietly "$BUILD/install.log" "${as_root[@]}" install -y --no-install-recommends $missing
}

# The first file that is newer than the stamp; nothing when there is none.
changed_since() {
  find run.sh CMakeLists.txt config/debian-packages*.txt lcmtypes common procs viewer tests -newer "$1" \( -type f -o -type d \) \
    -not -name '*.pyc' -not -name '__pycache__' -print -quit
}

# With a terminal the count of what is built stands in one line that is written over; without one, nothing but errors.
run_ninja() {
  local code=0
  if [[ -t 2 ]]; then
    NINJA_STATUS='building [%f/%t] ' ninja -C "$BUILD" "$1" >&2 || code=$?
  else
    ninja --quiet -C "$BUILD" "$1" >"$BUILD/build.log" 2>&1 || code=$?
    ((code == 0)) || grep -E -A 4 'error:|undefined reference|ninja:' "$BUILD/build.log" | head -n 40 >&2
  fi
  ((code == 0)) || die "the build failed"
}

# ensure_built programs|all: does nothing, fast, when nothing changed since the last time.
ensure_built() {
  local stamp=$BUILD/.built-$1 options="${MODSLAM_CMAKE_OPTIONS:-}" changed packages=(config/debian-packages.txt)
  mkdir -p "$BUILD" || die "$BUILD: cannot be made"
  if [[ -e $stamp && $(<"$stamp") == "$options" ]]; then
    changed=$(changed_since "$stamp")
    [[ -n $changed ]] || return 0
  fi
  [[ $1 != all ]] || packages+=(config/debian-packages-test.txt)
  install_packages "${packages[@]}"
  (
    flock 9  # two first uses at once: the second waits
    echo "$options" >"$stamp.new"
    [[ -e $BUILD/build.ninja ]] || echo "Building ($1); the first time takes a few minutes" >&2
    # shellcheck disable=SC2086
    quietly "$BUILD/configure.log" cmake -G Ninja -Werror=dev -S . -B "$BUILD" $options
    run_ninja "$1"
    mv "$stamp.new" "$stamp"
    echo "Built ($1) in $SECONDS s" >&2
  ) 9>"$BUILD/.lock"
}
