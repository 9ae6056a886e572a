#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The players of pipelines/ on a display: each shows a film and drives a simulated chair.
# Needs Xvfb and the players, which tools/setup.sh installs. Expects ROOT (of the source),
# VISUOTACTILE_BUILD, TRACK (tactile-track) and SETTINGS (visuotactile-settings).
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"
: "${ROOT:?root of the source}" "${VISUOTACTILE_BUILD:?folder of the build}" "${TRACK:?the path of tactile-track}" "${SETTINGS:?the path of visuotactile-settings}"

for program in Xvfb gst-play-1.0 gst123 totem parole clapper dbus-run-session; do
  command -v "$program" >/dev/null || fail "there is no $program: run tools/setup.sh"
done

mkfifo number
Xvfb -displayfd 3 -noreset -nolisten tcp -screen 0 640x480x24 3>number >xvfb.log 2>&1 &
server=$!
trap 'kill "$server" 2>/dev/null; rm -rf "$work"' EXIT
read -r -t 20 display <number || fail "Xvfb does not start: $(cat xvfb.log)"
export DISPLAY=:$display
chair="driver=simulator analysis::temporal=false trace-location=commands.csv"

# shows SCRIPT ARGUMENT ...: ends with status 0, and the chair gets commands
shows() {
  CHAIR=$chair timeout 60 "$ROOT/pipelines/$1" "${@:2}" >out 2>&1 || fail "status $?; it said: $(cat out)"
  expect_commands commands.csv
}

# A film that carries a designer's track: in gst-play-1.0 the chair gets the track's commands,
# except for a cue. The draft is halved and has a silent part in the middle, so it differs from the
# analysis.
own_track() {
  "$TRACK" author "$1" -o draft.vtt -q
  "$TRACK" edit draft.vtt -o film.vtt --scale=0.5 --mask=r1c1
  "$TRACK" mux "$1" film.vtt -o carrier.mkv
  timeout 60 gst-launch-1.0 -q filesrc location=film.vtt ! subparse ! tactileconverter ! tactorsink driver=simulator sync=false trace-location=direct.csv
  chair="driver=simulator tactors::ramp-in=0 trace-location=commands.csv"
  shows gst-play.sh "$PWD/carrier.mkv" --no-interactive
  "$PYTHON" "$here/same_commands.py" direct.csv commands.csv 0.016 200 || fail "the player does not play the track: $(cat out)"
}

# Subtitles to read, with tactilesubtitles in the player: the chair's commands are those without
# subtitles. A busy machine skips frames, but subtitles mistaken for maps would change nearly the
# whole film.
words() {
  printf '1\n00:00:00,100 --> 00:00:01,900\n42\nis no map of a track\n' >film.srt
  gst-launch-1.0 -q matroskamux name=mux ! filesink location=subtitled.mkv filesrc location="$1" ! matroskademux ! queue ! mux. \
    filesrc location=film.srt ! subparse ! text/x-raw ! queue ! mux.subtitle_0
  shows gst-play.sh "$PWD/subtitled.mkv" --no-interactive
  cp commands.csv with.csv
  shows gst-play.sh "$1" --no-interactive
  "$PYTHON" "$here/same_commands.py" commands.csv with.csv 0.016 400 || fail "the subtitles change what is felt: $(cat out)"
}

terminal() {
  timeout 60 "$ROOT/pipelines/terminal.sh" "$1" >out 2>&1 || fail "status $?; it said: $(cat out)"
  expect_line out '▓|█'
}

# Players in the background write the file debug.
export_debug() {
  export GST_DEBUG=visuotactilesink:4,tactorsink:6 GST_DEBUG_NO_COLOR=1 GST_DEBUG_FILE=$PWD/debug
}

# Whether motors got commands, ten times: commands a second late, as at first on a busy machine, are
# dropped.
felt() {
  [ -e debug ] && [ "$(grep -c 'map at .*: [1-9][0-9]* commands' debug)" -ge 10 ]
}

