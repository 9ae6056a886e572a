#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Films that go from NULL to PLAYING and back forty times, by gst-validate's scenario change_state_intensive: with visuotactiledecoder, with
# visuotactilesink and without any of ours. Prints a table: runs that hung (60 s), failed and were whole.
#
# Usage: tests/load/state_changes.sh [--runs N] [--with LIST] [CODEC ...]      (25; none,decoder,sink; theora h264 vp9)
# Expects gst-validate-1.0 (of gst-devtools, which Debian does not have) and ffmpeg.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../../tools/build.sh
. "$here/../../tools/build.sh"
runs=25 with=none,decoder,sink
while [ $# -gt 0 ]; do
  case $1 in
    --runs) runs=$2; shift 2 ;;
    --with) with=$2; shift 2 ;;
    -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "state_changes.sh: unknown option '$1'; see state_changes.sh --help" >&2; exit 2 ;;
    *) break ;;
  esac
done
[ $# -gt 0 ] || set -- theora h264 vp9
command -v gst-validate-1.0 >/dev/null || { echo "state_changes.sh: there is no gst-validate-1.0: build GStreamer's gst-devtools" >&2; exit 1; }
build_and_use
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_CONFIG_HOME=$work XDG_STATE_HOME=$work GST_VALIDATE_LOGSDIR=$work

film() { # CODEC
  case $1 in
    theora) set -- "$1" ogv libtheora libvorbis ;;
    h264) set -- "$1" mp4 libx264 aac ;;
    vp9) set -- "$1" webm libvpx-vp9 libopus ;;
    *) echo "state_changes.sh: expected theora, h264 or vp9, got '$1'" >&2; exit 2 ;;
  esac
  ffmpeg -nostdin -v error -f lavfi -i testsrc2=size=320x240:rate=25:duration=2 -f lavfi -i sine=duration=2 -c:v "$3" -c:a "$4" "$work/$1.$2"
  echo "$work/$1.$2"
}

echo "| codec | with | whole | hung | failed |"
echo "|---|---|---|---|---|"
found=0
for codec; do
  path=$(film "$codec")
  for chair in ${with//,/ }; do
    video=fakevideosink
    rank=visuotactiledecoder:NONE
    [ "$chair" != decoder ] || rank=visuotactiledecoder:MAX
    [ "$chair" != sink ] || video="visuotactilesink driver=simulator video-sink=fakevideosink"
    whole=0 hung=0 failed=0
    for ((i = 0; i < runs; i++)); do
      status=0
      GST_PLUGIN_FEATURE_RANK=$rank timeout --kill-after=5 60 gst-validate-1.0 --set-scenario=change_state_intensive \
        playbin "uri=file://$path" "video-sink=$video" audio-sink=fakeaudiosink >"$work/log" 2>&1 || status=$?
      case $status in
        0) whole=$((whole + 1)) ;;
        124 | 137) hung=$((hung + 1)) ;;
        *) failed=$((failed + 1)); tail -n 20 "$work/log" >&2 ;;
      esac
    done
    [ "$chair" = none ] || found=$((found + hung))
    echo "| $codec | $chair | $whole | $hung | $failed |"
  done
done
[ $found = 0 ]
