#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes pages of docs/measured, each whole. Those of quality and speed are made by tactile_quality and speed.
#
# Usage: tests/bench/measured.sh PAGE [FILM ...]      PAGE: calibration, catalog, desk, devices, drafts, follow, listen, mux, playback, sound, sound-clips, sound-real, synth, timing, ways-out; FILM: default three of ../shared/data/clips (catalog, timing)
# Expects a computer on which nothing else runs. Takes 5, 15, 2, 5, 3, 24, 30, 3, 1, 8, 3, 2, 5, 15 and 1 minutes. VISUOTACTILE_BUILD names a build folder that is built already.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../../tools/build.sh
. "$here/../../tools/build.sh"
case ${1:-} in
  calibration | catalog | desk | devices | drafts | follow | listen | mux | playback | sound | sound-clips | sound-real | synth | timing | ways-out) page=$1 ;;
  *) sed -n '3,6s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
command="tests/bench/measured.sh $*"
shift
case $page in
  calibration) targets=tests/quality/rise_time_accuracy ;;
  catalog) targets=tools/tactile-track ;;
  desk) targets="tools/tactile-track-desk tools/tactile-track" ;;
  devices) targets=tests/bench/devices ;;
  drafts) targets="tools/visuotactile-follow tools/tactile-track lib/modules/visuotactile-websocket.so" ;;
  follow) targets="tests/bench/follow tools/visuotactile-follow" ;;
  listen) targets="tests/bench/listen tools/visuotactile-follow tools/tactile-track" ;;
  mux) targets=tools/tactile-track ;;
  sound) targets=tests/sound/sound_quality ;;
  sound-clips) targets=tools/tactile-track ;;
  sound-real) targets=tests/sound/sound_real ;;
  synth) targets=tests/bench/synth ;;
  timing) targets=tests/quality/rise_timing ;;
  ways-out) targets="tests/usb/usb-ways_out tests/usb/bare_player tools/tactor-guardian" ;;
esac
build_and_use
built=$(realpath "$built")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

head_of() { # TITLE
  local set
  for set in avx512f avx2 sse4_2; do
    ! grep -m 1 '^flags' /proc/cpuinfo | grep -qw "$set" || break
  done
  # shellcheck disable=SC2016 # backticks of Markdown
  printf '# %s\n\nMade by `%s`; do not edit.\n\n' "$1" "$command"
  printf '%s, %s CPUs, %s, load average %s; %s, %s.\n\n' "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)" "$(nproc)" "${set^^}" "$(cut -d ' ' -f 1 /proc/loadavg)" \
    "$(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release)" "$(gst-launch-1.0 --version | tail -n +2 | head -n 1)"
}