# Waits for commands, ends the player once, and expects zeros.
live() {
  local player
  export_debug
  CHAIR=$chair timeout --foreground --preserve-status -s INT 60 "$ROOT/pipelines/live.sh" "$@" >out 2>&1 &
  player=$!
  while kill -0 "$player" 2>/dev/null && ! felt; do
    sleep 0.2
  done
  kill -INT "$player" 2>/dev/null || true
  wait "$player" || fail "status $?; it said: $(cat out)"
  expect_commands commands.csv
}

# shown_and_felt PROCESS: waits until its window shows the film's gray and there are commands, or
# until it ends; sets level, a pixel's
shown_and_felt() {
  level=0
  while kill -0 "$1" 2>/dev/null; do
    # A pixel of the background.
    plain env -u GST_DEBUG -u GST_DEBUG_FILE gst-launch-1.0 -q ximagesrc num-buffers=1 startx=5 starty=5 endx=5 endy=5 ! videoconvert ! \
      video/x-raw,format=GRAY8 ! filesink location=pixel || true
    level=$(od -An -tu1 -N1 pixel | tr -d ' ')
    [ "${level:-0}" -le 40 ] || ! felt || break
    sleep 0.2
  done
}

expect_shown_and_felt() {
  grep -q 'shown by' debug || fail "the player does not use visuotactilesink: $(cat out)"
  felt || fail "nothing is felt: $(tail -n 5 debug)"
  [ "${level:-0}" -gt 40 ] || fail "its window shows nothing: a pixel of $level"
}

# A player without any knowledge of touch, in the terminal that it needs: its window shows the
# film's gray, and the chair gets maps. The player must be in the terminal's foreground. A shell or
# timeout in between may put it in the background, where setting up the terminal stops it. Hence a
# pseudo-terminal that starts nothing else.
any_player() {
  local player
  export_debug
  TERM=xterm timeout 60 "$PYTHON" -c 'import pty, sys; pty.spawn(sys.argv[1:])' "$ROOT/pipelines/any-player.sh" gst123 --repeat "$1" >out 2>&1 </dev/null &
  player=$!
  shown_and_felt "$player"
  kill "$player" 2>/dev/null || true
  wait "$player" 2>/dev/null || true
  expect_shown_and_felt
}

# own_sink NAME COMMAND...: players that choose their own video sink. Switched on by their NAME,
# visuotactiledecoder is taken as the decoder, and the chair gets maps, `until` it is as that
# function says. The player's settings stay in this folder.
own_sink() {
  local player
  export_debug
  export GST_DEBUG=visuotactiledecoder:4,tactorsink:6 XDG_CONFIG_HOME=$PWD/config
  "$SETTINGS" on "$1" >out
  "$SETTINGS" set driver=simulator >out
  shift
  HOME=$PWD XDG_RUNTIME_DIR=$PWD GDK_BACKEND=x11 LIBGL_ALWAYS_SOFTWARE=1 timeout 60 dbus-run-session -- "$@" >out 2>&1 &
  player=$!
  while kill -0 "$player" 2>/dev/null && ! "$until"; do
    sleep 0.2
  done
  kill "$player" 2>/dev/null || true
  wait "$player" 2>/dev/null || true
  grep -q ' decodes ' debug || fail "the player does not use visuotactiledecoder: $(cat out)"
  felt || fail "nothing is felt: $(tail -n 5 debug)"
  "$until" || fail "not as it should be, $until: $(tail -n 5 debug)"
}
until=felt

# A page with two films: one has the chair, the other tells so and plays on.
one_of_two_felt() {
  felt && grep -q 'another film is felt' debug
}

# A film without a picture, in a player that is switched on: it plays to the end, and needs no chair.
sound_alone() {
  gst-launch-1.0 -q audiotestsrc num-buffers=40 samplesperbuffer=1102 ! audio/x-raw,rate=44100,channels=1 ! vorbisenc ! oggmux ! filesink location=sound.ogg
  export_debug
  export GST_DEBUG=visuotactiledecoder:4 XDG_CONFIG_HOME=$PWD/config
  "$SETTINGS" on gst-play-1.0 >out
  timeout 60 gst-play-1.0 --no-interactive --audiosink=fakesink "$@" "$PWD/sound.ogg" >out 2>&1 || fail "status $?; it said: $(cat out)"
  expect_line out 'Reached end of play list'
  ! grep -q ' decodes ' debug || fail "sound is decoded with a chair"
}

