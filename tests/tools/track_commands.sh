#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactile-track with films and tracks: drafts, formats, edits, pictures, films that carry a track,
# and their commands.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"
export SOURCE_DATE_EPOCH=0

track() {
  play "$@"
  expect_status 0
}

# commands NAME LAUNCH_LINE: writes the simulated chair's commands to NAME.csv: effect, tactor and
# volts
commands() {
  # shellcheck disable=SC2086
  timeout 60 gst-launch-1.0 -q $2 ! tactorsink driver=simulator sync=false trace-location="$1.trace" >"$1.log" 2>&1 || fail "$1: $(cat "$1.log")"
  expect_commands "$1.trace" any
  cut -d, -f3- "$1.trace" | sort -t, -n >"$1.csv"
}

# The same tactors at the same times, line by line. Volts may differ by half a percent, to which
# text cues are rounded.
expect_same_commands() {
  paste -d, "$1.csv" "$2.csv" | awk -F, '
    function off(a, b) { return a > b ? a - b : b - a }
    NF != 6 || off($1, $4) > 1e6 || $2 != $5 || off($3, $6) > 0.016 { print "line " NR ": " $0; exit 1 }' || fail "$1 and $2 differ"
  [ "$(wc -l <"$1.csv")" -gt 3 ] || fail "there are hardly any commands"
}

author_plays_as_the_film() {
  track author "$work/film.mkv" -o film.vtt -q
  # Except for changes below half a percent, which text cues round off, and fractions of a
  # millisecond.
  commands film "uridecodebin uri=file://$work/film.mkv ! videoconvert ! saliencytactile"
  commands track "filesrc location=film.vtt ! subparse ! tactileconverter"
  "$PYTHON" "$here/same_commands.py" film.trace track.trace 0.016 1 || fail "the track does not play as the film does"
  track validate film.vtt
  expect_line out '^film.vtt: valid, 3 x 3, 6\.000 s$'
  "$PYTHON" -c 'import sys, webvtt; cues = webvtt.read("film.vtt"); sys.exit(not (len(cues) > 3 and cues[0].start == "00:00:00.000"))' || fail "another reader of WebVTT does not take it"
  track convert film.vtt -o film.csv
  # A block lasts 200 ms, to a frame, but one with a cell that is stronger by half begins at once.
  awk -F, 'NR > 2 { early = 0; for (i = 2; i <= NF; i++) { early = early || $i > 1.5 * level[i]; level[i] = $i }
    if (!early && NR > 3 && ($1 - begin + 34) % 200 > 68) { print "change at " $1 " ms"; exit 1 } begin = $1 }' film.csv || fail "not in blocks of 200 ms"
}

carriers() {
  local name
  track author "$work/film.mkv" -o film.vtt -q
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  for name in film.mkv film.mp4 film.ts; do
    play mux "$work/film.mkv" film.vtt -o "$name" # in a transport stream without names: status 3
  done
  commands mkv "filesrc location=film.mkv ! matroskademux name=d d.subtitle_0 ! queue ! tactileconverter"
  commands mp4 "filesrc location=film.mp4 ! qtdemux name=d d.subtitle_0 ! queue ! tactileconverter"
  # With the picture, which provides the stream's clock.
  commands ts "filesrc location=film.ts ! tsdemux name=d d.video_0_0100 ! queue max-size-bytes=0 max-size-time=0 max-size-buffers=0 ! fakesink d.private_0_0101 ! queue max-size-bytes=0 max-size-time=0 max-size-buffers=0 ! tactileconverter"
  expect_same_commands side mkv
  expect_same_commands side mp4
  expect_same_commands side ts
}

# subtitles_of FILE: whether players choose them by themselves, and their language, according to
# FFmpeg
subtitles_of() {
  ffprobe -v error -select_streams s -show_entries stream_disposition=default:stream_tags=language -of csv=p=0 "$1" | paste -sd' '
}

# Other players do not draw the track's numbers by default. GStreamer's players find the track
# (players, whole_film).
left_to_choice() {
  local name
  printf '1\n00:00:00,500 --> 00:00:05,000\nWho is there?\n' >one.srt
  timeout 30 gst-launch-1.0 -q matroskamux name=mux ! filesink location=read.mkv filesrc location="$work/film.mkv" ! matroskademux ! h264parse ! queue ! mux.video_0 \
    filesrc location=one.srt ! subparse ! capssetter caps=text/x-raw,format=utf8 ! taginject tags="language-code=en" ! queue ! mux.subtitle_0
  for name in film.mkv film.mp4; do
    track mux read.mkv "$work/good.vtt" -o "$name"
    [ "$(subtitles_of "$name")" = "1,eng 0,zxx" ] || fail "$name has $(subtitles_of "$name")"
    track mux read.mkv "$work/good.vtt" -o "$name" --first
    [ "$(subtitles_of "$name")" = "0,zxx 1,eng" ] || fail "$name, first, has $(subtitles_of "$name")"
    ffmpeg -nostdin -v error -i "$name" -map 0 -c copy -f null - >log 2>&1 && [ ! -s log ] || fail "$name: $(cat log)"
  done
  mkvmerge -J film.mkv >film.json
  "$PYTHON" - film.json <<'PYTHON' || fail "mkvmerge says $(cat film.json)"
import json, sys
film = json.load(open(sys.argv[1]))
subtitles = [track["properties"] for track in film["tracks"] if track["type"] == "subtitles"]
assert [(track["language"], track["default_track"]) for track in subtitles] == [("zxx", False), ("eng", True)]
assert not film["warnings"] and not film["errors"]
PYTHON
}

