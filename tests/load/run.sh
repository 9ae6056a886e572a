#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Overload: chairs and 1080p films at once, each in its own process, in real time. Prints a line for each: commands issued, late and dropped,
# the lateness, and pictures skipped before analysis. Every missing command must be counted as late.
#
# Usage: tests/load/run.sh [--chairs N] [--films N] [--seconds N] [--hog] [--throttle BYTES]     (16 chairs, 8 films, 10 s)
#   --hog       another process uses one CPU
#   --throttle  films come over a link of BYTES per second
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../../tools/build.sh
. "$here/../../tools/build.sh"
chairs=16 films=8 seconds=10 hog= throttle=
while [ $# -gt 0 ]; do
  case $1 in
    --chairs) chairs=$2; shift 2 ;;
    --films) films=$2; shift 2 ;;
    --seconds) seconds=$2; shift 2 ;;
    --throttle) throttle=$2; shift 2 ;;
    --hog) hog=1; shift ;;
    -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "run.sh: unknown option '$1'; see run.sh --help" >&2; exit 2 ;;
  esac
done
build_and_use
work=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; rm -rf "$work"' EXIT

chair="tactorsink driver=simulator max-on-time=0 max-duty=0"
room="queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000"
frames=$((seconds * 30))
source="videotestsrc pattern=ball num-buffers=$frames ! video/x-raw,format=I420,width=1920,height=1080,framerate=30/1"
if [ -n "$throttle" ]; then
  # shellcheck disable=SC2086 # launch lines are split into words
  gst-launch-1.0 -q $source ! jpegenc ! matroskamux ! filesink location="$work/film.mkv"
  # Pushes 50 pieces per second. identity's sync and datarate do not work for bytes.
  source="filesrc location=$work/film.mkv blocksize=$((throttle / 50)) ! identity sleep-time=20000 ! queue max-size-buffers=1 ! matroskademux ! jpegdec"
fi
if [ -n "$hog" ]; then
  timeout "$((seconds + 30))" sh -c 'while :; do :; done' &
  pids+=($!)
fi
players=()
begin() { # NAME LAUNCH-LINE
  # shellcheck disable=SC2086
  timeout "$((seconds * 20 + 120))" gst-launch-1.0 -m $2 >"$work/$1.log" 2>&1 &
  players+=($!)
  pids+=($!)
}
for i in $(seq "$chairs"); do
  begin "chair$i" "tactiletestsrc pattern=dynamic-motion num-buffers=$frames ! video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! saliencytactile ! $chair"
done
for i in $(seq "$films"); do
  begin "film$i" "$source ! saliencytactile ! tactileextractor name=x x.src ! $room ! fakevideosink name=screen sync=true qos=true x.tactile ! $room ! $chair"
done
failed=0
for pid in "${players[@]}"; do wait "$pid" || failed=$((failed + 1)); done

field() { sed -n "s/.*tactor-stats.* $2=([a-z0-9]*)\([0-9-]*\).*/\1/p" "$work/$1.log" | tail -n 1; }
# From the last QoS message of each element.
skipped() {
  awk -F '"' '/\(qos\)/ && match($0, /dropped=\(guint64\)[0-9]+/) { most[$2] = substr($0, RSTART + 17, RLENGTH - 17) }
    END { for (element in most) sum += most[element]; print sum + 0 }' "$work/$1.log"
}
echo "$chairs chairs and $films films of 1080p, $seconds s of film, $(nproc) CPUs${hog:+, one taken by another}${throttle:+, $throttle bytes/s}; load $(cut -d ' ' -f 1 /proc/loadavg)"
printf '%-9s %8s %8s %8s %8s %14s %12s %6s %8s\n' "" issued late dropped starved "error-p50 ms" "error-max ms" told skipped
for log in $(cd "$work" && ls -v ./*.log); do
  name=$(basename "$log" .log)
  if [ -z "$(field "$name" issued)" ]; then
    printf '%-9s did not end in %s s\n' "$name" "$((seconds * 20 + 120))"
    continue
  fi
  printf '%-9s %8s %8s %8s %8s %14s %12s %6s %8s\n' "$name" "$(field "$name" issued)" "$(field "$name" late)" "$(field "$name" dropped)" \
    "$(field "$name" starved)" "$(($(field "$name" error-p50) / 1000000))" "$(($(field "$name" error-max) / 1000000))" \
    "$(grep -c tactor-lead-short "$work/$name.log" || true)" "$(skipped "$name")"
done
[ "$failed" -eq 0 ] || { echo "$failed did not end as they should" >&2; exit 1; }
