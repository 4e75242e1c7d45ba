# shellcheck shell=bash
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: an own port for each run, and a multicast route on loopback where there is none.

readonly GROUP=239.255.76.67  # runs are told apart by port: LCM 1.3.1 hears every group on its port

readonly MOST_UDP_SPEED=8  # times real time; faster players fill sockets faster than processes empty them

url_of_port() { echo "udpm://$GROUP:$1?ttl=0&recv_buf_size=2097152"; }

# claim udp|tcp NUMBER: whether the port is free, and from now on this run's. The lock is held by the run's shell and its processes, so
# two runs that start at the same moment do not choose the same port.
claim() {
  local folder=/tmp/.modslam-ports-$EUID lock  # one place on the machine, whatever TMPDIR says; the empty files stay
  mkdir -p "$folder"
  exec {lock}>"$folder/$1-$2"
  if flock -n "$lock" && [[ -z $(ss -Hln --"$1" "sport = :$2") ]]; then return 0; fi
  exec {lock}>&-
  return 1
}

# Sets PORT to a UDP port nobody is bound to. MODSLAM_PORT chooses it.
claim_bus_port() {
  if [[ -n ${MODSLAM_PORT:-} ]]; then
    PORT=$MODSLAM_PORT
    claim udp "$PORT" || die "port $PORT is in use by another run; choose another MODSLAM_PORT"
    return
  fi
  for _ in {1..50}; do
    PORT=$((20000 + (RANDOM * 32768 + RANDOM) % 10000))
    claim udp "$PORT" && return
  done
  die "found no free UDP port"
}

# Exports LCM_DEFAULT_URL for this run: multicast, or with BUS=tcp LCM's TCP hub on 127.0.0.1, which loses nothing at any speed but lets
# one process that hangs hold up all others: for replays only.
open_bus() {
  if [[ -n $BUS_URL ]]; then
    PORT=$(sed -n 's/.*:\([0-9]*\).*/\1/p' <<<"$BUS_URL")
    claim udp "$PORT" || die "port $PORT is in use by another run on this machine"
    export LCM_DEFAULT_URL=$BUS_URL
  elif [[ $BUS == udp ]]; then
    ensure_multicast
    claim_bus_port
    export LCM_DEFAULT_URL; LCM_DEFAULT_URL=$(url_of_port "$PORT")
  else
    PORT=$((20000 + RANDOM % 10000))
    until claim tcp "$PORT"; do PORT=$((PORT + 1)); done
    export LCM_DEFAULT_URL=tcpq://127.0.0.1:$PORT
  fi
}

# Sets PAGE_PORT to a TCP port of 127.0.0.1 for the viewer's page: the configured one, or the next that is free.
claim_page_port() {
  PAGE_PORT=$1
  until claim tcp "$PAGE_PORT"; do PAGE_PORT=$((PAGE_PORT + 1)); done
}

ensure_multicast() {
  ip route get "$GROUP" >/dev/null 2>&1 && return
  local cure="ip link set lo up && ip route add 224.0.0.0/4 dev lo"
  ((EUID == 0)) || die "this machine has no multicast route, which LCM needs. As root, type: $cure
(without root: unshare -rn sh -c '$cure && ./run.sh ...')"
  echo "No multicast route: making one on loopback ($cure)" >&2
  ip link set lo up
  ip route add 224.0.0.0/4 dev lo
}
