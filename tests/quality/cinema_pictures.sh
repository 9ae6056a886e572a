#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Draws what a build feels in the films with labels: FILM-track-NAME.png, a lane for each tactor over time, with the labels behind;
# FILM-moments-NAME.png, ten felt moments drawn at random (the same for one track); FILM-worst-NAME.png, the twenty worst moments.
# Usage: tests/quality/cinema_pictures.sh BUILD CLIPS OUT NAME     BUILD: a build folder, also of another commit
# DRAW: the program that draws; by default of this tree's folder build.
set -euo pipefail
build=${1:?the build folder whose analysis is drawn} clips=${2:?the folder with the films} out=${3:?the folder for the pictures}
name=${4:?a name for the build, such as before}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
draw=${DRAW:-$here/../../build/tests/quality/track_picture}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir -p "$out"
for labels in "$here"/labels/*.csv "$here"/labels/unseen/*.csv; do
  film=$(basename "$labels" .csv)
  file=$(find "$clips" -maxdepth 2 -name "$film.*" ! -name '*.csv' | sort | head -n 1)
  [[ $file ]] || continue # another set of films
  GST_PLUGIN_PATH=$build/gst GST_REGISTRY_1_0=$work/registry \
    "$build/tools/tactile-track" author -q --rate=0 "$file" -o "$work/$film, $name.csv"
  "$draw" "$work/$film, $name.csv" "$labels" "$out/$film-track-$name.png"
  "$draw" "$work/$film, $name.csv" "$labels" "$out/$film-moments-$name.png" "$file" || echo "$film: no moments"
  "$draw" "$work/$film, $name.csv" "$labels" "$out/$film-worst-$name.png" "$file" worst || echo "$film: nothing is wrong"
done
