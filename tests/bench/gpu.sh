#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Cost of saliencytactile for frames in OpenGL textures: shrunk on the GPU, and with the whole frame downloaded first. Milliseconds a frame, CPU of all threads
# (user and system) and elapsed time, at 1080p and 4K. The pipeline without analysis is subtracted. Medians of runs that take turns, as Markdown.
#
# Usage: gpu.sh [FRAMES]      (default 2000; with the plugins on GST_PLUGIN_PATH)
# Needs a GPU. Without a display, set GST_GL_PLATFORM=egl GST_GL_WINDOW=egl-device. A renderer in software is refused unless VISUOTACTILE_GL_IN_SOFTWARE is set.
set -euo pipefail
frames=${1:-2000}
runs=3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

film() { echo "gltestsrc num-buffers=$frames pattern=mandelbrot ! video/x-raw(memory:GLMemory),width=${1%x*},height=${1#*x},format=RGBA"; }
renderer=$(GST_DEBUG=glcontext:4 GST_DEBUG_NO_COLOR=1 gst-launch-1.0 -q gltestsrc num-buffers=1 ! fakesink 2>&1 | sed -n 's/.*GL_RENDERER: //p' | head -n 1)
case $renderer in
  "") echo "gpu.sh: expected an OpenGL context, got none; without a display, set GST_GL_PLATFORM=egl GST_GL_WINDOW=egl-device" >&2; exit 1 ;;
  llvmpipe* | softpipe* | SwiftShader*)
    [ -n "${VISUOTACTILE_GL_IN_SOFTWARE:-}" ] || { echo "gpu.sh: expected a GPU, got $renderer" >&2; exit 1; } ;;
esac
echo "$renderer; $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) CPUs"
echo
echo "| frames | analysis | CPU, ms a frame | elapsed, ms a frame |"
echo "|---|---|---|---|"

TIMEFORMAT='%R %U %S'
for size in 1920x1080 3840x2160; do
  rm -f "$work"/*
  for ((run = 0; run < runs; run++)); do
    for way in none shrunk downloaded; do
      case $way in none) with= ;; shrunk) with="! saliencytactile" ;; downloaded) with="! gldownload ! video/x-raw ! saliencytactile" ;; esac
      # shellcheck disable=SC2046,SC2086 # words of a launch line
      { time gst-launch-1.0 -q $(film "$size") $with ! fakesink sync=false >/dev/null; } 2>&1 | tail -n 1 >>"$work/$way"
    done
  done
  for way in shrunk downloaded; do
    for what in '$2+$3' '$1'; do
      for file in "$work/none" "$work/$way"; do
        awk "{ print $what }" "$file" | sort -n | sed -n "$((runs / 2 + 1))p"
      done | paste -sd' ' | awk -v n="$frames" '{ printf "%.2f\n", ($2 - $1) * 1000 / n }'
    done | paste -sd' ' | awk -v size="${size/x/×}" -v way="$way" '{ print "| " size " | " (way == "shrunk" ? "shrunk on the GPU" : "whole frame downloaded") " | " $1 " | " $2 " |" }'
  done
done
