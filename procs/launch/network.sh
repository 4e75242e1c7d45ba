# SPDX-License-Identifier: BSD-3-Clause
# Sourced by run.sh: an own port for each run, and a multicast route on loopback where there is none.

readonly GROUP=239.255.76.67  # runs are told apart by port: LCM 1.3.1 hears every group on its port

url_of_port() { echo "udpm://$GROUP:$1?ttl=0&recv_buf_size=2097152"; }

# A UDP port nobody is bound to. MODSLAM_PORT chooses it.
free_port() {
  if [[ -n ${MODSLAM_PORT:-} ]]; then
    port_is_free "$MODSLAM_PORT" || die "port $MODSLAM_PORT is in use by another run; choose another MODSLAM_PORT"
    echo "$MODSLAM_PORT"
    return
  fi
  local port try
  for try in {1..50}; do
    port=$((20000 + (RANDOM * 32768 + RANDOM) % 10000))
    port_is_free "$port" && { echo "$port"; return; }
  done
  die "found no free UDP port"
}

port_is_free() { [[ -z $(ss -Huln "sport = :$1") ]]; }

# A TCP port of 127.0.0.1 for the viewer's page; the configured one when it is free.
free_page_port() {
  local port=$1
  while [[ -n $(ss -Htln "sport = :$port") ]]; do port=$((port + 1)); done
  echo "$port"
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