# Frames in GPU memory (Mesa's software renderer) from source to window. The window gets them
# unchanged, and the analysis reads its own copy.
gl_memory() {
  local player
  export_debug
  # shellcheck disable=SC2086 # properties
  LIBGL_ALWAYS_SOFTWARE=1 timeout --foreground --preserve-status 60 gst-launch-1.0 -e tactiletestsrc pattern=dynamic-motion ! \
    video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! glupload ! 'video/x-raw(memory:GLMemory)' ! visuotactilesink video-sink=glimagesink $chair >out 2>&1 &
  player=$!
  shown_and_felt "$player"
  kill -INT "$player" 2>/dev/null || true
  wait "$player" || fail "status $?; it said: $(cat out)"
  expect_shown_and_felt
  expect_commands commands.csv
}

# Both scripts of the theatre. tests/theatre tests seats over a bad network.
theatre() {
  local maps clock seat
  read -r maps clock < <("$PYTHON" -c 'import socket; s = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in "12"]; [x.bind(("127.0.0.1", 0)) for x in s]; print(*(x.getsockname()[1] for x in s))')
  "$ROOT/pipelines/theatre-seat.sh" 127.0.0.1 --group 0.0.0.0 --port "$maps" --clock-port "$clock" --chair "driver=simulator trace-location=commands.csv" >seat 2>&1 &
  seat=$!
  timeout 60 "$ROOT/pipelines/theatre-server.sh" "$1" --to "127.0.0.1:$maps" --clock-port "$clock" --analysis temporal=false \
    --video-sink "fakesink sync=true" --audio-sink fakesink >out 2>&1 || fail "status $?; it said: $(cat out)"
  kill "$seat"
  wait "$seat" || fail "status $?; it said: $(cat seat)"
  expect_commands commands.csv
}

make() {
  gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion num-buffers="$2" ! video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! jpegenc ! matroskamux ! filesink location="$1"
}
make film.mkv 60
make theatre.mkv 240
make moving.mkv 180

start gst-play shows gst-play.sh "$work/film.mkv" --no-interactive
start own_track own_track "$work/moving.mkv"
start words words "$work/film.mkv"
start playbin shows playbin.sh "$work/film.mkv" playbin
start playbin3 shows playbin.sh "$work/film.mkv" playbin3
# shellcheck disable=SC2086 # properties
start gstplay shows gstplay.sh "$work/film.mkv" $chair
start terminal terminal "$work/film.mkv"
start live live
start sound_alone sound_alone
start sound_alone3 sound_alone --use-playbin3
start theatre theatre "$work/theatre.mkv"
start least_delay live --least-delay
finish
# These check the screen, one after the other. meson's MALLOC_PERTURB_ shows a use after free in
# Mesa's software renderer, which ends players now and then.
unset MALLOC_PERTURB_
start any_player any_player "$work/film.mkv"
finish
for player in totem parole; do
  start "$player" own_sink "$player" "$player" "$work/moving.mkv"
  finish
done
# Clapper 0.5 is a script behind a link, by whose name it goes.
start clapper own_sink "$(basename "$(readlink -f "$(command -v clapper)")")" clapper "$work/moving.mkv"
finish
start gtk own_sink "$(basename "$(readlink -f "$PYTHON")")" "$PYTHON" "$here/video_in_gtk.py" "$work/moving.mkv"
finish
gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion num-buffers=180 ! video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! \
  x264enc speed-preset=ultrafast ! mp4mux ! filesink location=moving.mp4
until=one_of_two_felt
start webkit own_sink WebKitWebProcess "$PYTHON" "$here/video_in_page.py" "$work/moving.mp4" "$work/moving.mp4"
until=felt
finish
start gl_memory gl_memory
finish
