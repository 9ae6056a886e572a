#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Every command of every program accepts -f (--force) and -q (--quiet) and documents them. With -q
# it prints nothing if all is well. A wrong command has those suggested that are near.
# Expects the programs VISUOTACTILE_PLAY, TACTILE_TRACK, TACTOR_CALIBRATE and
# VISUOTACTILE_SETTINGS, and the plugins on GST_PLUGIN_PATH.
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
    grep -qE -- "^  $option +[A-Z]" help || wrong "${*##*/} does not document $option"
  done
}
# Commands from the program's help.
commands_of() {
  "$1" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'
}
takes_both "$VISUOTACTILE_PLAY"
count=1
for program in "$TACTILE_TRACK" "$TACTOR_CALIBRATE" "$VISUOTACTILE_SETTINGS"; do
  for command in $(commands_of "$program"); do
    takes_both "$program" "$command"
    count=$((count + 1))
  done
done
[ "$count" -ge 20 ] || wrong "only $count commands were found"

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
[ "$(wc -l <out)" -eq 1 ] || wrong "expected none.vtt alone: $(cat out)"
grep -q '^invalid: .*none.vtt' out || wrong "expected none.vtt alone: $(cat out)"

# ---- suggestions ----------------------------------------------------------------------------
# suggests TEXT PROGRAM WRONG: in one line, with status 2
suggests() {
  local status=0
  "$2" "$3" 2>err || status=$?
  [ "$status" -eq 2 ] && [ "$(wc -l <err)" -eq 1 ] && grep -qF -- "$1" err || wrong "${2##*/} $3 ends with $status: $(cat err)"
}
suggests "did you mean 'analyze'?" "$TACTOR_CALIBRATE" analyzee
suggests "did you mean 'mux'?" "$TACTILE_TRACK" muxx
suggests "expected one of measure, analyze, show, check" "$TACTOR_CALIBRATE" frobnicate

[ "$failed" -eq 0 ] && echo "$count commands take the same options"
