# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by tests that use servers: starts them and returns when they are ready, without polling. The caller kills `pids` at its end.
pids=()

# begin FILE COUNT COMMAND...: in the background, with its output in FILE; sets `first`, its first COUNT (as of head: -n 1, -c 1)
begin() {
  local file=$1 count=$2
  shift 2
  mkfifo "$file.begun"
  "$@" <&0 > >(tee -p "$file" >"$file.begun") &
  pids+=($!)
  # shellcheck disable=SC2034 # for the tests
  first=$(head "$count" "$file.begun" | tr -d '\0')
}

# serve KIND: haptic_server.py, whose lines are in KIND; sets `port`
serve() {
  # It ends with its standard input.
  begin "$1" -n1 /usr/bin/python3 "$SERVER" "$1" < <(tail -f /dev/null --pid=$$)
  [ -n "$first" ] || { echo "haptic_server.py ended before it was ready (see above)"; exit 1; }
  port=${first#port }
}

# sound_card: PulseAudio with the null sink 'Bass Shakers', which is `shakers`; ended by `pactl exit`
sound_card() {
  export PULSE_SERVER=unix:$work/socket
  # It is ready when its parent has ended.
  pulseaudio -n --daemonize=yes --exit-idle-time=-1 --log-level=error --log-target="file:$work/pulse.log" --realtime=no \
    --load="module-null-sink sink_name=shakers sink_properties=\"device.description='Bass Shakers'\" channels=2 rate=48000" \
    --load="module-native-protocol-unix socket=$work/socket auth-anonymous=1" 2>"$work/pulse.err" ||
    { echo "PulseAudio does not start: $(cat "$work/pulse.err")"; exit 1; }
}