# What a player without any knowledge of touch shows: all frames, as drawn.
shown() {
  timeout 60 gst-launch-1.0 -q playbin uri="file://$PWD/$1" video-sink="filesink sync=true location=$1.frames" >"$1.shown" 2>&1 || echo "status $?" >>"$1.shown"
}

# Transport streams: one with a track, one whose track begins late and outlasts the film, and one
# with other KLV. No player misses a plugin or shows anything of them, each reaches the end, and
# with tactilesubtitles the track plays. The draft is halved and has a silent part in the middle, so
# it differs from the analysis.
transport_stream() {
  local name film="filesrc location=$work/film.mkv ! matroskademux ! h264parse ! queue ! mux."
  track author "$work/film.mkv" -o draft.vtt -q
  track edit draft.vtt -o film.vtt --scale=0.5 --mask=r1c1
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  play mux "$work/film.mkv" film.vtt -o film.ts
  track edit film.vtt -o late.vtt --shift=3
  play mux "$work/film.mkv" late.vtt -o late.ts
  # shellcheck disable=SC2086
  gst-launch-1.0 -q mpegtsmux name=mux ! filesink location=plain.ts $film
  # shellcheck disable=SC2086
  gst-launch-1.0 -q mpegtsmux name=mux ! filesink location=others.ts $film \
    fakesrc format=time datarate=40 sizetype=fixed sizemax=40 num-buffers=6 filltype=pattern ! meta/x-klv,parsed=true ! queue ! mux.
  for name in plain.ts film.ts late.ts others.ts; do
    shown "$name" &
  done
  wait
  for name in film.ts late.ts others.ts; do
    gst-discoverer-1.0 "$name" >found 2>&1 || fail "$(cat found)"
    ! grep -i missing found || fail "$name: $(cat found)"
    expect_line found 'subtitles #'
    [ ! -s "$name.shown" ] || fail "$name: $(cat "$name.shown")"
    cmp plain.ts.frames "$name.frames" || fail "$name is not shown as the film is"
  done
  for name in film.ts others.ts; do
    GST_PLUGIN_FEATURE_RANK=tactilesubtitles:MAX timeout 60 gst-launch-1.0 -q playbin uri="file://$PWD/$name" \
      video-sink="visuotactilesink video-sink=fakesink driver=simulator tactors::ramp-in=0 trace-location=$name.trace" >log 2>&1 || fail "$(cat log)"
    expect_commands "$name.trace"
  done
  "$PYTHON" "$here/same_commands.py" side.trace film.ts.trace 0.016 200 || fail "the player does not play the track"
  # As a player's text stream.
  timeout 60 gst-launch-1.0 -q playbin uri="file://$PWD/film.ts" video-sink="fakesink sync=true" \
    text-sink="capsfilter caps=text/x-raw ! tactileconverter ! tactorsink driver=simulator ramp-in=0 trace-location=text.trace" >log 2>&1 || fail "$(cat log)"
  "$PYTHON" "$here/same_commands.py" side.trace text.trace 0.016 200 || fail "the text sink does not play the track"
}

# stream FILE PAD: the data of a demuxer's pad
stream() {
  timeout 30 gst-launch-1.0 -q filesrc location="$1" ! matroskademux name=d d."$2" ! queue ! filesink location=stream >stream.log 2>&1 || fail "$1 has no $2: $(cat stream.log)"
  cat stream
}

