#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# What saliencytactile adds to playing an H.264 film: CPU (user and system) per frame of decoding alone and with the analysis, at 1080p and 4K.
# Starting a pipeline and loading its plugins is taken off. Then a clip is played in real time at 1080p: CPU and wake-ups, also with the
# detection of faces. Medians of runs that take turns, as Markdown.
#
# Usage: playback.sh [--quick] [CLIP]      (with the plugins on GST_PLUGIN_PATH; --quick: 1080p alone, fewer runs)
set -euo pipefail

runs=5
films=(1920x1080:200:8000 3840x2160:48:30000) # size:frames:kbit/s
[ "${1:-}" != --quick ] || { runs=3; films=("${films[0]}"); shift; }
clip=${1:-}
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
    for with in "" "saliencytactile people=off !"; do
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

[ -n "$clip" ] || exit 0
cat <<'CAPTION'

The same clip in real time, on one decoding thread. Wake-ups are the voluntary context switches of all threads.

| played | CPU, ms a frame | added | wake-ups a second | added |
|---|---|---|---|---|
CAPTION
seconds=20
ffmpeg -v error -nostdin -t "$seconds" -i "$clip" -vf scale=1920:1080,fps=24,setsar=1 -an -c:v libx264 -preset veryfast "$work/clip.mkv"
play() { # FILE ELEMENT: adds a line of ms a frame and wake-ups a second
  # shellcheck disable=SC2086 # an element or none
  /usr/bin/python3 - "$seconds" gst-launch-1.0 -q filesrc location="$work/clip.mkv" ! matroskademux ! h264parse ! avdec_h264 max-threads=1 ! $2 fakesink sync=true >>"$1" <<'END'
import resource, subprocess, sys
subprocess.run(sys.argv[2:], check=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(1000 * (used.ru_utime + used.ru_stime) / (24 * int(sys.argv[1])), used.ru_nvcsw / int(sys.argv[1]))
END
}
for ((run = 0; run < runs; run++)); do
  play "$work/alone" ""
  play "$work/analyzed" "saliencytactile people=off !"
  play "$work/people" "saliencytactile !"
done
of() { cut -d ' ' -f "$2" "$work/$1" >"$work/column"; median "$work/column"; }
for row in "alone:the film" "analyzed:with saliencytactile people=off" "people:with saliencytactile, which detects faces"; do
  name=${row%%:*}
  awk -v what="${row#*:}" -v a="$(of alone 1)" -v b="$(of alone 2)" -v c="$(of "$name" 1)" -v d="$(of "$name" 2)" \
    'BEGIN { if (what == "the film") printf "| %s | %.2f | – | %.0f | – |\n", what, c, d
      else printf "| %s | %.2f | %.2f | %.0f | %d %% |\n", what, c, c - a, d, 100 * (d - b) / b }'
done
