#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-play plays a truncated film up to its end and a damaged one as far as possible, and
# reports it.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

# damage NAME FROM: a copy with 2000 bytes of its middle overwritten
damage() {
  cp "$2" "$1"
  seq 1 1000 | tr -d '\n' | head -c 2000 | dd of="$1" bs=1 seek=$(($(stat -c %s "$2") / 2)) conv=notrunc status=none
}

# ends_early FILM LEAST MOST: part of the film plays, the recording is complete, and the report
# names the damage
ends_early() {
  play -o o "$work/$1"
  expect_all o "$2" "$3"
  expect_commands o/commands.csv
  expect_line out '^Film broken +it ends here'
  expect_line out '^Played +0\.[0-9] s of 1\.0 s$'
}

# survives FILM: plays to the end or to the damage, with a complete recording
survives() {
  play -o o "$work/$1"
  expect_all o 0.2 1.1
  # To oggdemux of GStreamer 1.26 the film ends where it is damaged.
  grep -qE '^Played +(1\.0|0\.9) s' out || grep -qE '^Played +(0\.[0-9]) s of \1 s$' out || expect_line out '^Film broken'
}

# plays_what_is_there FILM
plays_what_is_there() {
  play -o o "$work/$1"
  expect_all o 0.2 1.1
}

tone="audiotestsrc num-buffers=40 samplesperbuffer=1102 ! audio/x-raw,rate=44100,channels=1"
film sound.mkv "$(picture 160 120) ! $h264 ! matroskamux name=mux $vorbis ! mux. mux."
film silent.mkv "$(picture 160 120) ! $h264 ! matroskamux"
film sound.mp4 "$(picture 160 120) ! $h264 ! mp4mux name=mux faststart=true $tone ! lamemp3enc ! mux. mux."
film vp8.mkv "$(picture 160 120) ! vp8enc deadline=1 ! matroskamux name=mux $vorbis ! mux. mux."
film sound.ogv "$(picture 160 120) ! theoraenc ! oggmux name=mux $vorbis ! mux. mux."
film sound.avi "$(picture 160 120) ! jpegenc ! avimux name=mux $tone ! mux. mux."

for whole in sound.mkv silent.mkv sound.mp4; do
  cut_film "cut_$whole" "$whole" 50
  start "cut_${whole/./_}" ends_early "cut_$whole" 0.3 0.7
done
for whole in sound.mkv sound.mp4 vp8.mkv sound.ogv sound.avi; do
  damage "damaged_$whole" "$whole"
  start "damaged_${whole/./_}" survives "damaged_$whole"
done
# These state their length only at the end or not at all: what is there plays.
for whole in sound.ogv sound.avi; do
  cut_film "cut_$whole" "$whole" 80
  start "cut_${whole/./_}" plays_what_is_there "cut_$whole"
done
finish
