#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-play records films of all kinds and names.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

# records FILM RECORDING: plays all of it, and there are cues
records() {
  play -o o "$work/$1"
  expect_all o 0.95 1.1 "$2"
  expect_commands o/commands.csv
  expect_line out '^Played +1\.0 s of 1\.0 s$'
  ! grep -q '^Film broken' out || fail "$(cat out)"
}

one_frame() {
  play -o o "$work/one.mkv"
  expect_all o 0.03 0.04 "160 120 video"
  expect_line out '^Frames +1,'
}

variable_rate() {
  # A parser, if there is one, leaves the last frame of 1/12 s without a duration.
  play -o o "$work/variable.mkv"
  expect_all o 0.9 1.1 "160 120 video"
  expect_line out '^Played +(0\.9|1\.0) s of 1\.0 s$'
  expect_line out '^Picture +160 x 120, no sound$'
  expect_line out '^Frames +21,'
}

undecodable_sound() {
  records undecodable_sound.mkv "160 120 video"
  expect_line out 'sound that cannot be decoded$'
}

# Sound that is felt, that is not there, and that nobody can decode.
felt_sound() {
  play --sound=film -o o "$work/sound.mkv"
  expect_all o 0.95 1.1 "160 120 video audio"
  play --sound=music -o silent "$work/silent.mkv"
  expect_all silent 0.95 1.1 "160 120 video"
  play --sound=film -o undecodable "$work/undecodable_sound.mkv"
  expect_all undecodable 0.95 1.1 "160 120 video"
  expect_line out 'sound that cannot be decoded$'
}

# The picture ends long before the sound, which is not an error.
longer_sound() {
  play -o o "$work/longer_sound.mkv"
  expect_all o 0.95 1.1 "160 120 video audio"
  expect_line out '^Played +0\.3 s of 1\.0 s$'
  ! grep -q '^Film broken' out || fail "$(cat out)"
}

# All bytes that are special to a shell, a URI or a launch line, and one that is not UTF-8.
names() {
  local name
  name=$(printf "a  %%41 #1 ?x=y; \"b\" 'c' \\\\d !e \$HOME \`f\` (g) [h]* & <i> | j: \xff.mkv")
  cp "$work/one.mkv" "$name"
  play -o "to $name" "$name"
  expect_all "to $name" 0.03 0.04
  # A name that looks like a URI, and options that begin with dashes.
  cp "$work/one.mkv" "Part: one.mkv"
  play "--output=to one" "Part: one.mkv"
  expect_all "to one" 0.03 0.04
  cp "$work/one.mkv" ./--rows
  play -o to-rows -- --rows
  expect_all to-rows 0.03 0.04
}

# A file URI, all options, and the working directory as the output folder.
options() {
  play -o . --quiet --no-window --profile paper --rows 64 --columns 1 --rate 0 --compensation frame-block "file://$work/one.mkv"
  expect_status 0
  [ ! -s err ] || fail "$(cat err)"
  expect_only . visuotactile.mkv commands.csv strip.png out err
}

# Closed outputs must not keep motors from zero, nor files from being written.
closed_output() {
  status=0
  "$PLAY" -o o "$work/silent.mkv" 2>&1 | true
  [ "${PIPESTATUS[0]}" -eq 0 ] || fail "status ${PIPESTATUS[0]}"
  expect_only o visuotactile.mkv commands.csv strip.png
  expect_recording o/visuotactile.mkv 0.95 1.1
}

# With --force, files are replaced, and other files stay.
replaces() {
  mkdir -p a/b
  echo old | tee a/b/visuotactile.mkv a/b/commands.csv a/b/strip.png >a/b/else
  play -f -o a/b "$work/one.mkv"
  [ "$(cat a/b/else)" = old ] || fail "something else was changed"
  rm a/b/else
  expect_all a/b 0.03 0.04
}

# Its second part begins at 0 again.
built_in() {
  play
  expect_status 0
  expect_line out '^Played +25\.0 s of 25\.0 s$'
  ! grep -q '^Film broken' out || fail "$(cat out)"
  expect_only . out err
}

# Without --output nothing is written.
writes_nothing() {
  play "$work/sound.mkv"
  expect_status 0
  expect_line err '^Playing '
  expect_line out '^Played +1\.0 s of 1\.0 s$'
  expect_line out '^Commands +[1-9][0-9]* issued'
  ! grep -E '^(Written|Recording)' out || fail "nothing was to be written"
  expect_only . out err
}

film silent.mkv "$(picture 160 120) ! $h264 ! matroskamux"
film sound.mkv "$(picture 160 120) ! $h264 ! matroskamux name=mux $vorbis ! mux. mux."
film sound.ogv "$(picture 160 120) ! theoraenc ! oggmux name=mux $vorbis ! mux. mux."
film longer_sound.mkv "$(picture 160 120 I420 10) ! $h264 ! matroskamux name=mux $vorbis ! mux. mux."
film odd.mkv "$(picture 161 121) ! vp8enc deadline=1 ! matroskamux"
film tiny.mkv "$(picture 3 1) ! vp8enc deadline=1 ! matroskamux"
film deep.mkv "$(picture 160 120 Y444_10LE) ! $h264 ! matroskamux"
film one.mkv "$(picture 160 120 I420 1) ! $h264 ! matroskamux"
film variable.mkv "$(picture 160 120 I420 15) ! c. $(picture 160 120 I420 6 | sed s,30/1,12/1,) ! c.
  concat name=c ! capssetter replace=true caps=video/x-raw,format=I420,width=160,height=120,framerate=0/1 ! $h264 ! matroskamux"
# An unknown codec.
sed 's/A_VORBIS/A_XORBIS/' sound.mkv >undecodable_sound.mkv

start built_in built_in
start silent records silent.mkv "160 120 video"
start sound records sound.mkv "160 120 video audio"
start ogg records sound.ogv "160 120 video audio"
start odd_size records odd.mkv "162 122 video"
start tiny records tiny.mkv "16 16 video"
start deep records deep.mkv "160 120 video"
start variable_rate variable_rate
start one_frame one_frame
start undecodable_sound undecodable_sound
start longer_sound longer_sound
start felt_sound felt_sound
start names names
start options options
start closed_output closed_output
start replaces replaces
start writes_nothing writes_nothing
finish
