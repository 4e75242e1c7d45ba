#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# spy.sh [BUILD_DIR]: lcm-spy with our messages. It listens at LCM_DEFAULT_URL, else at LCM's default with ttl 0.
#
# Debian 12's own lcm-spy gives Java 17 an option that it no longer knows and does not start. Our types stand on the
# class path proper: named in CLASSPATH only they would get a class loader of their own, and plug-ins would fail.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=${1:-$here/../../build}
types=$build/modslam-types.jar
views=$build/modslam-spy-views.jar  # what a double click draws; right click: fields
lcm=/usr/share/java/lcm.jar
chart=/usr/share/java/jchart2d.jar

command -v java >/dev/null || { echo "spy: java is missing; type: apt install default-jre" >&2; exit 1; }
for jar in "$lcm:liblcm-java" "$chart:libjchart2d-java"; do
  [ -f "${jar%%:*}" ] || { echo "spy: ${jar%%:*} is missing; type: apt install ${jar##*:}" >&2; exit 1; }
done
[ -f "$types" ] || { echo "spy: $types is missing; build first (needs default-jdk-headless and liblcm-java)" >&2; exit 1; }
[ -n "${DISPLAY:-}" ] || { echo "spy: no screen (DISPLAY is not set); use the viewer, or log in with ssh -X" >&2; exit 1; }

LCM_DEFAULT_URL=${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0}
export LCM_DEFAULT_URL
exec java -Djava.net.preferIPv4Stack=true -Xmx256m -cp "$types:$views:$lcm:$chart" lcm.spy.Spy
