#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A catalog of films with GNU parallel: films in subfolders, names that are special to a shell, a
# damaged film, and an interrupted run that resumes.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"
PATH=$(dirname "$PLAY"):$PATH
catalogue=$here/../../pipelines/author-catalogue.sh

generated() {
  gst-launch-1.0 -q tactiletestsrc seed="$2" num-buffers=60 ! video/x-raw,width=160,height=120,framerate=30/1 \
    ! x264enc speed-preset=ultrafast ! matroskamux ! filesink location=made.mkv
  mkdir -p "$(dirname "$1")"
  mv made.mkv "$1"
}

generated films/one.mkv 1
generated "films/b/two three.mkv" 2
generated $'films/b/it\'s \$HOME; "four".mkv' 3
echo "This is no film." >films/broken.mp4

status=0
"$catalogue" --jobs 2 films tracks >out 2>err || status=$?
expect_status 1
expect_line out '^one\.mkv +2\.000 +[0-9]+ %$'
expect_line out '^b/two three\.mkv +2\.000'
expect_line out '^broken\.mp4 +no track: .+'
expect_line out '^1 without a track$'
[ "$(grep -c 'broken.mp4' err)" -ge 2 ] || fail "broken.mp4 was not tried twice: $(cat err)"
[ "$(find tracks -name '*.vtt' | wc -l)" -eq 3 ] || fail "$(find tracks)"

rm films/broken.mp4 tracks/one.mkv.vtt
"$catalogue" --jobs 2 films tracks >out 2>err || fail "$(cat out err)"
expect_line out 'two three.mkv.vtt: up to date'
expect_line out '^0 without a track$'
expect_line tracks/one.mkv.vtt 'grid=3x3 rate=5 profile=tuned sound=off version=.* sum='

# Other settings: drafts are made anew, but not what a designer has edited, nor what does not say what it was made with.
"$catalogue" films tracks -- --rows=2 >out 2>err || fail "$(cat out err)"
expect_line out '^0 without a track$'
expect_line tracks/one.mkv.vtt 'grid=2x3'
expect_line "tracks/b/two three.mkv.vtt" 'grid=2x3'
printf '\nNOTE mine\n' >>"tracks/b/two three.mkv.vtt"
sed -i 's/ profile=.*//' tracks/one.mkv.vtt
for options in --rate=4 --profile=paper --sound=film --columns=5; do
  cp -r tracks before
  "$catalogue" films tracks -- "$options" >out 2>err || fail "$(cat out err)"
  expect_line err "two three.mkv.vtt: kept, as it was edited since it was made with 'grid=2x3 rate=5 .*; expected .*--force"
  expect_line err "one.mkv.vtt: kept, as it may be edited, and does not say what it was made with; expected .*--force"
  cmp before/one.mkv.vtt tracks/one.mkv.vtt
  cmp "before/b/two three.mkv.vtt" "tracks/b/two three.mkv.vtt"
  ! cmp -s before/b/it*.vtt tracks/b/it*.vtt || fail "$options: the draft of before is still there"
  rm -r before
done
touch films/one.mkv "films/b/two three.mkv"
"$catalogue" films tracks -- --rows=2 >out 2>err || fail "$(cat out err)"
expect_line "tracks/b/two three.mkv.vtt" '^NOTE mine$'
"$catalogue" films tracks -- --force >out 2>err || fail "$(cat out err)"
expect_line tracks/one.mkv.vtt 'grid=3x3'
! grep -q mine "tracks/b/two three.mkv.vtt" || fail "--force keeps it"

# A task of a Slurm array has some of the films, in the list's order.
rm tracks/*.vtt tracks/b/*.vtt
for i in 0 1 2; do
  SLURM_ARRAY_TASK_ID=$i SLURM_ARRAY_TASK_COUNT=3 "$catalogue" --task films tracks -- -q
done
"$catalogue" --table films tracks >out || fail "$(cat out)"
expect_line out '^0 without a track$'

# An analysis that takes too long is stopped, twice.
cat >tactile-track <<END
#!/bin/sh
[ "\$1" != author ] || exec sleep 1000
exec "$(dirname "$PLAY")/tactile-track" "\$@"
END
chmod +x tactile-track
status=0
PATH=$work:$PATH "$catalogue" --limit 1s films tracks >out 2>err -- --rows=5 || status=$?
expect_status 0
[ "$(grep -c 'stopped after 1s' err)" -eq 6 ] || fail "$(cat err)"
rm tactile-track

# Impacts where nothing is to be seen: felt with the sound, at times between the blocks of 5 Hz.
mkdir impacts
gst-launch-1.0 -q videotestsrc pattern=black num-buffers=150 ! video/x-raw,width=160,height=120,framerate=30/1 \
  ! x264enc speed-preset=ultrafast ! matroskamux name=mux ! filesink location=impacts/impacts.mkv \
  tactilesoundtestsrc num-buffers=235 ! audioconvert ! mux.
"$catalogue" impacts tracks >out || fail "$(cat out err)"
expect_line out '^impacts\.mkv .* 0 %$'
"$catalogue" impacts tracks -- --force --sound=film >out || fail "$(cat out err)"
expect_line out '^impacts\.mkv .* [1-9][0-9]* %$'
expect_line tracks/impacts.mkv.vtt '^00:00:0[0-4]\.[0-9]*[1-9][0-9] -->|^00:00:0[0-4]\.[13579][0-9]{2} -->'
# Only what is seen, made stronger: nothing is seen.
"$catalogue" impacts tracks -- --force --sound=dialogue-heavy >out || fail "$(cat out err)"
expect_line out '^impacts\.mkv .* 0 %$'
# A film in two parts at the same time: until the second begins as in one piece, then nearly.
gst-launch-1.0 -q tactiletestsrc seed=5 num-buffers=1250 ! video/x-raw,width=160,height=120,framerate=5/1 \
  ! x264enc speed-preset=ultrafast key-int-max=25 ! matroskamux ! filesink location=long.mkv
tactile-track author -q long.mkv -o whole.csv
tactile-track author -q --parts=2 long.mkv -o parts.csv
expect_line parts.csv 'sound=off parts=2 version='
paste -d, <(tail -n +2 whole.csv) <(tail -n +2 parts.csv) | awk -F, '
  function off(a, b) { return a > b ? a - b : b - a }
  NR > 1 { lines++; later += $1 >= 125000
    for (i = 1; i <= NF / 2; i++) if (off($i, $(i + NF / 2)) > ($1 < 125000 ? 0 : 0.1)) { print $0; exit 1 } }
  END { if (lines < 100 || later < 50) exit 1 }' || fail "the parts differ: $(wc -l whole.csv parts.csv)"
# Shorter films have one part.
tactile-track author -q --parts=8 films/one.mkv -o one.csv
tactile-track author -q films/one.mkv -o two.csv
cmp <(tail -n +2 one.csv) <(tail -n +2 two.csv)
echo "a catalogue of 5 films: passed"
