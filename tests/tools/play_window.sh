#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# With a display, visuotactile-play shows the film and records nothing. Needs Xvfb, which
# tools/setup.sh installs.
# Expects NO_SECONDS, the library of support/no_seconds.c, besides.
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

# press WIDTH KEY ...: in the window of a film that is as wide, or of the synthetic film (480), when it is there
press() {
  (
    for ((i = 0; i < 40; i++)); do
      grep -q '^Playing ' err 2>/dev/null && break
      sleep 0.1
    done
    "$PYTHON" "$here/press_keys.py" "$@" >pressed 2>&1
  ) &
  film=()
  [ ! -e "$work/long$1.mkv" ] || film=("$work/long$1.mkv")
  play "${film[@]}"
  wait
  expect_status 0
  [ ! -s pressed ] || fail "$(cat pressed)"
  grep -E '^(Sensitivity|Intensity|Vibration|Paused|Playing from|This film|[0-9:]+ of )' err >got || true
}

expect_said() {
  [ "$(cat got)" = "$1" ] || fail "keys do: $(cat got)"
}

turned() {
  press 177 2 2 1 3 4 x minus minus plus m m q
  expect_said "Sensitivity 1.41, density 100 % (off)
Sensitivity 2.00, density 100 % (off)
Sensitivity 1.41, density 100 % (off)
Sensitivity 1.41, density 71 %
Sensitivity 1.41, density 100 % (off)
Intensity 90 %
Intensity 80 %
Intensity 90 %
Vibration off
Vibration on"
  expect_line out '^Played .* of 90\.0 s \(stopped\)$'
}

# In the pause, which lasts, times are exact.
moved() {
  press 181 space Left Right Up Right Down Down space Escape
  sed -E 's/^(Paused at|Playing from) .*/\1/' got >said
  mv said got
  expect_said "Paused at
0:00 of 1:30
0:10 of 1:30
1:10 of 1:30
1:20 of 1:30
0:20 of 1:30
0:00 of 1:30
Playing from"
  expect_line out '^Played .* of 90\.0 s \(stopped\)$'
}

# The demuxer moves all streams, although the sink of the sound has none.
moved_without_sound() {
  press 185 space Right Escape
  expect_line got '^0:1[0-9] of 0:30$'
  expect_line out 'sound that cannot be decoded$'
}

# Nothing is queued that could be played: it ends without the time for that, which never comes here.
interrupted_in_a_pause() {
  LD_PRELOAD=${LD_PRELOAD:+$LD_PRELOAD:}$NO_SECONDS play_on "$work/long189.mkv"
  until_true 'does not play' grep -q '^Playing ' err
  "$PYTHON" "$here/press_keys.py" 189 space
  until_true 'does not pause' grep -q '^Paused at ' err
  kill -INT "$pid"
  await 60
  [ "$status" -eq 0 ] || fail "status $status"
  expect_line out '^Played .*\(stopped\)$'
}

# The window has the film's name and the position in its title; F fills the screen, and F or Escape ends that.
titled() {
  play_on "$work/long193.mkv"
  named() { xdotool search --name "$1" >window 2>/dev/null; } # it fails when another window goes meanwhile
  until_true 'has no title' named '^long193.mkv, 0:[0-9]+ of 0:30$'
  is_sized() { xdotool getwindowgeometry "$(cat window)" | grep -q "$1"; }
  until_true 'is not of the film'"'"'s size' is_sized 193x120
  for key in f Escape; do
    "$PYTHON" "$here/press_keys.py" 193 f
    until_true 'does not fill the screen' is_sized 640x480
    "$PYTHON" "$here/press_keys.py" 640 "$key"
    until_true 'still fills the screen' is_sized 193x120
  done
  "$PYTHON" "$here/press_keys.py" 193 space
  until_true 'does not say that it is paused' named ', paused$'
  kill -INT "$pid"
  await 60
  [ "$status" -eq 0 ] || fail "status $status"
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
# The synthetic film is two that are joined.
not_moved() {
  press 480 Right q
  expect_said "This film cannot be moved to another time"
}

for width in 177 181; do
  film "long$width.mkv" "$(picture "$width" 120 I420 450 | sed s,30/1,5/1,) ! vp8enc deadline=1 ! matroskamux"
done
# Few frames, as making them takes a while.
film long189.mkv "$(picture 189 120 I420 30 | sed s,30/1,1/1,) ! vp8enc deadline=1 ! matroskamux"
film long193.mkv "$(picture 193 120 I420 30 | sed s,30/1,1/1,) ! vp8enc deadline=1 ! matroskamux"
film heard.mkv "$(picture 185 120 I420 30 | sed s,30/1,1/1,) ! vp8enc deadline=1 ! matroskamux name=mux ${vorbis/num-buffers=40/num-buffers=1200} ! mux. mux."
sed 's/A_VORBIS/A_XORBIS/' heard.mkv >long185.mkv
film odd.mkv "$(picture 161 121) ! vp8enc deadline=1 ! matroskamux"
cut_film cut.mkv sound.mkv 50

start silent shown silent.mkv
start sound shown sound.mkv
start odd_size shown odd.mkv
start turned turned
start moved moved
start moved_without_sound moved_without_sound
start interrupted_in_a_pause interrupted_in_a_pause
start not_moved not_moved
start titled titled
start broken broken
start not_shown not_shown
start no_such_display no_such_display
finish
