#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a live source with tactile output: a camera, an RTSP or other stream, or a test picture. The picture is delayed by the
# motors' lead time, 190 ms. With --least-delay it is at most 30 ms, and rises from rest are then up to 160 ms late.
# Usage: pipelines/live.sh [--least-delay] [URI | /dev/videoN]      (nothing: a test picture)
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
lead=180000000 # ns
if [ "${1:-}" = --least-delay ]; then
  lead=20000000
  shift
fi
build_and_use

case ${1:-} in
  "") source=(tactiletestsrc is-live=true pattern=dynamic-motion) ;;
  /dev/*) source=(v4l2src "device=$1" ! decodebin) ;;
  *://*) source=(uridecodebin "uri=$1") ;;
  *) echo "live.sh: expected a URI or a camera's device, got '$1'" >&2; exit 2 ;;
esac
# shellcheck disable=SC2086 # CHAIR is a list of properties
exec gst-launch-1.0 -e "${source[@]}" ! queue max-size-buffers=1 leaky=downstream ! videoconvert ! visuotactilesink max-lead="$lead" ${CHAIR:-}
