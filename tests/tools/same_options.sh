#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Every command of every program accepts -f (--force) and -q (--quiet) and documents them. With -q
# it prints nothing if all is well.
# Expects the programs VISUOTACTILE_PLAY, TACTILE_TRACK and TACTOR_CALIBRATE, and the plugins on
# GST_PLUGIN_PATH.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

failed=0
wrong() {
  echo "$*"
  failed=$((failed + 1))
}

# ---- named and documented --------------------------------------------------------------------
# takes_both COMMAND...
takes_both() {
  local option
  "$@" --help >help 2>&1 || wrong "${*##*/} --help: $(cat help)"
  for option in '-f, --force' '-q, --quiet'; do
    grep -qE -- "^  $option +[A-Z]" help || wrong "${*##*/} does not tell of $option"
  done
}
# Commands from the program's help: two spaces, a word and its description.
commands_of() {
  "$1" --help | sed -nE 's/^  ([a-z]+) .*/\1/p'
}
takes_both "$VISUOTACTILE_PLAY"
count=1
for program in "$TACTILE_TRACK" "$TACTOR_CALIBRATE"; do
  for command in $(commands_of "$program"); do
    takes_both "$program" "$command"
    count=$((count + 1))
  done
done
[ "$count" -ge 14 ] || wrong "only $count commands were found"

# ---- quiet ----------------------------------------------------------------------------------
printf 'WEBVTT\n\n00:00.000 --> 00:01.000\n10 20\n30 40\n' >one.vtt
printf 'WEBVTT\n\n00:00.000 --> 00:01.000\n10 20\n30 50\n' >two.vtt
# silent STATUS ARGUMENT...: tactile-track prints nothing and returns that status
silent() {
  local expected=$1 status=0
  shift
  "$TACTILE_TRACK" "$@" >out 2>&1 || status=$?
  [ "$status" -eq "$expected" ] || wrong "tactile-track $* ends with $status instead of $expected: $(cat out)"
  [ ! -s out ] || wrong "tactile-track $* says: $(cat out)"
}
silent 0 info -q one.vtt
silent 0 validate -q one.vtt two.vtt
silent 0 diff -q one.vtt one.vtt
silent 1 diff -q one.vtt two.vtt
silent 0 convert -fq one.vtt -o one.csv
silent 0 convert -fq one.vtt -o one.csv
silent 0 edit -fq one.vtt -o edited.vtt --shift=1
silent 0 plot -fq one.vtt -o one.svg
echo no >none.vtt
"$TACTILE_TRACK" validate -q one.vtt none.vtt >out && wrong "none.vtt is valid"
[ "$(wc -l <out)" -eq 1 ] || wrong "of none.vtt alone was to be told: $(cat out)"
grep -q '^invalid: .*none.vtt' out || wrong "of none.vtt alone was to be told: $(cat out)"

[ "$failed" -eq 0 ] && echo "$count commands take the same options"
