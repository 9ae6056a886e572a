#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# What saliencytactile adds to playing an H.264 film: CPU (user and system) per frame of decoding alone and with the analysis, at 1080p and 4K.
# Starting a pipeline and loading its plugins is taken off. Medians of runs that take turns, as Markdown.
#
# Usage: playback.sh [--quick]      (with the plugins on GST_PLUGIN_PATH; --quick: 1080p alone, fewer runs)
set -euo pipefail

runs=5
films=(1920x1080:200:8000 3840x2160:48:30000) # size:frames:kbit/s
[ "${1:-}" != --quick ] || { runs=3; films=("${films[0]}"); }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

TIMEFORMAT='%U %S'
cpu() { # ms of a pipeline
  { time gst-launch-1.0 -q "$@" >/dev/null; } 2>&1 | tail -n 1 | awk '{ print 1000 * ($1 + $2) }'
}
median() { sort -n "$1" | sed -n "$((runs / 2 + 1))p"; }

echo "| H.264 film | frames | decoding, ms of CPU a frame | with saliencytactile | added | of decoding |"
echo "|---|---|---|---|---|---|"
for film in "${films[@]}"; do
  IFS=: read -r size frames rate <<<"$film"
  file=$work/$size.mkv
  # A noisy picture with moving balls: as hard to decode as a real film.
  gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion noise=3 num-buffers="$frames" ! "video/x-raw,format=I420,width=${size%x*},height=${size#*x}" \
    ! x264enc speed-preset=veryfast bitrate="$rate" ! matroskamux ! filesink location="$file"
  rm -f "$work"/*.ms
  for ((run = 0; run < runs; run++)); do
    for with in "" "saliencytactile !"; do
      name=$work/${with:+with}
      # shellcheck disable=SC2086 # an element or none
      {
        cpu filesrc location="$file" ! decodebin ! $with fakesink >>"${name}film.ms"
        cpu videotestsrc num-buffers=1 ! video/x-raw,width=16,height=16 ! $with fakesink >>"${name}start.ms"
      }
    done
  done
  awk -v film="${size/x/×}" -v n="$frames" -v a="$(median "$work/film.ms")" -v a0="$(median "$work/start.ms")" \
    -v w="$(median "$work/withfilm.ms")" -v w0="$(median "$work/withstart.ms")" 'BEGIN {
    a = (a - a0) / n; w = (w - w0) / n
    printf "| %s | %d | %.2f | %.2f | %.2f | %.0f %% |\n", film, n, a, w, w - a, 100 * (w - a) / a
  }'
done
