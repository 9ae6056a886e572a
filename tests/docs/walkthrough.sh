#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs the commands of docs/guide/tracks.md unchanged, from top to bottom, in one folder: each line
# of an sh block that names film.mp4 or the film of the walk-through. Players get settings that
# drive no board. Then checks the example of a track, and the message for a wrong one.
# Usage: walkthrough.sh PAGE      (with the plugins on GST_PLUGIN_PATH and tactile-track on PATH)
set -euo pipefail
page=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
unset DISPLAY WAYLAND_DISPLAY
fail() {
  echo "$*"
  exit 1
}

# The film that the page starts with.
gst-launch-1.0 -q tactiletestsrc num-buffers=150 ! video/x-raw,width=320,height=240,framerate=30/1 ! x264enc tune=zerolatency ! mp4mux ! filesink location=film.mp4

count=0
while IFS= read -r line; do
  count=$((count + 1))
  most=0
  case $line in
    "tactile-track diff "*) most=1 ;; # status 1: they differ
    "tactile-track preview "*) line="${line%%#*} --chair driver=simulator" ;;
  esac
  status=0
  eval "timeout 60 $line" >"$count.out" 2>&1 </dev/null || status=$?
  [ "$status" -le "$most" ] || fail "$page: status $status: $line: $(cat "$count.out")"
done < <(awk '$0 == "```" { inside = 0 } inside { print } $0 == "```sh" { inside = 1 }' "$page" | grep -E '(film\.mp4|film\.vtt|better|balls|final)' | grep -vE 'validate')
[ "$count" -ge 13 ] || fail "only $count commands"
for file in film.vtt film.png better.vtt with-track.mkv balls.vtt pruned.vtt final.vtt carrier.mkv; do
  [ -s "$file" ] || fail "there is no $file"
done
grep -q 'r[0-2]c[0-2] [0-9]* > [0-9]*' ./*.out || fail "diff says nothing"

# The film that carries the track has the same content as the track.
gst-launch-1.0 -q filesrc location=carrier.mkv ! matroskademux name=d d.subtitle_0 ! queue ! tactileconverter ! tactileconverter ! webvttenc ! filesink location=carried.vtt
tactile-track diff final.vtt carried.vtt || fail "the film carries another track"

# The example of a track, and another cue.
awk '$0 == "```" { if (inside) exit } $0 == "WEBVTT" { inside = 1 } inside { print }' "$page" >example.vtt
tactile-track validate example.vtt
printf '\n00:00:01.200 --> 00:00:01.600\n0 0 0\n0 0 0\n0 0 0\n' >>example.vtt
cp example.vtt film.vtt
status=0
tactile-track validate film.vtt >said 2>&1 || status=$?
[ "$status" -eq 1 ] || fail "status $status"
said=$(grep -o 'invalid: .*' said)
# The line number is this file's, the words are the page's.
grep -qF -- "$(sed 's/line [0-9]*/line 12/' <<<"$said")" <(sed 's/line [0-9]*/line 12/' "$page") || fail "the page does not say: $said"
echo "$count commands run"
