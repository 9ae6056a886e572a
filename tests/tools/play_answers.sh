#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-play --help, --version and --print-pipeline. The printed pipeline runs unchanged in a
# shell.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

# answers OPTION PATTERN: on standard output, with status 0 and no files
answers() {
  play "$1"
  expect_status 0
  expect_line out "$2"
  [ ! -s err ] || fail "$(cat err)"
  expect_only . out err
}

# prints_pipeline FOLDER FILM STREAMS: the printed line writes the same recording as the program
prints_pipeline() {
  mkdir -- "$1"
  play --print-pipeline --rows 2 -o "$1" "$2"
  expect_status 0
  expect_line err '^visuotactile-play: plays on driver=auto \(default\)$'
  [ "$(wc -l <out)" -eq 1 ] || fail "not one line: $(cat out)"
  expect_line out "^gst-launch-1.0 .* rows=2 "
  expect_only "$1"
  (eval "timeout 30 $(cat out)") >launch.log 2>&1 || fail "$(cat out launch.log)"
  expect_only "$1" visuotactile.mkv commands.csv
  expect_recording "$1/visuotactile.mkv" 0.95 1.1 "160 120 $3"
  expect_commands "$1/commands.csv"
}

plain_names() {
  prints_pipeline o "$work/sound.mkv" "video audio"
}

strange_names() {
  cp "$work/silent.mkv" "a  %41 \"b\" 'c' \\d !e \$HOME \`f\`; g.mkv"
  prints_pipeline "to a  %41 \"b\" 'c' \\d !e \$HOME \`f\`; g" "a  %41 \"b\" 'c' \\d !e \$HOME \`f\`; g.mkv" video
}

# --sensitivity, --density, --people and --camera are those of saliencytactile, and the overlay has a meter
steered() {
  play --print-pipeline --sensitivity 1.5 --density .25 --people fast --camera gentle "$work/silent.mkv"
  expect_status 0
  expect_line out 'saliencytactile .*sensitivity=1\.5 density=0\.25 people=fast camera=gentle attach-saliency=true .*tactileoverlay .*meter=true'
  play --sensitivity 1.5 --density .25 --people fast --camera gentle -o o "$work/silent.mkv"
  expect_all o 0.95 1.1 "160 120 video"
  play --print-pipeline "$work/silent.mkv"
  ! grep -E 'sensitivity|density|people|camera|meter' out || fail "not asked for"
}

# --sound is what the profile says of soundtactile and tactilecombiner; without sound it is nothing
sounds() {
  play --print-pipeline --sound=bass-shaker "$work/sound.mkv"
  expect_status 0
  expect_line out 'tactilecombiner name=both mix=replace ! tactileextractor .*soundtactile name=ear gain=6 impacts=true rumble=true ear\.tactile ! queue ! both\.tactile'
  play --print-pipeline --sound=film "$work/silent.mkv"
  ! grep -E 'tactilecombiner|soundtactile' out || fail "there is no sound"
}

built_in_film() {
  play --print-pipeline -o .
  expect_status 0
  expect_line out '^gst-launch-1.0 .*tactiletestsrc'
  # Only its first frames.
  (eval "timeout 30 $(sed -E 's/num-buffers=[0-9]+/num-buffers=10/g' out)") >launch.log 2>&1 || fail "$(cat out launch.log)"
  expect_recording visuotactile.mkv 0.6 0.75 "640 640 video"
}

film silent.mkv "$(picture 160 120) ! $h264 ! matroskamux"
film sound.mkv "$(picture 160 120) ! $h264 ! matroskamux name=mux $vorbis ! mux. mux."

start help answers --help '--output=DIR'
start version answers --version '^visuotactile-play [0-9]+\.[0-9]+\.[0-9]+$'
start plain_names plain_names
start strange_names strange_names
start sounds sounds
start steered steered
start built_in_film built_in_film
finish