# stream_names FILE: titles and languages, in the order of the streams
stream_names() {
  "$PYTHON" - "$1" <<'PYTHON'
import os, sys
import gi
gi.require_version("Gst", "1.0")
from gi.repository import Gst
Gst.init(None)
film = Gst.parse_launch("filesrc name=file ! matroskademux name=d")
film.get_by_name("file").set_property("location", sys.argv[1])
pads = []
def linked(demuxer, pad):
    sink = Gst.ElementFactory.make("fakesink")
    sink.set_property("async", False)
    film.add(sink)
    sink.sync_state_with_parent()
    pad.link(sink.get_static_pad("sink"))
    pads.append(pad)
film.get_by_name("d").connect("pad-added", linked)
film.set_state(Gst.State.PLAYING)
message = film.get_bus().timed_pop_filtered(20 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
assert message is not None and message.type == Gst.MessageType.EOS
for pad in pads:
    found = {}
    for index in range(8):
        event = pad.get_sticky_event(Gst.EventType.TAG, index)
        for name in ("title", "language-code") if event else ():
            known, value = event.parse_tag().get_string(name)
            found[name] = value if known else found.get(name)
    print(pad.get_name(), found.get("title"), found.get("language-code"))
film.set_state(Gst.State.NULL)
PYTHON
}

# A film with two sounds and two subtitles loses nothing. Names and order stay, and --first puts the
# track before its subtitles.
whole_film() {
  local pad sound="audio/x-raw,rate=44100,channels=1 ! vorbisenc"
  printf '1\n00:00:00,500 --> 00:00:05,000\nWho is <i>there</i>?\n' >one.srt
  printf '1\n00:00:01,000 --> 00:00:02,000\nA & B < C\n\n2\n00:00:04,000 --> 00:00:05,500\nYes.\n' >two.srt
  timeout 30 gst-launch-1.0 -q matroskamux name=mux ! filesink location=rich.mkv \
    filesrc location="$work/film.mkv" ! matroskademux ! h264parse ! queue ! mux.video_0 \
    audiotestsrc num-buffers=240 samplesperbuffer=1102 ! $sound ! taginject tags="title=Original,language-code=en" ! queue ! mux.audio_0 \
    audiotestsrc wave=saw num-buffers=240 samplesperbuffer=1102 ! $sound ! taginject tags="title=Dubbed,language-code=fr" ! queue ! mux.audio_1 \
    filesrc location=one.srt ! subparse ! capssetter caps=text/x-raw,format=utf8 ! taginject tags="title=English,language-code=en" ! queue ! mux.subtitle_0 \
    filesrc location=two.srt ! subparse ! capssetter caps=text/x-raw,format=utf8 ! taginject tags="title=Deutsch,language-code=de" ! queue ! mux.subtitle_1
  stream_names rich.mkv >names
  expect_line names '^audio_1 Dubbed fr$'
  track author "$work/film.mkv" -o film.vtt -q
  track mux rich.mkv film.vtt -o with.mkv
  [ ! -s err ] || fail "$(cat err)"
  for pad in video_0 audio_0 audio_1 subtitle_0 subtitle_1; do
    stream rich.mkv "$pad" >before
    stream with.mkv "$pad" >after
    [ -s before ] || fail "$pad is empty"
    cmp before after || fail "$pad is not what it was"
  done
  stream_names with.mkv >names_with
  # Of the picture mkvmerge writes the language that is Matroska's default.
  { sed 1d names; echo "subtitle_2 Tactile zxx"; } | diff - <(sed 1d names_with) || fail "other names, or another order"
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  commands third "filesrc location=with.mkv ! matroskademux name=d d.subtitle_2 ! queue ! tactileconverter"
  expect_same_commands side third
  track mux rich.mkv film.vtt -o first.mkv --first
  stream_names first.mkv >names_first
  expect_line names_first '^subtitle_0 Tactile zxx$'
  expect_line names_first '^subtitle_2 Deutsch de$'
  # What MP4 cannot store is named: the styles of subtitles, whose words are kept.
  ffmpeg -nostdin -v error -i "$work/film.mkv" -i one.srt -map 0 -map 1 -c:v copy -c:s ass styled.mkv
  play mux styled.mkv film.vtt -o styled.mp4
  expect_status 3
  expect_line err "not in 'styled.mp4': stream 1 .subtitle, ass.: its styles$"
  # A player that chooses the first subtitles.
  timeout 60 gst-launch-1.0 -q playbin uri="file://$PWD/first.mkv" video-sink="fakesink sync=true" audio-sink=fakesink \
    text-sink="tactileconverter ! tactorsink driver=simulator ramp-in=0 trace-location=player.trace" >log 2>&1 || fail "$(cat log)"
  "$PYTHON" "$here/same_commands.py" side.trace player.trace 0.016 200 || fail "the player does not play the track"
}

# A track comes out of a film as it went in, whoever has put it in: mux, mkvmerge (S_TEXT/WEBVTT) or
# ffmpeg (D_WEBVTT). A player plays it, and muxing replaces it.
foreign_carriers() {
  local name
  track author "$work/film.mkv" -o film.vtt -q
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  mkvmerge -q -o mkvmerge.mkv "$work/film.mkv" film.vtt
  ffmpeg -nostdin -v error -i "$work/film.mkv" -i film.vtt -map 0 -map 1 -c copy ffmpeg.mkv
  for name in mux.mkv mux.mp4 mux.ts; do
    play mux "$work/film.mkv" film.vtt -o "$name"
  done
  track convert film.vtt -o film.csv
  for name in mkvmerge.mkv ffmpeg.mkv mux.mkv mux.mp4 mux.ts; do
    track extract "$name" -o "$name.csv"
    play diff film.csv "$name.csv" --tolerance 0.51
    expect_status 0
  done
  for name in mkvmerge.mkv ffmpeg.mkv; do
    for player in playbin playbin3; do
      GST_PLUGIN_FEATURE_RANK=tactilesubtitles:MAX timeout 60 gst-launch-1.0 -q "$player" uri="file://$PWD/$name" \
        video-sink="visuotactilesink video-sink=fakesink driver=simulator tactors::ramp-in=0 trace-location=player.trace" >log 2>&1 || fail "$(cat log)"
      "$PYTHON" "$here/same_commands.py" side.trace player.trace 0.016 200 || fail "$player does not play the track of $name"
    done
  done
  track mux mux.mkv film.vtt -o twice.mkv
  [ "$(subtitles_of twice.mkv)" = "0,zxx" ] || fail "it has $(subtitles_of twice.mkv)"
  play mux mux.ts film.vtt -o twice.ts
  [ "$(ffprobe -v error -select_streams d -show_entries stream=codec_name -of csv=p=0 twice.ts | sed '/^$/d' | sort -u)" = klv ] || fail "other streams"
  # On a full disk, here of 1 KiB, what was there stays.
  echo kept >kept.hjif
  local status=0
  (ulimit -f 1 && trap '' XFSZ && exec "$PLAY" extract mux.mkv -o kept.hjif -f) >out 2>err || status=$?
  [ "$status" -eq 1 ] && [ "$(cat err)" = "tactile-track: cannot write 'kept.hjif': File too large" ] || fail "status $status: $(cat err)"
  [ "$(cat kept.hjif)" = kept ] && [ -z "$(find . -name '.kept*')" ] || fail "it was replaced: $(ls -a)"
  play extract "$work/film.mkv" -o none.vtt
  expect_status 1
  expect_line err 'carries no track'
}

# A full disk, an interrupt: nothing is left, and what was there stays.
mux_fails() {
  local pid status=0
  echo kept >out.mkv
  (ulimit -f 8 && trap '' XFSZ && exec "$PLAY" mux "$work/film.mkv" "$work/good.vtt" -o out.mkv) >out 2>err || status=$?
  [ "$status" -eq 1 ] || fail "status $status: $(cat err)"
  [ "$(wc -l <err)" -eq 1 ] || fail "$(cat err)"
  expect_only . out.mkv out err
  [ "$(cat out.mkv)" = kept ] || fail "it was replaced"
  # A program that waits in the place of one that copies.
  mkdir bin
  printf '#!/bin/sh\ntouch %q/copying\nexec sleep 60\n' "$PWD" >bin/mkvmerge
  chmod +x bin/mkvmerge
  for signal in INT TERM HUP; do
    rm -f copying
    # Commands in the background ignore SIGINT, those of nohup SIGHUP, which programs leave so.
    PATH=$PWD/bin:$PATH env --default-signal=INT,HUP "$PLAY" mux "$work/film.mkv" "$work/good.vtt" -o out.mkv >out 2>err &
    pid=$!
    until [ -e copying ]; do
      kill -0 "$pid" || fail "it ended: $(cat err)"
      sleep 0.02
    done
    kill -"$signal" "$pid"
    status=0
    wait "$pid" || status=$?
    [ "$status" -eq 130 ] || fail "$signal: status $status: $(cat err)"
    expect_only . out.mkv out err bin copying
  done
  [ "$(cat out.mkv)" = kept ] || fail "it was replaced"
  PATH=/nowhere "$PLAY" mux "$work/film.mkv" "$work/good.vtt" -o out.mkv >out 2>err && fail "without programs"
  expect_line err 'install the package ffmpeg'
}

# As by nohup: neither this program nor the one that copies ends.
ignored_signal() {
  local pid status=0
  mkdir bin
  printf '#!/bin/sh\necho $$ >copier.new && mv copier.new copier\nuntil [ -e go ]; do sleep 0.02; done\nexec %q "$@"\n' "$(command -v mkvmerge)" >bin/mkvmerge
  chmod +x bin/mkvmerge
  (trap '' HUP && PATH=$PWD/bin:$PATH exec "$PLAY" mux "$work/film.mkv" "$work/good.vtt" -o out.mkv) >out 2>err &
  pid=$!
  until [ -e copier ]; do
    kill -0 "$pid" || fail "it ended: $(cat err)"
    sleep 0.02
  done
  kill -HUP "$pid" "$(cat copier)"
  touch go
  wait "$pid" || status=$?
  [ "$status" -eq 0 ] || fail "status $status: $(cat err)"
  [ "$(subtitles_of out.mkv)" = "0,zxx" ] || fail "it has $(subtitles_of out.mkv)"
}

# A link stays one, and a file keeps its permissions.
links() {
  mkdir there
  cp "$work/good.vtt" there/real.vtt
  chmod 640 there/real.vtt
  ln -s there/real.vtt link.vtt
  track edit link.vtt --in-place --shift=1
  track edit "$work/good.vtt" -o expected.vtt --shift=1
  [ -L link.vtt ] || fail "the link is none any more"
  cmp expected.vtt there/real.vtt
  [ "$(stat -c %a there/real.vtt)" = 640 ] || fail "permissions $(stat -c %a there/real.vtt)"
  echo old >there/film.mkv
  chmod 604 there/film.mkv
  ln -s there/film.mkv film.mkv
  track mux "$work/film.mkv" "$work/good.vtt" -o film.mkv
  [ -L film.mkv ] && [ "$(stat -c %a there/film.mkv)" = 604 ] || fail "$(ls -l . there)"
  [ "$(subtitles_of there/film.mkv)" = "0,zxx" ] || fail "it has $(subtitles_of there/film.mkv)"
  expect_only there film.mkv real.vtt
}

# The film itself by another name: its URI.
film_by_uri() {
  cp "$work/film.mkv" "a film.mkv"
  play preview "file://$PWD/a%20film.mkv" "$work/good.vtt" -o "$PWD/a film.mkv"
  expect_status 2
  expect_line err 'is the film itself'
  cmp "$work/film.mkv" "a film.mkv"
}

# A part of a disc, which mkvmerge would complete by the next ones.
parts_of_a_disc() {
  ffmpeg -nostdin -v error -i "$work/film.mkv" -c:v mpeg2video -bf 2 -f vob VTS_01_1.VOB
  cp VTS_01_1.VOB VTS_01_2.VOB
  mkdir bin
  printf '#!/bin/sh\nexec false\n' >bin/ffmpeg # the other way to copy
  chmod +x bin/ffmpeg
  PATH=$PWD/bin:$PATH play mux VTS_01_1.VOB "$work/good.vtt" -o out.mkv
  [ "$status" = 0 ] || [ "$status" = 3 ] || fail "status $status: $(cat err)"
  [ "$(ffprobe -v error -select_streams v -count_packets -show_entries stream=nb_read_packets -of csv=p=0 out.mkv | tr -d ,)" = 180 ] || fail "other pictures"
}

# A recording whose times step back: the film begins at its first time, not at its least.
steps_back() {
  local part
  for part in 20 0; do
    ffmpeg -nostdin -v error -i "$work/film.mkv" -c copy -output_ts_offset "$part" -muxdelay 0 -f mpegts "$part.ts"
  done
  cat 20.ts 0.ts >film.ts
  play mux film.ts "$work/good.vtt" -o out.ts
  [ "$status" = 0 ] || [ "$status" = 3 ] || fail "status $status: $(cat err)"
  ffprobe -v error -select_streams d -show_entries packet=pts_time -of csv=p=0 out.ts >times
  # Its first cue is at 1 s or, silent, at 0 s.
  awk -F, 'NR == 1 && !($1 >= 20 && $1 <= 21.1) { exit 1 }' times && [ -s times ] || fail "the track begins at $(head -n 1 times)"
}

# A film with a track as its subtitles in a player, with tactorsink as the text sink, in real time.
players() {
  local source fake="fakesink sync=true"
  track author "$work/film.mkv" -o film.vtt -q
  track mux "$work/film.mkv" film.vtt -o carrier.mkv
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  for source in "uri=file://$PWD/carrier.mkv" "uri=file://$work/film.mkv suburi=file://$PWD/film.vtt"; do
    # shellcheck disable=SC2086
    timeout 60 gst-launch-1.0 -q playbin $source video-sink="$fake" \
      text-sink="tactileconverter ! tactorsink driver=simulator ramp-in=0 trace-location=player.trace" >log 2>&1 || fail "$(cat log)"
    cut -d, -f3- player.trace | sort -t, -n >player.csv
    expect_same_commands side player
  done
}

forms() {
  local form
  track author "$work/film.mkv" -o film.csv -q --rate 0 -r 4 -c 6
  for form in vtt hjif sem.xml; do
    track convert film.csv -o "there.$form"
    track convert "there.$form" -o back.csv
    # To half a percent. A format with times rounded down to milliseconds may differ by a part of
    # one.
    play diff film.csv back.csv --tolerance 0.51
    awk '/^[0-9.]+ - / { if ($3 - $1 > 0.0011) { print; exit 1 } }' out || fail "$form"
    track convert "there.$form" -o "again.$form"
    cmp "there.$form" "again.$form"
  done
  # One actuator: the strongest cell. The parts that are lost are printed.
  for form in haptic ahap funscript; do
    track convert film.csv -o "film.$form"
    grep -q "not in 'film.$form': the place of each vibration" err || fail "$form"
    "$PYTHON" -m json.tool "film.$form" >/dev/null
    track convert "film.$form" -o one.csv
    track convert one.csv -o "again.$form"
    track convert "again.$form" -o again.csv
    cmp one.csv again.csv
  done
  # Frequencies: kept, or told.
  track edit film.csv -o tuned.csv --frequency=120
  for form in vtt hjif haptic ahap; do
    track convert tuned.csv -o "tuned.$form"
    ! grep -q "frequenc" err || fail "$form"
  done
  track edit film.csv -o low.csv --frequency=40
  track convert low.csv -o low.haptic
  grep -q "not in 'low.haptic': some frequencies, such as 40 Hz, which is 65 Hz" err || fail haptic
  # The lowest sharpness is that of events without one.
  track convert low.csv -o low.ahap
  grep -q "not in 'low.ahap': the frequencies" err || fail ahap
  play diff tuned.csv low.csv
  expect_status 1
  expect_line out '  120 > 40 Hz$'
  for form in sem.xml funscript; do
    track convert tuned.csv -o "tuned.$form"
    grep -q "not in 'tuned.$form': the frequencies" err || fail "$form"
  done
}

edits() {
  track author "$work/film.mkv" -o film.vtt -q
  cp film.vtt before.vtt
  track edit film.vtt -o edited.vtt --prune-shorter=0.3 --shift=0.5 --scale=0.5 --mask=r0c0,r2c2
  cmp film.vtt before.vtt
  # The same in steps.
  track edit film.vtt -o a.csv --prune-shorter=0.3
  track edit a.csv -o b.csv --shift=0.5
  track edit b.csv -o c.csv --scale=0.5
  track edit c.csv -o stepwise.vtt --mask=r0c0 --mask=r2c2
  play diff edited.vtt stepwise.vtt
  expect_status 0
  # In the given order: levels are scaled, then pruned.
  track edit film.vtt -o order.vtt --scale=0.1 --prune-weaker=50
  track info order.vtt
  expect_line out '^Felt +0\.000 s'
  play diff film.vtt edited.vtt
  expect_status 1
  expect_line out 'r[0-2]c[0-2] [0-9]+ > [0-9]+'
  play diff film.vtt before.vtt
  expect_status 0
  track edit film.vtt --in-place --clip=1-2
  track info film.vtt
  expect_line out '^Length +1\.000 s'
  track edit edited.vtt -o coarse.csv --resample=1x1 --quantize=4 --merge=5 --limit=1,0.5 --silence=0-1 --overlay-max=before.vtt
  track info coarse.csv
  expect_line out '^Grid +1 x 1'
}

# What a designer wrote beside the maps stays, byte for byte, and what changes is what was asked for.
keeps_the_text() {
  local ends
  printf '%s\n' 'WEBVTT - by Andr\351' '' 'NOTE tactile grid=1x2 rate=5 by=hand' '' 'NOTE the storm begins here' '' STYLE '::cue { color: lime }' '' \
    'thunder 1' '00:00:01.000 --> 00:00:01.400 line:0' '  0  75' '' 'NOTE review: accepted' '' '00:00:02.000 --> 00:00:02.400' '50%   0' '' \
    '00:00:03.000 --> 00:00:04.000' 'what a blow!' >text
  for ends in '' 's/$/\r/'; do
    sed "$ends" text | sed 's/\\351/\xe9/' >notes.vtt
    track convert notes.vtt -o same.vtt
    cmp notes.vtt same.vtt
    track edit notes.vtt -o same.vtt --prune-shorter=0.01
    cmp notes.vtt same.vtt
    sed 's/00:00:04\.000/00:00:05.000/; s/00:00:03\.000/00:00:04.000/; s/00:00:02\./00:00:03./g; s/00:00:01\./00:00:02./g' notes.vtt >expected
    track edit notes.vtt -o later.vtt --shift=1
    cmp expected later.vtt
    cp notes.vtt place.vtt
    track edit place.vtt --in-place --shift=1
    cmp expected place.vtt
    sed 's/^  0  75/  0  60/; s/^50%   0/ 40   0/' notes.vtt >expected
    track edit notes.vtt -o softer.vtt --scale=0.8
    cmp expected softer.vtt
    track edit notes.vtt -o resampled.vtt --resample=2x2
    expect_line resampled.vtt '^NOTE tactile grid=2x2 rate=5 by=hand'
    expect_line resampled.vtt '^thunder 1'
    expect_line resampled.vtt '--> 00:00:01.400 line:0'
    expect_line resampled.vtt '^NOTE review: accepted'
  done
}

utf16() {
  local encoding
  for encoding in UTF-16 UTF-16LE UTF-16BE; do
    iconv -f UTF-8 -t "$encoding" "$work/good.vtt" >"$encoding.vtt"
    track convert "$encoding.vtt" -o back.vtt
    cmp "$work/good.vtt" back.vtt
    track convert "$work/good.vtt" -o good.csv
    iconv -f UTF-8 -t "$encoding" good.csv >"$encoding.csv"
    play diff "$encoding.csv" good.csv
    expect_status 0
  done
}

# Names are bytes: these are no UTF-8.
names_of_bytes() {
  local name=$'caf\xe9 "1" \\ %41'
  ln "$work/film.mkv" "$name.mkv"
  track author "$name.mkv" -o "$name.vtt" -q
  track edit "$name.vtt" -o "$name.2.vtt" --scale=0.5 --overlay-max="$name.vtt"
  play diff "$name.vtt" "$name.2.vtt"
  expect_status 0
  track convert "$name.vtt" -o "$name.csv"
  track validate "$name.csv"
  track info "$name.vtt"
  track plot "$name.vtt" -o "$name.png" --film "$name.mkv"
  track preview "$name.mkv" "$name.vtt" -o "$name.preview.mkv"
  track mux "$name.mkv" "$name.vtt" -o "$name.muxed.mkv"
  [ -s "$name.muxed.mkv" ] && [ -s "$name.preview.mkv" ] && [ -s "$name.png" ] || fail "not all is written: $(ls)"
}

# Nobody writes to these pipes.
pipes() {
  local command
  mkfifo pipe.vtt pipe.mkv
  for command in "validate pipe.vtt" "info pipe.vtt" "edit pipe.vtt -o kept.vtt --shift=1" "convert pipe.vtt -o kept.vtt" "edit $work/good.vtt -o kept.vtt --overlay-max=pipe.vtt" \
    "preview $work/film.mkv pipe.vtt -o kept.vtt.mkv" "mux $work/film.mkv pipe.vtt -o kept.vtt.mkv"; do
    # shellcheck disable=SC2086
    play $command
    [ "$status" = 1 ] || [ "$status" = 2 ] || fail "$command: $status"
    cat out err >said
    expect_line said 'got a pipe'
  done
  play author pipe.mkv -o none.vtt
  expect_status 1
  expect_line err 'is a pipe or a device'
  # Nor are they replaced.
  mkfifo pipe.png
  for command in "author $work/film.mkv -o pipe.vtt" "convert $work/good.vtt -o pipe.vtt" "edit $work/good.vtt -o pipe.vtt --shift=1" "plot $work/good.vtt -o pipe.png" \
    "preview $work/film.mkv $work/good.vtt -o pipe.mkv" "mux $work/film.mkv $work/good.vtt -o pipe.mkv"; do
    # shellcheck disable=SC2086
    play $command
    expect_status 1
    expect_line err 'got a pipe'
  done
  [ -p pipe.vtt ] && [ -p pipe.mkv ] && [ -p pipe.png ] || fail "a pipe is gone: $(ls -l)"
}

# Edits of the text itself: a cue deleted, a cue moved.
by_hand() {
  track author "$work/film.mkv" -o film.vtt -q
  awk 'BEGIN { RS = ""; ORS = "\n\n" } NR != 5' film.vtt >edited.vtt
  track validate edited.vtt
  play diff film.vtt edited.vtt
  expect_status 1
  expect_line out '^1 differences|^[0-9.]+ - [0-9.]+'
}

pictures() {
  track author "$work/film.mkv" -o film.vtt -q
  track plot film.vtt -o film.svg
  expect_line film.svg '<svg'
  track plot film.vtt -o film.png --film "$work/film.mkv"
  expect_strip film.png
  track preview "$work/film.mkv" film.vtt -o preview.mkv
  expect_recording preview.mkv 5.8 6.2
}

# On the chair, in real time.
chair() {
  track author "$work/film.mkv" -o film.vtt -q
  commands side "filesrc location=film.vtt ! subparse ! tactileconverter"
  track preview "$work/film.mkv" film.vtt --chair "driver=simulator ramp-in=0 trace-location=chair.trace"
  # a frame
  "$PYTHON" "$here/same_commands.py" side.trace chair.trace 0.016 34 || fail "the chair does not do what the track says"
}

batch() {
  mkdir films tracks
  cp "$work/film.mkv" films/one.mkv
  cp "$work/film.mkv" films/two.mkv
  head -c 1000 "$work/film.mkv" >films/broken.mkv
  play author films/*.mkv -o tracks
  expect_status 1
  expect_line err 'broken.mkv'
  expect_only tracks one.vtt two.vtt
  cmp tracks/one.vtt tracks/two.vtt
  touch -d '+1 hour' films/two.mkv
  play author films/one.mkv films/two.mkv -o tracks
  expect_status 0
  expect_line out 'tracks/one.vtt: up to date'
  expect_line out 'tracks/two.vtt: .* times real time'
}

# Interrupted after the first of a dozen tracks: existing files are complete, and the same command
# resumes.
interrupted() {
  local i pid status=0
  mkdir films
  for i in a b c d e f g h i j k l; do
    ln "$work/film.mkv" "films/$i.mkv" 2>/dev/null || cp "$work/film.mkv" "films/$i.mkv"
  done
  "$PLAY" author -j 1 films/*.mkv -o tracks >out 2>err &
  pid=$!
  until [ -e tracks/a.vtt ]; do
    kill -0 "$pid" || fail "it ended: $(cat err)"
    sleep 0.02
  done
  kill -INT "$pid"
  wait "$pid" || status=$?
  [ "$status" -eq 130 ] || fail "status $status; it said: $(cat out err)"
  [ ! -e tracks/l.vtt ] || fail "it was not stopped"
  [ "$(find tracks -name '.*.part' | wc -l)" -eq 0 ] || fail "$(find tracks)"
  track validate tracks/*.vtt
  track author films/*.mkv -o tracks
  expect_line out '^tracks/a.vtt: up to date$'
  [ "$(find tracks -name '*.vtt' | wc -l)" -eq 12 ] || fail "$(find tracks)"
}

# Files that a killed process left: the next one that writes the same file removes them. Those of
# others stay.
killed() {
  local dead
  sleep 0 &
  dead=$!
  wait "$dead"
  touch ".film.vtt.$(hostname).$dead.part" ".film.vtt.$(hostname).$$.part" ".film.vtt.elsewhere.$dead.part" ".other.vtt.$(hostname).$dead.part"
  track author "$work/film.mkv" -o film.vtt -q
  expect_only . film.vtt out err ".film.vtt.$(hostname).$$.part" ".film.vtt.elsewhere.$dead.part" ".other.vtt.$(hostname).$dead.part"
}

# An ordinary subtitle editor, by the library on which Gaupol is based: open, delete an event, shift
# all, save.
subtitle_editor() {
  track author "$work/film.mkv" -o film.vtt -q
  cp film.vtt edited.vtt
  "$PYTHON" - edited.vtt >opened <<'PYTHON'
import sys
import aeidon
project = aeidon.Project()
project.open_main(sys.argv[1], "utf_8")
print(project.main_file.format, len(project.subtitles))
felt = next(i for i, cue in enumerate(project.subtitles) if any(int(word) for word in cue.main_text.split()))
print("pruned", project.subtitles[felt].start_seconds, project.subtitles[felt].end_seconds)
project.remove_subtitles([felt])
project.shift_positions(None, aeidon.as_seconds(0.25))
project.save_main()
PYTHON
  expect_line opened '^WEBVTT [0-9]+$'
  track validate edited.vtt
  expect_line out '^edited.vtt: valid, 3 x 3, 6\.250 s$'
  # Shifted back, only the deleted cue differs: all differences are within its time and are to zero.
  track edit edited.vtt -o back.vtt --shift=-0.25
  play diff film.vtt back.vtt
  expect_status 1
  awk '/^pruned/ { begin = $2; end = $3 } /^[0-9.]+ - [0-9.]+ / { found++; if ($1 < begin || $3 > end || $NF != 0) { print; exit 1 } }
    END { exit found == 0 }' opened out || fail "other differences: $(cat opened out)"
}

# refuses STATUS PATTERN ARGUMENTS ...
refuses() {
  local expected=$1 pattern=$2
  shift 2
  echo kept >kept.vtt
  play "$@"
  expect_status "$expected"
  [ "$(wc -l <err)" -eq 1 ] || fail "not one line: $(cat err)"
  expect_line err "^tactile-track: .*$pattern"
  [ "$(cat kept.vtt)" = kept ] || fail "kept.vtt was changed"
}

# With our own film: these tests are not run where gst-launch-1.0 cannot load its plugin.
gst-launch-1.0 -q tactiletestsrc num-buffers=180 ! video/x-raw,width=320,height=240,framerate=30/1 ! x264enc speed-preset=ultrafast key-int-max=10 \
  ! matroskamux ! filesink location=film.mkv
printf 'WEBVTT\n\n00:01.000 --> 00:02.000\nWho is there?\n' >subtitles.vtt
printf 'WEBVTT\n\n00:01.000 --> 00:02.000\n1 2\n3 4\n' >good.vtt

printf 'WEBVTT\n\nNOTE tactile grid=3x3\n' >empty.vtt

echo '{}' >good.vtt.funscript

start author author_plays_as_the_film
start carriers carriers
start transport_stream transport_stream
start left_to_choice left_to_choice
start players players
start whole_film whole_film
start foreign_carriers foreign_carriers
start mux_fails mux_fails
start ignored_signal ignored_signal
start links links
start film_by_uri film_by_uri
start parts_of_a_disc parts_of_a_disc
start steps_back steps_back
start forms forms
start edits edits
start keeps_the_text keeps_the_text
start utf16 utf16
start names_of_bytes names_of_bytes
start pipes pipes
start by_hand by_hand
start pictures pictures
start chair chair
start batch batch
start interrupted interrupted
start killed killed
start subtitle_editor subtitle_editor
start no_command refuses 2 "no command 'sing'" sing
start no_film refuses 1 "there is no film" mux nowhere.mkv "$work/good.vtt" -o kept.vtt.mkv
start no_cues refuses 1 "empty.vtt' has no cues" mux "$work/film.mkv" "$work/empty.vtt" -o kept.vtt.mkv
start no_output refuses 2 "expected -o" author "$work/film.mkv"
start bad_form refuses 1 "'x.txt'" author "$work/film.mkv" -o x.txt
start bad_rows refuses 2 "--rows" author "$work/film.mkv" -o kept.vtt --rows=0
start subtitles refuses 1 "subtitles.vtt': line 4: .*'Who'" convert "$work/subtitles.vtt" -o kept.vtt
start overwrite refuses 2 "--in-place" edit "$work/good.vtt" -o "$work/good.vtt" --shift=1
start same_film refuses 2 "is the film itself" mux "$work/film.mkv" "$work/good.vtt" -o "$work/./film.mkv"
start bad_shift refuses 2 "--shift" edit "$work/good.vtt" -o kept.vtt --shift=soon
start bad_mask refuses 2 "no cell r9c9" edit "$work/good.vtt" -o kept.vtt --mask=r9c9
start bad_grid refuses 2 "--resample" edit "$work/good.vtt" -o kept.vtt --resample=0x65
start bad_clip refuses 2 "--clip" edit "$work/good.vtt" -o kept.vtt --clip=2-1
start funscript_in refuses 1 "an array .actions." convert "$work/good.vtt.funscript" -o kept.vtt
start bad_container refuses 2 "ends in .mkv" mux "$work/film.mkv" "$work/good.vtt" -o kept.avi
start bad_picture refuses 2 ".png or .svg" plot "$work/good.vtt" -o kept.jpg
finish