# Films on the pipeline's clock, with a simulated chair; rises with each compensation of two of them.
timing() { # FILM ...
  local film name compensation room="queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000"
  play() { # NAME COMPENSATION SOURCE ...
    # shellcheck disable=SC2086 # launch lines are words
    gst-launch-1.0 -q "${@:3}" ! saliencytactile ! tactileextractor name=x x.src ! $room ! fakesink sync=true \
      x.tactile ! $room ! tactorsink driver=simulator compensation="$2" trace-location="$work/$1, $2.csv"
  }
  for film in "$@"; do
    name=$(basename "$film" .mp4)
    for compensation in exact frame-block none; do
      echo "$name, $compensation" >&2
      play "$name" "$compensation" filesrc location="$film" ! decodebin
    done
  done
  echo "tactiletestsrc, exact" >&2
  play tactiletestsrc exact tactiletestsrc pattern=dynamic-motion num-buffers=750
  cat <<'CAPTION'
## Commands

Films play in real time on a simulated chair. The error is |issued − due|; a command is late after 5 ms.

| film, compensation | commands | late | error p50 | p99 | most |
|---|---|---|---|---|---|
CAPTION
  for film in "$work"/*exact.csv; do
    tail -n +2 "$film" | awk -F , '{ e = ($1 - $2) / 1e6; printf "%.6f\n", e < 0 ? -e : e }' | sort -n |
      awk -v film="$(basename "$film" .csv)" '{ e[NR] = $1; late += $1 > 5 } END {
        printf "| %s | %d | %d | %.2f ms | %.2f ms | %.2f ms |\n", film, NR, late, e[int((NR + 1) / 2)], e[int(0.99 * (NR - 1)) + 1], e[NR] }'
  done
  cat <<'CAPTION'

## Vibrations

The table has the time from the frame of a command until a simulated motor reaches 90 % of its level, for
each `compensation` of tactorsink.

CAPTION
  (cd "$work" && "$built/tests/quality/rise_timing" ./*.csv)
  cat <<'CAPTION'

## A busy computer

Other programs use all CPUs, with `tactorsink realtime=true` and `false` in turns. The last columns
include only commands whose maps arrived in time.

CAPTION
  "$here/busy.sh"
}

# The cost of tracks of many films, and of a film in parts.
catalog() { # FILM ...
  local film name seconds cpu track="$built/tools/tactile-track" parts
  cat <<'CAPTION'
## Cost

`tactile-track author --jobs=1`: CPU time with decoding, and the track's size. The last columns are 10,000 films of
two hours of that kind.

| film | × real time a core | KB an hour | 10,000 films: core hours | tracks |
|---|---|---|---|---|
CAPTION
  ffmpeg -v error -i "$1" -vf scale=1920:1080 -c:v libx264 -preset veryfast -an "$work/1080p.mp4"
  for film in "$@" "$work/1080p.mp4"; do
    name=$(basename "$film")
    seconds=$(ffprobe -v error -show_entries format=duration -of csv=p=0 "$film")
    cpu=$( { TIMEFORMAT='%U %S'; time "$track" author --quiet --jobs=1 "$film" -o "$work/$name.vtt" >&2; } 2>&1 | tail -n 1)
    awk -v name="$name, $(ffprobe -v error -select_streams v:0 -show_entries stream=width,height -of csv=p=0:s=x "$film")" -v film="$seconds" -v cpu="$cpu" -v bytes="$(stat -c %s "$work/$name.vtt")" \
      'BEGIN { split(cpu, used, " "); speed = film / (used[1] + used[2]); hour = bytes / film * 3.6
        printf "| %s | %.1f | %.0f | %.0f | %.1f GB |\n", name, speed, hour, 20000 / speed, hour * 20000 / 1e6 }'
  done
  cat <<'CAPTION'

## Parts of a film

All these films one after the other, three times, in one piece and in parts that are analyzed at the same time. Levels
are compared every 10 ms.

| parts | seconds elapsed | other levels | mean difference there | most | felt in only one |
|---|---|---|---|---|---|
CAPTION
  for film in "$@"; do
    ffmpeg -v error -i "$film" -vf 'scale=640:360,fps=24,setsar=1' -c:v libx264 -preset ultrafast -g 48 -an "$work/piece-$(basename "$film").mp4"
    echo "file '$work/piece-$(basename "$film").mp4'" >>"$work/pieces"
  done
  cat "$work/pieces" "$work/pieces" "$work/pieces" >"$work/list"
  ffmpeg -v error -f concat -safe 0 -i "$work/list" -c copy "$work/long.mp4"
  for parts in 1 2 4; do
    seconds=$( { TIMEFORMAT=%R; time "$track" author --quiet --parts="$parts" "$work/long.mp4" -o "$work/$parts.csv" >&2; } 2>&1 | tail -n 1)
    printf '| %s | %.0f | ' "$parts" "$seconds"
    /usr/bin/python3 "$here/track_difference.py" "$work/1.csv" "$work/$parts.csv"
  done
}

# Single steps, and what calibrations make of them.
calibration() {
  cat <<'CAPTION'
The tables have the errors of `tactor-calibrate` with simulated motors that have the paper's rise times,
in white noise between 0 and 4 kHz. Motors rise exponentially, as the square of that, or with two equal
time constants in series (second order).

## Single steps

The columns have the error of the time to 90 % of a step, by the ratio of its steady vibration to the
noise; that of the median of nine repetitions; and that of the first motion of rises from rest.

CAPTION
  printf '```\n'
  "$built/tests/quality/rise_time_accuracy" steps
  printf '```\n'
  cat <<'CAPTION'

## Calibrations

The table has the error of latency plus rise time to 1 V and more, for four motors with 0.5 to 1.25
times the paper's rise times. In rows of 1 V all rises are 20 dB above the noise, in rows of 3 V only
the strongest.

CAPTION
  printf '```\n'
  "$built/tests/quality/rise_time_accuracy" calibrations
  printf '```\n'
}

# The maps of a film's sound, in $work.
clip() { # FILM
  timeout 60 gst-launch-1.0 -q filesrc location="$1" ! decodebin caps=audio/x-raw expose-all-streams=false ! audioconvert ! soundtactile name=s \
    s.src ! queue ! fakesink sync=false s.tactile ! queue ! filesink async=false location="$work/$(basename "$1" .mp4).maps" >&2
  printf '| time | what | felt | strongest |\n|---|---|---|---|\n'
}

# The track of a film with a profile, in $work.
track_of() { # FILM PROFILE
  local track
  track=$work/$(basename "${1%.*}")-$2.csv
  [ -e "$track" ] || "$built/tools/tactile-track" author -q --sound="$2" "$1" -o "$track" >&2
  printf '%s\n' "$track"
}

# Pictures of what is felt of a film's picture, its sound and both, and the lines that show them.
tracks() { # FILM
  local name profile what=picture
  name=$(basename "$1" .mp4)
  for profile in off bass-shaker music; do
    # shellcheck disable=SC2046 # words
    "$built/tools/tactile-track" plot "$(track_of "$1" $profile)" -o "$root/docs/measured/sound-clips-$name-$what.png" $([ $what != picture ] || echo "--film $1")
    printf '\n![%s: felt of %s](sound-clips-%s-%s.png)\n' "$name" "${what/both/picture and sound}" "$name" "$what"
    if [ $what = picture ]; then what=sound; else what=both; fi
  done
}

# How well each profile fits the films' labels.
profiles() { # FILM ...
  local film name labels profile
  cat <<'CAPTION'

## Profiles

Precision, recall and the share of quiet time that is felt, against [labels](../../tests/quality/labels/README.md) of what a
viewer sees; nobody labeled the sound. The tracks are those of `tactile-track author --sound=PROFILE`.

| film | off | film | music | dialogue-heavy | bass-shaker |
|---|---|---|---|---|---|
CAPTION
  for film in "$@"; do
    name=$(basename "${film%.*}")
    labels=$root/tests/quality/labels/$name.csv
    [ -e "$labels" ] || labels=$root/tests/quality/labels/unseen/$name.csv
    printf '| %s |' "$name"
    for profile in off film music dialogue-heavy bass-shaker; do
      printf ' %s |' "$("$root/tests/sound/labels.py" "$labels" "$(track_of "$film" $profile)")"
    done
    printf '\n'
  done
}

out=$root/docs/measured/$page.md
{
  case $page in
    calibration)
      head_of "Calibration through noise"
      calibration
      ;;
    desk)
      head_of "The designer's desk"
      cat <<'CAPTION'
## Frames of the timeline

Chromium without a screen or a GPU, 1280 x 800, shows the timeline of a track of 20 000 cues in 67 minutes
on 3 x 3 cells, with a draft of equal size, thumbnails, sound, shot cuts and warnings. Its frames are
at least 16.7 ms apart. "Script" is the code of the page; CPU is the time of all threads of the
browser, of which two cores have 33.3 ms a frame.

CAPTION
      /usr/bin/python3 "$here/../desk/frames.py" 15
      printf '\n## Two hours\n\nThe same browser shows an H.264 film of two hours with sound and a key frame every two seconds.\n\n'
      TRACK="$built/tools/tactile-track" VISUOTACTILE_DESK="$built/tools/tactile-track-desk" VISUOTACTILE_DESK_PAGE="$root/tools/tactile-track-desk/page" \
        VISUOTACTILE_MODULES="$built/lib/modules" GST_PLUGIN_PATH_1_0="$built/gst" GST_REGISTRY_FORK=no /usr/bin/python3 "$here/../desk/two_hours.py"
      cat <<'CAPTION'

## An hour of editing

Chromium at 1366 x 768 is driven by real keys and a pointer that misses its target by 1.5 pixels (standard deviation),
with 12 s in view. After each edit the desk's track is compared with a model; an edit that is not as it was meant is
undone and tried again. Every 60 edits the track is saved and validated, every 100 the page is loaded again; in the end
the desk is started again under the open page, and all is undone. "Instead" is what wrong tries did.

CAPTION
      TRACK="$built/tools/tactile-track" VISUOTACTILE_DESK="$built/tools/tactile-track-desk" VISUOTACTILE_DESK_PAGE="$root/tools/tactile-track-desk/page" \
        VISUOTACTILE_MODULES="$built/lib/modules" GST_PLUGIN_PATH_1_0="$built/gst" GST_REGISTRY_FORK=no /usr/bin/python3 "$here/../desk/hour.py" 200
      cat <<'CAPTION'

## Beside its peers

The columns have what the desk's tests drive in Chromium; OpenFunscripter's [source](https://github.com/OpenFunscripter/OFS)
(read, not run: timeline and frames in `OFS-lib/UI`, undo in `OFS_UndoSystem.cpp`); Meta Haptics Studio by its
[walkthrough](https://developers.meta.com/horizon/documentation/unity/unity-haptics-studio-feature-walkthrough/); a usual
video editor as known from use, its snapping by [Premiere's events](https://developer.adobe.com/premiere-pro/uxp/ppro-reference/events/snapevent).
No user has compared them.

| | the desk | OpenFunscripter | Haptics Studio | a video editor |
|---|---|---|---|---|
| film | beside the timeline, splitters, full screen with the grid over it | windows that dock | none: sound only | windows that dock, full screen |
| motors | a row for each cell of a grid, its place beside it | a script for each axis | one or two clips | - |
| selection | time × any rows | time of one script | time of a clip | clips of any rows |
| tools | select, draw, paint, curve, cut: buttons and keys | modes; Shift and a click for a point | points and emphasis | select, cut and more |
| levels | blocks, painted, curves with points, in rows of 72 pixels by a key | points with lines between them | curves with points, frequency too | curves with points (keyframes) |
| curves in the file | steps of a frame: points are found again within 3 %, corners within a frame | points | points | points |
| wheel | pans; with Ctrl, zooms around the pointer | zooms around the playhead | zooms | pans; with Ctrl or Alt, zooms |
| snaps to | playhead, shot cuts, impacts of the sound, loop; not to other events' edges | frames | none known | playhead, edges, markers |
| whole film | a map with levels, warnings and the view | a heat map | the whole clip | a zoom bar |
| paint in real time | cells by mouse, keys or gamepad | keys or gamepad | none | none |
| feel while editing | chair, gamepad | devices by extensions | headset | - |
| limits of motors | warnings, list, next one by a key | none | none | - |
| draft from picture and sound | yes, with review cue by cue | by extensions | from sound | - |
| undo | without limit; after a reload or a restart, too (1 MiB) | without limit | yes | yes, ends with the program |
| after a crash | every edit is on the disk | backups at intervals | project file | backups at intervals |
| keyboard alone, screen reader | all, points of curves too; names and a table of cues | keys; no screen reader | not tested | in part |

`/usr/bin/python3 tests/desk/pictures.py FILM docs/images/desk` makes the guide's pictures, in the environment of the
desk's tests.
CAPTION
      ;;
    devices)
      head_of "Devices that people own"
      cat <<'CAPTION'
The measurement is on the side of the devices: an emulated Mega at 57600 baud, test servers of the
bHaptics Player and Buttplug protocols, written with another library, SDL's virtual gamepad, and the
monitor of PulseAudio's null sink, whose times are exact within 5 ms. It does not include the radio to
a real device, its motors and the buffer of a card. See also [ways out](ways-out.md) of a board,
[timing](timing.md) of a simulated one, and [sound for shakers](synth.md).

## Ways out

The table has the time until the motor stops after each event; at the end of stream, after the end of its
last map. SIGTERM ends gst-launch-1.0; a virtual gamepad belongs to the process that it would end (–).
`visuotactile-play --list-devices` lists boards, gamepads and sound cards; a query for a device behind a
server would disturb it.

CAPTION
      VISUOTACTILE_MODULES="$built/lib/modules" XDG_STATE_HOME=$work umockdev-wrapper "$built/tests/bench/devices" >"$work/tables" 2>&1 || { cat "$work/tables" >&2; exit 1; }
      grep -E '^\|' "$work/tables" | sed '/^| device | rises/,$d'
      cat <<'CAPTION'

## In time

Every 0.8 s, the film has a level of 40 to 100 % from rest. The error is the time from the frame of a map
until a motor with the paper's rise times, at the levels that the device received, reaches 90 %; a
shaker has tactoraudiosink's 25 ms. "Later by" has the sign of the error. A slow server takes 200 ms for
each message, while levels change 25 times a second; the column has the largest number of its messages in flight
until the end of the stream. Boards and gamepads send no answers, and a sound card receives no messages
(–). CPU is the share of a core of the process, including the emulated board.

CAPTION
      grep -E '^\|' "$work/tables" | sed -n '/^| device | rises/,$p'
      ;;
    drafts)
      head_of "Drafts, and nobody in the chair"
      cat <<'CAPTION'
## Drafts that are made while a film plays

mpv plays an H.264 film of 24 frames a second without a track: ten seconds of Sintel's trailer, scaled
up and repeated, with a key frame every ten seconds. The table has the time until the draft reaches the
position, the CPU time of visuotactile-follow until then, and its share of a core in the 20 s after each event, with
decoding. The seek goes to half a second before a key frame: all since the one before has to be decoded. The film is © Blender Foundation,
www.sintel.org, CC BY 3.0.

CAPTION
      FOLLOW="$built/tools/visuotactile-follow" GST_PLUGIN_PATH_1_0="$built/gst" VISUOTACTILE_MODULES="$built/lib/modules" \
        /usr/bin/python3 "$here/drafts.py" "$root/../shared/data/clips/sintel-trailer.mp4"
      cat <<'CAPTION'

## Nobody in the chair

The table has the time until the motors of a vest stop after each event, measured at a test server. A
simulated logind reports locks and sleep.

CAPTION
      FOLLOW="$built/tools/visuotactile-follow" TRACK="$built/tools/tactile-track" SERVER="$root/tests/support/haptic_server.py" SESSION="$built/data/session" \
        GST_PLUGIN_PATH_1_0="$built/gst" VISUOTACTILE_MODULES="$built/lib/modules" /usr/bin/python3 "$here/../tools/follow_service.py" ways_out | grep '^|'
      ;;
    follow)
      head_of "Following a player"
      cat <<'CAPTION'
## Players

Players show a film of 24 numbered frames a second on the screen of Xvfb. The error is the time at which a
simulated motor must have its level (by the trace of commands), minus the time at which the frame
appeared, from 3 s after each event on. The table has the median and the 95th percentile of its
magnitude. The time of a frame is exact within 3 ms. A real screen adds a delay. The sound goes to
PulseAudio's null sink. chromium-extended has the extension of
[examples/chromium](../../examples/chromium/position.js). Without it, each start, pause and seek has its own
error of up to 0.1 s.

CAPTION
      for player in mpv vlc kodi chromium chromium-extended; do
        FOLLOW="$built/tools/visuotactile-follow" GST_PLUGIN_PATH_1_0="$built/gst" /usr/bin/python3 "$here/../tools/follow.py" "$player" 30
        echo
      done
      cat <<'CAPTION'
## Sound

The delay is the time from a picture on the screen of Xvfb to its tone at PulseAudio's null sink, during 20
s from 3 s after each event on: median and range. The time of a tone is exact within 5 ms.

| player | after the start | after a pause | after a seek | all |
|---|---|---|---|---|
CAPTION
      for player in mpv vlc kodi chromium; do
        /usr/bin/python3 "$here/../tools/follow_sound.py" "$player"
      done
      echo
      cat <<'CAPTION'
## Reports of each kind

The estimator receives simulated reports of two hours with exponential delays of 2 or 3 ms each way and
sometimes up to 60 ms more. The table has p50 / p95 of the position error in ms, from 3 s after each
seek, pause or rate change on, and the share of that time in which the error bound is 0.12 s. A restless viewer
seeks, or pauses and perhaps changes the rate, each minute. The last columns have other methods on the
same reports: the median of the last 21 offsets between reported position and arrival, and that of
MultiFunPlayer, a third of the way to each report.

CAPTION
      "$built/tests/bench/follow"
      ;;
    mux)
      head_of "Copies of films with a track"
      cat <<'CAPTION'
What `tactile-track mux` makes of films that ffmpeg writes, and of those of ../shared/data/files. Whole: streams, packets, times, decoded
pictures, side data, names, languages, flags, chapters and attachments are those of the film, by ffprobe and by the
sums of ffmpeg's pictures, and the track begins at the film's 0:00. Without: the copy lacks this, which tactile-track names and
its status (3) says. No copy: it refuses (status 1).

CAPTION
      TRACK="$built/tools/tactile-track" /usr/bin/python3 "$here/../tools/mux_films.py" --all
      ;;
    playback)
      head_of "CPU time of playing a film"
      printf 'The table has the user and system time of all threads that decode an H.264 film, with and without
saliencytactile.\n\n'
      clip=$root/../shared/data/clips/sintel-trailer.mp4
      if [ -f "$clip" ]; then
        "$here/playback.sh" "$clip"
        printf '\nThe clip is © Blender Foundation, www.sintel.org, CC BY 3.0.\n'
      else
        "$here/playback.sh"
      fi
      ;;
    sound)
      head_of "Sound"
      cat <<'CAPTION'
What soundtactile makes of sounds with ground truth: impacts of 40 to 110 Hz with a crack of noise, at
constant power in one place, rumble, and voices. No sound is one from which the detector's weights
were [learned or chosen](../design/sound.md#impacts). The sounds are synthetic; [real sounds](sound-real.md) and
[the sound of two films](sound-clips.md) are others.

CAPTION
      "$root/tests/sound/speech.sh" "$work"
      "$built/tests/sound/sound_quality" "$work"/*.wav
      ;;
    listen)
      head_of "Films known by their sound"
      cat <<'CAPTION'
Titles are mixed of the music, voices and effects of 24 of Debian's games at other speeds, and of synthetic notes and
noise; no two have the same stretch of music or speech within 2 % of the same speed. Each is heard from a random place
on, in a synthetic room with as much direct sound as reverberation, and with noise, music of other games or other voices.
Two in five run at 25/24 or 24/25 of their speed, but for Chromaprint (`fpcalc -raw`), which looks for the fewest
different bits in 60 of the titles, 10 times a row. Right: the title, and the place within 150 ms. Errors are against the
true position, of all reports after the first.

CAPTION
      pool=${XDG_CACHE_HOME:-$HOME/.cache}/visuotactile-sounds
      "$root/tests/bench/listen_pool.sh" "$pool" >&2
      "$built/tests/bench/listen" "$pool/listen" "${@:-1000}"
      echo
      "$built/tests/bench/listen" --among 1000 "$pool/listen" 300 2
      cat <<'CAPTION'

## Commands against the picture

mpv plays a film on Xvfb's screen, and its sound in a room in PulseAudio (0.4 s, as above) whose monitor is the
microphone; noise is mixed into the sound. The error is the time at which a simulated motor must have its level, minus the
time at which the frame appeared: the median, and the 95th percentile of its magnitude, from 5 s after the film was
found on. A second follower has the position from mpv. Until felt: from the start or the seek.

| noise | after | until felt | by ear: pulses | p50 | p95 | by report: pulses | p50 | p95 |
|---|---|---|---|---|---|---|---|---|
CAPTION
      FOLLOW="$built/tools/visuotactile-follow" TRACK="$built/tools/tactile-track" GST_PLUGIN_PATH_1_0="$built/gst" /usr/bin/python3 "$here/../tools/follow_ear.py"
      ;;
    sound-real)
      head_of "Real sounds"
      cat <<'CAPTION'
Explosions, impacts, shots and footsteps of three games (Debian's scorched3d-data, teeworlds-data and
hedgewars-data), chosen by file name, unheard. The mixes have about 120 of them each, alone, over those games'
music, most of it with drums, and over people's voices, at 16 kHz, mono, with their peak at −3 dB of full scale.
The ratio is of an effect's first 100 ms to the rest. In the first table are F1 within 50 ms of the first 5 ms
within 15 dB of the loudest, and onsets a minute where no impact is. aubio and the envelope (10 ms louder than the
100 ms before) have in each column the best of their settings, as judged there.

CAPTION
      "$root/tests/sound/real_mixes.py" "${XDG_CACHE_HOME:-$HOME/.cache}/visuotactile-sounds" "$work/mixes" >&2
      "$built/tests/sound/sound_real" "$work/mixes" | tee "$work/tables"
      "$root/tests/sound/level_plot.py" <"$work/tables" >"$root/docs/measured/sound-real.svg"
      cat <<'CAPTION'

![the strongest level against the loudness, by class](sound-real.svg)

soundtactile looks 100 ms ahead where it holds sound back for a chair. An engine counts as felt if any of it is felt; the
last column has its share of time, with its soft begin and end, and engines without sound below 65 Hz.

## Before

The same sounds with the detector that had learned synthetic impacts only:

| detector | silence | music +6 dB | 0 dB | −6 dB | speech 0 dB | music alone, a minute | speech alone, a minute |
|---|---|---|---|---|---|---|---|
| soundtactile | 0.62 | 0.40 | 0.26 | 0.17 | 0.26 | 5.2 | 1.2 |

| sound | begin to be felt at −0 dB | −6 dB | −12 dB | −18 dB | −24 dB | −30 dB |
|---|---|---|---|---|---|---|
| explosion | 62 %, 0.59 | 50 %, 0.43 | 31 %, 0.23 | 12 %, 0.08 | 0 %, 0.00 | 0 %, 0.00 |
| impact | 74 %, 0.68 | 63 %, 0.49 | 46 %, 0.30 | 31 %, 0.16 | 14 %, 0.06 | 9 %, 0.02 |
| gun | 78 %, 0.75 | 61 %, 0.53 | 28 %, 0.20 | 33 %, 0.19 | 6 %, 0.02 | 0 %, 0.00 |
| footstep | 12 %, 0.09 | 0 %, 0.00 | 12 %, 0.06 | 12 %, 0.04 | 0 %, 0.00 | 0 %, 0.00 |

| sound | felt of the time | with rumble |
|---|---|---|
| music alone | 1.2 % | 13.3 % |
| speech alone | 0.1 % | 0.5 % |
| narrator | 0.6 % | 3.6 % |
| engine | 3.9 % | 7.7 % |
| explosion | 15.8 % | 40.4 % |
CAPTION
      ;;
    sound-clips)
      head_of "Sound of two films"
      clips=$root/../shared/data/clips
      felt=$root/tests/sound/clip_felt.py
      cat <<'CAPTION'
How much of the time the sound of two films is felt, by soundtactile with its defaults: all of what
is felt, cue by cue, and some of what is not. Nobody listened: what is heard was read from
spectrograms, what is seen from frames. The plots have a lane for each cell, the darker the stronger,
of the picture (`--sound=off`), of the sound alone (`bass-shaker`, at 6 dB more) and of both
(`music`). The films are © Blender Foundation, www.sintel.org and www.bigbuckbunny.org, CC BY 3.0.

## Sintel's trailer

CAPTION
      clip "$clips/sintel-trailer.mp4"
      "$felt" "$work/sintel-trailer.maps" 5-8.6 "noise that swells, as of wind; a walker in the snow" 9.4-12 "a boom that fades; the title “The Blender Foundation”" \
        16.6-18.8 "a boom; three shots of a fight, then black" \
        25.7-26.5 "a stroke and deep noise; a small dragon flies past ruins, a large one after it" 26.95-27.2 "a stroke in noise; the large dragon, close" \
        27.9-29.8 "strokes over deep noise; black between shots, then a woman who reaches out after the small dragon" \
        30.1-31.7 "high tones as of a cry, then noise; a claw has the small dragon, her face" 32.5-35.25 "deep noise that fades; the large dragon takes it away, white" \
        40.5-42.25 "a boom; the title “Sintel” appears over dunes" 44-46.5 "short strokes, ever closer together; the title stands" \
        46.7-50.1 "the loudest boom and its tail; black, then credits"
      tracks "$clips/sintel-trailer.mp4"
      cat <<'CAPTION'

### Where somebody speaks

The thresholds of rumble were chosen on this trailer: its figures tell what was reached, not what
another film may expect. The words of the lines are from memory. When they begin and end was read
from the harmonics of a spectrogram from 0 to 4 kHz, to about 0.05 s. Soft music is under all of them,
and the tail of a boom under the beginnings of the second and the fourth: these two are not speech
only. The man's pitch is 60 to 105 Hz, the woman's 135 to 250 Hz, as read from a spectrogram from 0 to
500 Hz. So all of their voices is above 50 Hz. The sound is split there, by filters of 48 dB an octave
forward and backward (`tests/sound/lines.sh`). What is above is the voices, without the deepest part of the boom.
The test `voices_of_film` demands that of it at most 10 % of each line is felt, and 4 % on average.

| time | what | felt | of what is above 50 Hz | of what is below |
|---|---|---|---|---|
CAPTION
      "$root/tests/sound/lines.sh" "$clips/sintel-trailer.mp4"
      printf '\n## Big Buck Bunny\n\n'
      clip "$clips/big-buck-bunny-5.1.mp4"
      "$felt" "$work/big-buck-bunny-5.1.maps" 0-10 "tones from 200 Hz up" 10-19.5 "music with bass" 20.2-20.5 "a short noise; a nut falls on a bird's head" \
        20.5-21 "a louder one, with much below 65 Hz; the bird is thrown off its branch" 21.5-21.85 "short noises; feathers come down"
      tracks "$clips/big-buck-bunny-5.1.mp4"
      cat <<'CAPTION'

Its channel for low frequency effects is silent, and nobody speaks.
CAPTION
      profiles "$clips"/{sintel-trailer,big-buck-bunny-5.1}.mp4 "$clips"/unseen/{explosion,cockatoo,moon,skyforce,mdn-{crystal,elf,monster},sintel-film-26s-848x480}.mp4 \
        "$clips"/unseen/{fox.mkv,sintel-film-20s-854x480.mpg}
      ;;
    synth)
      head_of "Sound for shakers"
      cat <<'CAPTION'
## CPU time

The pipeline `appsrc ! tactilesynth ! fakesink` converts a minute of maps at 30 frames a second; each map
changes all channels. The time is that of all threads. tactilesynth uses the base instructions of the
architecture, SSE2 on amd64.

CAPTION
      "$built/tests/bench/synth"
      cat <<'CAPTION'

## Beside a film's sound

A pipeline plays a sound to PulseAudio's null sink, and maps, or another sound, with the same envelope.
The table has the time between their half levels at the monitor of the sink. In one sink, this is
the error of tactilesynth. Separate sinks differ with each start, also for plain sounds: the sink that
receives its first samples later, for example after an audioconvert, plays earlier.

CAPTION
      "$here/../tools/synth_pulse.py"
      ;;
    catalog)
      head_of "Tracks of many films"
      [ $# -gt 0 ] || set -- "$root"/../shared/data/clips/{big-buck-bunny-5.1,sintel-trailer,unseen/moon,unseen/skyforce,unseen/sintel-film-26s-848x480}.mp4
      catalog "$@"
      ;;
    timing)
      head_of "Timing"
      [ $# -gt 0 ] || set -- "$root"/../shared/data/clips/{bottle,car,one-by-one-person}-detection.mp4
      timing "$@"
      ;;
    ways-out)
      head_of "Ways out"
      cat <<'CAPTION'
The table has the time until the motors stop after each event, on an emulated Mega with the seat firmware at
57600 baud. The watchdog of the firmware acts after 250 ms.

| event | until every motor is at zero |
|---|---|
CAPTION
      WAYS_OUT=all meson test -C "$built" --no-rebuild -t 10 -v ways_out | grep -oE '\| [^|]+ \| [0-9]+ ms \|$' >"$work/rows"
      grep -v -e '^| StandardFirmata: ' -e '^| SIG[A-Z0-9]*, ' "$work/rows"
      cat <<'CAPTION'

The same board has StandardFirmata, without a watchdog. After SIGKILL, SIGSEGV, `_exit()`, `quick_exit()`,
`exec()` and the second signal under `gst-launch-1.0 -e`, the guardian stops the motors.

| event | until every motor is at zero |
|---|---|
CAPTION
      sed -n 's/^| StandardFirmata: /| /p' "$work/rows"
      cat <<'CAPTION'

A player with default actions, StandardFirmata and no guardian receives two signals, one right after the other. The table
has the ms until every motor is at zero, which is before the process ends, by the first (row) and second (column) signal.

CAPTION
      sed -n 's/^| SIG\([A-Z0-9]*\), SIG\([A-Z0-9]*\) | \([0-9]*\) ms |$/\1 \2 \3/p' "$work/rows" | awk '
        !seen[$1]++ { order[++n] = $1 }
        { ms[$1, $2] = $3 }
        END {
          line = "|  |"; rule = "|---|"
          for (j = 1; j <= n; j++) { line = line " " order[j] " |"; rule = rule "---|" }
          print line; print rule
          for (i = 1; i <= n; i++) {
            line = "| " order[i] " |"
            for (j = 1; j <= n; j++) line = line " " ms[order[i], order[j]] " |"
            print line
          }
        }'
      ;;
  esac
} >"$work/page.md"
mv "$work/page.md" "$out"
