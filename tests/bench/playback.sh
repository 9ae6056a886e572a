#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# What saliencytactile adds to playing an H.264 film at 1080p: CPU seconds of decoding alone and with the analysis, and the analysis' share of
# one core in real time. Usage: playback.sh      (with the plugins on GST_PLUGIN_PATH)
set -euo pipefail

seconds=10
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
film=$work/film.mkv

# A noisy picture with moving balls: as hard to decode as a real film.
gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion noise=3 num-buffers=$((seconds * 30)) ! video/x-raw,format=I420,width=1920,height=1080 \
  ! x264enc speed-preset=veryfast bitrate=8000 ! matroskamux ! filesink location="$film"

TIMEFORMAT='%U %S'
cpu() { # user and system seconds of a pipeline
  { time gst-launch-1.0 -q filesrc location="$film" ! decodebin ! $1 fakesink >/dev/null; } 2>&1 | tail -n 1 | awk '{ print $1 + $2 }'
}
median() { sort -n | sed -n 3p; }

alone=$(for _ in 1 2 3 4 5; do cpu ""; done | median)
with=$(for _ in 1 2 3 4 5; do cpu "saliencytactile !"; done | median)
awk -v a="$alone" -v w="$with" -v s="$seconds" 'BEGIN {
  printf "| 1080p H.264, %d s | CPU s | share of one core in real time | of decoding |\n|---|---|---|---|\n", s
  printf "| decoding | %.2f | %.1f %% | |\n", a, 100 * a / s
  printf "| decoding and saliencytactile | %.2f | %.1f %% | |\n", w, 100 * w / s
  printf "| saliencytactile alone | %.2f | %.1f %% | %.0f %% |\n", w - a, 100 * (w - a) / s, 100 * (w - a) / a
}'
