#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Commands of a chair while all processors are taken by others: how many came late, with tactorsink's threads real-time and without. What came
# late because its map did is counted apart: a command that was due when its map came. Runs take turns; as Markdown.
#
# Usage: busy.sh [--others N] [--seconds N] [--runs N]     (with the plugins on GST_PLUGIN_PATH; 9 others, 20 s, 3 runs of each)
set -euo pipefail

others=9 seconds=20 runs=3
while [ $# -gt 0 ]; do
  case $1 in
    --others) others=$2; shift 2 ;;
    --seconds) seconds=$2; shift 2 ;;
    --runs) runs=$2; shift 2 ;;
    *) sed -n '3,6s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
done
work=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; rm -rf "$work"' EXIT
for ((i = 0; i < others; i++)); do
  timeout "$((runs * (2 * seconds + 30) + 60))" sh -c 'while :; do :; done' &
  pids+=($!)
done

# No limit ends a vibration. The picture is small: what is measured is not the analysis.
room="queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000"
play() { # REALTIME
  # shellcheck disable=SC2086 # launch lines are words
  gst-launch-1.0 -m tactiletestsrc pattern=dynamic-motion num-buffers="$((seconds * 30))" ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 \
    ! saliencytactile ! tactileextractor name=x x.src ! $room ! fakesink sync=true \
    x.tactile ! $room ! tactorsink driver=simulator rate=0 max-on-time=0 max-duty=0 max-active=0 realtime="$1" >"$work/log" 2>&1
}
field() { sed -nE "s/.*tactor-stats.* $1=\([a-z0-9]*\)([a-z0-9-]+).*/\1/p" "$work/log" | tail -n 1; }

echo "$others busy programs on $(nproc) CPUs ($(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)), film of $seconds s, a map every 33 ms"
echo
echo "| realtime | scheduling | commands | late | map came after they were due | late though the map was there | p99 of these | most |"
echo "|---|---|---|---|---|---|---|---|"
for ((run = 0; run < runs; run++)); do
  for realtime in false true; do
    play "$realtime"
    awk -v r="$realtime" -v s="$(field scheduling)" -v n="$(field issued)" -v l="$(field late)" -v c="$(field came-late)" -v t="$(field thread-late)" \
      -v p="$(field thread-p99)" -v m="$(field thread-max)" \
      'BEGIN { printf "| %s | %s | %d | %d | %d | %d (%.1f %%) | %.2f ms | %.2f ms |\n", r, s, n, l, c, t, n ? 100 * t / n : 0, p / 1e6, m / 1e6 }'
  done
done
