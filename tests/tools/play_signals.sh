#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-play ends in order on SIGINT, SIGTERM and SIGHUP: complete files, tactors at zero. The second SIGINT ends it at once; not even
# SIGKILL leaves a broken file under a name that is not hidden.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

# begin [FILM ...]: plays in the background; back when it says that it records on simulated motors; sets `pid`
begin() {
  mkdir -p o
  # Background jobs of a script ignore SIGINT from the start; a program that was started at a terminal does not.
  "$PYTHON" -c 'import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])' \
    "$PLAY" -o o "$@" >out 2>err &
  pid=$!
  until_true 'neither records nor ends' grep -qE '^the motors are simulated: ' err
  expect_line err '^Recording, in real time'
}

# recorded: something of the film is in the recording, which the muxer writes by the second
recorded() {
  [ -n "$(find o -name '.visuotactile.mkv.*.part' -size +0)" ]
}

# until_true COMPLAINT COMMAND ...: waits for the command to succeed while the program runs, half a minute at most
until_true() {
  for _ in $(seq 600); do
    "${@:2}" && return
    kill -0 "$pid" 2>/dev/null || fail "ended by itself: $(cat err)"
    sleep 0.05
  done
  fail "$1: $(cat err)"
}

# await SECONDS: the program's end, within that, which only a program that hangs does not do; sets `status`
await() {
  for _ in $(seq $(($1 * 20))); do
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.05
  done
  ! kill -0 "$pid" 2>/dev/null || fail "still runs after $1 s: $(cat err)"
  status=0
  wait "$pid" || status=$?
}

stopped() {
  begin "${@:2}"
  until_true 'nothing was recorded' recorded
  kill -s "$1" "$pid"
  await 60
  expect_all o 0.1 20
  [ $# -eq 1 ] || expect_commands o/commands.csv
  expect_line out '^Played .*\(stopped\)$'
}

# Nothing comes for seconds: the recording is completed all the same.
stopped_between_frames() {
  begin "$work/sparse.mkv"
  kill -INT "$pid"
  await 60
  expect_all o 1 60
}

twice() {
  begin "$work/sparse.mkv"
  kill -INT "$pid"
  sleep 0.1
  kill -INT "$pid"
  await 60
  expect_all o 1 60
}

killed() {
  mkdir o
  for name in visuotactile.mkv commands.csv strip.png; do
    echo "kept $name" >"o/$name"
  done
  begin
  until_true 'nothing was recorded' recorded
  kill -KILL "$pid"
  await 60
  expect_status 137
  for name in visuotactile.mkv commands.csv strip.png; do
    [ "$(cat "o/$name")" = "kept $name" ] || fail "$name was changed"
    rm "o/$name"
  done
  [ -z "$(find o -mindepth 1 ! -name '.*.part')" ] || fail "left behind: $(ls -A o)"
}

film film.mkv "$(picture 160 120 I420 300) ! $h264 ! matroskamux name=mux ${vorbis/num-buffers=40/num-buffers=400} ! mux. mux."
film sparse.mkv "$(picture 160 120 I420 6 | sed s,30/1,1/8,) ! $h264 ! matroskamux name=mux ${vorbis/num-buffers=40/num-buffers=1920} ! mux. mux."
start interrupted stopped INT
start terminated stopped TERM
start hung_up stopped HUP
start interrupted_sound stopped INT "$work/film.mkv"
start stopped_between_frames stopped_between_frames
start twice twice
start killed killed
finish
