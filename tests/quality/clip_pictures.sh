#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Draws what both profiles feel in real films: one sheet of moments for each film, each moment with the levels of profile=paper, those
# of profile=tuned, and tuned's saliency.
# Usage: tests/quality/clip_pictures.sh CLIPS OUT     (GST_PLUGIN_PATH holds the built plugins; needs tools/setup.sh play)
set -euo pipefail
clips=${1:?the folder with the films} out=${2:?the folder for the pictures}

# sheet FILM FRAME...: OUT/FILM.jpg. Frames are numbered from 0; each has seen all that went before.
sheet() {
  local film=$1; shift
  local frames=$* frame work; work=$(mktemp -d)
  trap 'rm -rf "$work"' RETURN
  local scale='videoconvert ! videoscale ! video/x-raw,width=320,height=180 ! jpegenc quality=95'
  gst-launch-1.0 -q filesrc location="$clips/$film.mp4" ! decodebin ! videoconvert ! video/x-raw,format=I420 ! tee name=t \
    t. ! queue ! saliencytactile profile=paper ! tactileoverlay ! $scale ! multifilesink location="$work/0-%05d.jpg" \
    t. ! queue ! saliencytactile profile=tuned ! tactileoverlay ! $scale ! multifilesink location="$work/1-%05d.jpg" \
    t. ! queue ! saliencytactile profile=tuned attach-saliency=true ! tactileoverlay style=heatmap ! $scale ! multifilesink location="$work/2-%05d.jpg"
  local sources="" pads="" row=0 column number=0
  for frame in $frames; do
    for column in 0 1 2; do
      sources+=" filesrc location=$work/$column-$(printf %05d "$frame").jpg ! jpegdec ! c.sink_$number"
      pads+=" sink_$number::xpos=$((column * 320)) sink_$number::ypos=$((row * 180))"
      number=$((number + 1))
    done
    row=$((row + 1))
  done
  # shellcheck disable=SC2086 # words of a pipeline
  gst-launch-1.0 -q compositor name=c $pads ! videoconvert ! jpegenc quality=75 ! filesink location="$out/$film.jpg" $sources
}

mkdir -p "$out"
sheet car-detection 57 61 78 104 236 346
sheet one-by-one-person-detection 60 90 201 540 776 869
sheet bottle-detection 50 210 220 550 930 961
