#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# All programs and the sinks say in one line on which driver they play, and why: default, settings, option or property.
# Expects the programs PLAY, FOLLOW, TRACK and CALIBRATE, and the plugins on GST_PLUGIN_PATH.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export HOME=$work XDG_CONFIG_HOME=$work/config XDG_STATE_HOME=$work/state XDG_RUNTIME_DIR=$work DBUS_SESSION_BUS_ADDRESS=unix:path=$work/none
file=$XDG_CONFIG_HOME/visuotactile/chair.conf
mkdir -p "${file%/*}"
mkfifo said

# says LINE COMMAND...: it is the first line with "driver"
says() {
  local expected=$1 line= each program
  shift
  "$@" 2>said >/dev/null </dev/null &
  program=$!
  while read -r each; do
    [[ $each != *driver* ]] || { line=$each; break; }
  done <said
  kill "$program" 2>/dev/null || true
  wait "$program" || true
  [ "$line" = "$expected" ] || { echo "expected '$expected' of '$*', got '$line'"; exit 1; }
}

# all LINE [OPTION]: of the programs
all() {
  local line=$1 calibrated=${1/, intensity=0.5/} # which is not its
  calibrated=${calibrated/; settings of the user: intensity=0.5/}
  shift
  says "visuotactile-play: $line" "$PLAY" --no-window --print-pipeline "$@"
  says "visuotactile-follow: $line" "$FOLLOW" --mpv="$work/mpv.sock" "$@"
  says "tactile-track desk: $line" "$TRACK" desk --no-browser none.mkv "$@"
  says "tactor-calibrate: $calibrated" "$CALIBRATE" measure --source=none "$@" out
}
# sink LINE [PROPERTY]: of visuotactilesink
sink() {
  local line=$1
  shift
  gst-launch-1.0 -m videotestsrc num-buffers=2 ! visuotactilesink video-sink=fakesink "$@" >messages 2>&1 || { cat messages; exit 1; }
  grep -qF "$line" messages || { echo "expected '$line' of visuotactilesink $*, got: $(cat messages)"; exit 1; }
}

all 'plays on driver=auto (default)'
sink 'plays on driver=auto (default)'
all 'plays on driver=simulator (option)' --driver=simulator
sink 'plays on driver=simulator (property)' driver=simulator
printf '[chair]\ndriver=simulator\nintensity=0.5\n' >"$file"
all 'plays on driver=simulator (settings); settings of the user: driver=simulator, intensity=0.5'
sink 'plays on driver=simulator (settings)'
all 'plays on driver=auto (option); settings of the user: intensity=0.5' --driver=auto
