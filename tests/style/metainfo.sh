#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The AppStream metadata and the menu entry are valid; their newest release is the project's version; the programs and the library that it names exist.
#
# Usage: metainfo.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
wrong() {
  echo "$file: $*"
  exit 1
}
version=$(sed -n "s/^  version: '\(.*\)',/\1/p" meson.build)
desktop-file-validate data/app/*.desktop
for file in data/app/*.metainfo.xml data/metainfo/org.visuotactile.visuotactile.metainfo.xml; do
  appstreamcli validate --no-net --pedantic "$file"
  newest=$(sed -n 's/.*<release version="\([^"]*\)".*/\1/p' "$file" | head -n 1)
  [ "$newest" = "$version" ] || wrong "expected $version as the first release, as in meson.build, got $newest"
  for program in $(sed -n 's/.*<binary>\(.*\)<.*/\1/p' "$file"); do
    [ -f "tools/$program/main.cpp" ] || wrong "there is no tools/$program"
  done
done
library=$(sed -n 's/.*<library>\(.*\)<.*/\1/p' "$file")
grep -q "^$library " debian/libgsttactile-1.0-0.symbols || wrong "$library is not the library of debian/*.symbols"
