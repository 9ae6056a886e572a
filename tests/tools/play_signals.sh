#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# On SIGINT, SIGTERM and SIGHUP visuotactile-play completes its files and sets tactors to zero. A
# second SIGINT ends it at once. Even SIGKILL leaves no incomplete file under a name that is not
# hidden.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

# begin [FILM ...]: plays in the background; returns once it reports a recording with simulated
# motors; sets `pid`
begin() {
  mkdir -p o
  play_on -o o "$@"
  until_true 'neither records nor ends' grep -qE '^the motors are simulated: ' err
  expect_line err '^Recording, in real time'
}

# recorded: part of the film is in the recording, which the muxer writes about every second
recorded() {
  [ -n "$(find o -name '.visuotactile.mkv.*.part' -size +0)" ]
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

# No frame arrives for seconds: the recording is completed nevertheless.
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
  begin -f
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
