#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# For what it cannot do, visuotactile-play prints one line, returns a nonzero status and touches no
# file.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"

names=(visuotactile.mkv commands.csv strip.png)

# refuses STATUS PATTERN ARGUMENTS ...: that status, one line that matches PATTERN, and existing
# files stay
refuses() {
  local expected=$1 pattern=$2 name
  shift 2
  mkdir -p o
  for name in "${names[@]}"; do
    echo "kept $name" >"o/$name"
  done
  play "$@"
  expect_status "$expected"
  [ ! -s out ] || fail "on standard output: $(cat out)"
  [ "$(wc -l <err)" -eq 1 ] || fail "not one line: $(cat err)"
  expect_line err "^visuotactile-play: .*$pattern"
  expect_only o "${names[@]}"
  for name in "${names[@]}"; do
    [ "$(cat "o/$name")" = "kept $name" ] || fail "$name was changed"
  done
}

refuses_film() {
  refuses 1 "$1" -f -o o "$2"
}

folder_in_the_way() {
  mkdir -p p/strip.png
  refuses 1 "strip.png': expected a regular file, got a folder" -o p "$work/film.mkv"
  expect_only p strip.png
}

would_overwrite_itself() {
  mkdir p
  cp "$work/film.mkv" p/visuotactile.mkv
  ln -s p/visuotactile.mkv link.mkv
  refuses 1 "would overwrite the film" -o p link.mkv
  cmp p/visuotactile.mkv "$work/film.mkv"
  expect_only p visuotactile.mkv
}

unreadable() {
  cp "$work/film.mkv" secret.mkv
  chmod a-r secret.mkv
  if [ -r secret.mkv ]; then
    echo "not tested: root reads everything"
    return
  fi
  refuses_film "cannot read 'secret.mkv': Permission denied" secret.mkv
  mkdir -m a-w locked
  refuses 1 "cannot write to the folder 'locked'" -o locked "$work/film.mkv"
}

# Files of an earlier run stay.
exists() {
  local name
  for name in "${names[@]}"; do
    mkdir "$name"
    echo old >"$name/$name"
    refuses 1 "'$name/$name' exists; expected a folder without it, or --force" -o "$name" "$work/film.mkv"
    expect_only "$name" "$name"
    [ "$(cat "$name/$name")" = old ] || fail "$name was changed"
  done
}

# Like a full disk: no file may grow beyond a kilobyte.
disk_full() {
  trap '' XFSZ
  mkdir o
  echo kept >o/visuotactile.mkv
  status=0
  (ulimit -f 1 && exec timeout 30 "$PLAY" -f -q -o o "$work/film.mkv" 2>&1 >/dev/null) | cat >err || status=${PIPESTATUS[0]}
  expect_status 1
  expect_line err '^visuotactile-play: cannot write the recording: '
  expect_only o visuotactile.mkv
  [ "$(cat o/visuotactile.mkv)" = kept ] || fail "the recording was changed"
}

film film.mkv "$(picture 160 120) ! $h264 ! matroskamux"
film sound.wav "audiotestsrc num-buffers=20 ! wavenc"
film sound.ogg "$vorbis ! oggmux"
film still.png "$(picture 160 120 I420 1) ! videoconvert ! pngenc"
film still.jpg "$(picture 160 120 I420 1) ! jpegenc"
film late_index.mp4 "$(picture 160 120) ! $h264 ! mp4mux"
cut_film headless.mp4 late_index.mp4 50
cut_film header_only.mkv film.mkv 5
sed 's/V_MPEG4/V_XPEG4/' film.mkv >unknown_codec.mkv
echo "This is no film." >text.mkv
: >empty.mkv
mkdir folder.mkv

start still_png refuses_film "has no moving picture" "$work/still.png"
start still_jpg refuses_film "has no moving picture" "$work/still.jpg"
start audio_wav refuses_film "has no moving picture" "$work/sound.wav"
start audio_ogg refuses_film "has no moving picture" "$work/sound.ogg"
start text refuses_film "is not a film that GStreamer can decode" "$work/text.mkv"
start empty refuses_film "is not a film that GStreamer can decode" "$work/empty.mkv"
start headless refuses_film "is not a film that GStreamer can decode" "$work/headless.mp4"
start header_only refuses_film "header_only.mkv" "$work/header_only.mkv"
start unknown_codec refuses_film "needs plugins that are not installed: .* decoder; " "$work/unknown_codec.mkv"
start folder refuses_film "folder.mkv' is a folder" "$work/folder.mkv"
start missing refuses_film "there is no film 'missing.mkv'" missing.mkv
start missing_empty refuses_film "there is no film ''" ""
start missing_two_lines refuses_film "there is no film 'two lines.mkv'" $'two\nlines.mkv'
start missing_uri refuses_film "file:///missing.mkv" file:///missing.mkv
start unknown_uri refuses_film "nosuch://film" nosuch://film
start unreadable unreadable
start output_is_file refuses 1 "film.mkv" -o "$work/film.mkv" "$work/film.mkv"
start output_below_file refuses 1 "film.mkv" -o "$work/film.mkv/below" "$work/film.mkv"
start output_is_device refuses 1 "/dev/full" -o /dev/full "$work/film.mkv"
start output_empty refuses 1 "folder ''" -o "" "$work/film.mkv"
start folder_in_the_way folder_in_the_way
start would_overwrite_itself would_overwrite_itself
start disk_full disk_full
start exists exists

start unknown_option refuses 2 "--nonsense.*--help" -o o --nonsense
start two_films refuses 2 "one film.*--help" -o o "$work/film.mkv" "$work/film.mkv"
for value in 0 65 -1 abc 1.5 99999999999; do
  start "rows_$value" refuses 2 "--rows.*--help" -o o "--rows=$value" "$work/film.mkv"
  start "columns_$value" refuses 2 "--columns.*--help" -o o "--columns=$value" "$work/film.mkv"
done
for value in -1 nan inf 1001 fast; do
  start "rate_$value" refuses 2 "--rate.*--help" -o o "--rate=$value" "$work/film.mkv"
done
for value in 0 0.05 11 -1 nan much; do
  start "sensitivity_$value" refuses 2 "--sensitivity.*--help" -o o "--sensitivity=$value" "$work/film.mkv"
done
for value in -0.1 1.1 nan inf often; do
  start "density_$value" refuses 2 "--density.*--help" -o o "--density=$value" "$work/film.mkv"
done
start profile refuses 2 "--profile.*--help" -o o --profile x "$work/film.mkv"
start people refuses 2 "--people.*--help" -o o --people everyone "$work/film.mkv"
start camera refuses 2 "--camera.*--help" -o o --camera hard "$work/film.mkv"
start sound refuses 2 "--sound is one of off, film.*--help" -o o --sound loud "$work/film.mkv"
start compensation refuses 2 "--compensation.*--help" -o o --compensation x "$work/film.mkv"
start output_missing refuses 2 "--help" -o
finish
