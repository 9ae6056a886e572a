#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds and runs the programs on a page: each block in C, C++ and Python, with a film as its
# argument. Each must end with status 0.
# launch_lines.sh and tests/tools/players.sh run its shell lines.
# Usage: recipes.sh PAGE SOURCE BUILD      (with the plugins on GST_PLUGIN_PATH; folders of the source and of the build)
set -euo pipefail
page=$1
library=$3/lib/gst/tactile
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

gst-launch-1.0 -q tactiletestsrc num-buffers=45 ! video/x-raw,width=160,height=120 ! jpegenc ! matroskamux ! filesink location="$work/film.mkv"
export LD_LIBRARY_PATH="$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
# Without a display, DirectFB's sink exits the program that tries it.
export GST_PLUGIN_FEATURE_RANK=dfbvideosink:NONE
unset DISPLAY WAYLAND_DISPLAY

count=0
# block LANGUAGE N: the Nth block of a language
block() {
  awk -v fence="\`\`\`$1" -v n="$2" '$0 == "```" { inside = 0 } inside && seen == n { print } $0 == fence { inside = 1; seen++ }' "$page"
}
run() {
  count=$((count + 1))
  if ! (cd "$work" && timeout 60 "$@" film.mkv) >"$work/log" 2>&1; then
    printf '%s: this fails:\n  %s\n' "$page" "$*"
    tail -n 20 "$work/log"
    exit 1
  fi
}

read -r -d '' -a flags < <(pkg-config --cflags --libs gstreamer-1.0 gstreamer-app-1.0 gstreamer-video-1.0) || true
for language in c cpp python; do
  for ((n = 1; ; n++)); do
    block "$language" "$n" >"$work/recipe.$language"
    [ -s "$work/recipe.$language" ] || break
    case $language in
      c) cc -Wall -Werror -o "$work/recipe" "$work/recipe.c" "${flags[@]}" ;;
      cpp) c++ -std=c++17 -Wall -Werror -I"$2/lib" -o "$work/recipe" "$work/recipe.cpp" -L"$library" -lgsttactile-1.0 "${flags[@]}" ;;
      python) printf '#!/bin/sh\nexec /usr/bin/python3 %s "$@"\n' "$work/recipe.python" >"$work/recipe" && chmod +x "$work/recipe" ;;
    esac
    run "$work/recipe"
  done
  [ "$n" -gt 1 ] || { echo "$page has no block in $language"; exit 1; }
done
echo "$count programs run"
