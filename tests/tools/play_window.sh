#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# With a display, visuotactile-play shows the film and records nothing. Needs Xvfb, which
# tools/setup.sh installs.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

if ! command -v Xvfb >/dev/null; then
  echo "there is no Xvfb: install the Debian package xvfb, or run tools/setup.sh"
  exit 1
fi

mkfifo number
Xvfb -displayfd 3 -noreset -nolisten tcp -screen 0 640x480x24 3>number >xvfb.log 2>&1 &
server=$!
trap 'kill "$server" 2>/dev/null; rm -rf "$work"' EXIT
read -r -t 20 display <number || fail "Xvfb does not start: $(cat xvfb.log)"
export DISPLAY=:$display

shown() {
  play -o o "$work/$1"
  expect_status 0
  expect_report
  expect_line err '^Playing '
  expect_line out '^Played +1\.0 s of 1\.0 s$'
  expect_only o commands.csv strip.png
  expect_commands o/commands.csv
  expect_strip o/strip.png
}

# Keys in the window steer.
steered() {
  (
    for ((i = 0; i < 40; i++)); do
      grep -q '^Playing ' err 2>/dev/null && break
      sleep 0.1
    done
    "$PYTHON" "$here/press_keys.py" 177 Up Up Down Left Right x >pressed 2>&1
  ) &
  play -o o "$work/long.mkv"
  wait
  expect_status 0
  [ ! -s pressed ] || fail "$(cat pressed)"
  grep '^Sensitivity' err >got || true
  [ "$(cat got)" = "Sensitivity 1.41, density 100 % (off)
Sensitivity 2.00, density 100 % (off)
Sensitivity 1.41, density 100 % (off)
Sensitivity 1.41, density 71 %
Sensitivity 1.41, density 100 % (off)" ] || fail "keys do: $(cat got)"
}

broken() {
  play -o o "$work/cut.mkv"
  expect_status 0
  expect_line out '^Film broken +it ends here'
  expect_only o commands.csv strip.png
}

not_shown() {
  play --no-window -o o "$work/sound.mkv"
  expect_all o 0.95 1.1 "160 120 video audio"
  expect_line err '^Recording'
}

# DISPLAY names a display that does not exist.
no_such_display() {
  DISPLAY=:$((display + 1000)) play -o o "$work/silent.mkv"
  expect_all o 0.95 1.1 "160 120 video"
}

film silent.mkv "$(picture 160 120) ! $h264 ! matroskamux"
film sound.mkv "$(picture 160 120) ! $h264 ! matroskamux name=mux $vorbis ! mux. mux."
film long.mkv "$(picture 177 120 I420 90) ! vp8enc deadline=1 ! matroskamux"
film odd.mkv "$(picture 161 121) ! vp8enc deadline=1 ! matroskamux"
cut_film cut.mkv sound.mkv 50

start silent shown silent.mkv
start sound shown sound.mkv
start odd_size shown odd.mkv
start steered steered
start broken broken
start not_shown not_shown
start no_such_display no_such_display
finish
