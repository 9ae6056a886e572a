#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs every gst-launch-1.0 line of the given pages, with three changes: films have 15 frames,
# windows and loudspeakers are fakesinks, and FILM, TRACK and CARRIER are a generated film, its track
# and a file with both. Each line must end with status 0.
# Usage: launch_lines.sh FILE...      (with the plugins on GST_PLUGIN_PATH)
set -euo pipefail

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

film=$work/film.mkv
gst-launch-1.0 -q tactiletestsrc num-buffers=15 ! video/x-raw,width=320,height=240 ! x264enc tune=zerolatency ! matroskamux ! filesink location="$film"
track=$work/track.vtt
gst-launch-1.0 -q filesrc location="$film" ! decodebin ! saliencytactile ! tactileextractor name=x x.tactile ! tactileconverter ! webvttenc ! filesink location="$track"
carrier=$work/carrier.mkv
gst-launch-1.0 -q matroskamux name=mux ! filesink location="$carrier" filesrc location="$film" ! matroskademux ! h264parse ! queue ! mux. \
  filesrc location="$track" ! subparse ! tactileconverter ! tactileconverter ! queue ! mux.subtitle_0

count=0
failed=0
for file in "$@"; do
  # A backslash at the end continues a line. The leading " * " of a comment block is removed.
  while IFS= read -r line; do
    line=$(sed -E "s/num-buffers=[0-9]+/num-buffers=15/g; s/auto(video|audio)sink/fakesink sync=true/g; s/visuotactilesink/visuotactilesink video-sink=fakesink/g; s#FILM#$film#g; s#TRACK#$track#g; s#CARRIER#$carrier#g" <<<"$line")
    count=$((count + 1))
    if ! (cd "$work" && eval "timeout 60 $line") >"$work/log" 2>&1 </dev/null; then
      failed=$((failed + 1))
      printf '%s: this line fails:\n  %s\n' "$file" "$line"
      tail -n 5 "$work/log"
    fi
  done < <(sed -E 's/^ \* ?//' "$file" | sed -e ':a' -e '/\\$/N; s/\\\n *//; ta' | grep -E '^gst-launch-1\.0 ' || true)
done
echo "$count lines run, $failed failed"
[ "$count" -gt 0 ] && [ "$failed" -eq 0 ]
