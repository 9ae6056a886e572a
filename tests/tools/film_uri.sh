#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The scripts in pipelines/ find a film with any name: gst-launch-1.0 opens the URI that film_uri
# makes.
# Usage: film_uri.sh TOOLS/BUILD.SH
set -euo pipefail
# shellcheck source=../../tools/build.sh
. "$1"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

failed=0
fail() {
  echo "$*"
  failed=$((failed + 1))
}

for name in film.mkv "a b.mkv" "%41#?;&=+,.mkv" "a\"b'c\\d.mkv" "!\$HOME\`x\`(*)[y]{z}.mkv" -e $'\xc3\xa9 \xff.mkv' $'two\nlines.mkv'; do
  gst-launch-1.0 -q videotestsrc num-buffers=1 ! pngenc ! filesink location=film >log 2>&1
  mv film "./$name"
  # A relative path, then an absolute one.
  for path in "$name" "$work/$name"; do
    uri=$(film_uri "$path")
    timeout 30 gst-launch-1.0 -q uridecodebin uri="$uri" ! fakesink >log 2>&1 || fail "$uri is not '$path': $(head -n 1 log)"
  done
  rm "./$name"
done

[ "$(film_uri "https://host/a film?b=c")" = "https://host/a film?b=c" ] || fail "a URI was changed"

# refuses STATUS PATH: one line, with that status
refuses() {
  local status=0
  (film_uri "$2") >out 2>err || status=$?
  [ "$status" -eq "$1" ] || fail "'$2': status $status instead of $1"
  if [ -s out ] || [ "$(wc -l <err)" -ne 1 ]; then
    fail "'$2': $(cat out err)"
  fi
}
refuses 2 ""
refuses 1 missing.mkv
refuses 1 .
[ "$failed" -eq 0 ]
