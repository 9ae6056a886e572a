#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# po/POTFILES names the sources with texts, and each language has all of them.
#
# Usage: translations.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -lE '[^a-z]_\("|in_text\($|in_text\("' tools/*/*.cpp | sort >"$work/sources"
diff "$work/sources" po/POTFILES || { echo "expected these sources in po/POTFILES"; exit 1; }
xgettext --from-code=UTF-8 --keyword=_ --keyword=N_ --keyword=in_text:1 --files-from=po/POTFILES --output="$work/all.pot" --language=C++
while read -r language; do
  msgfmt --check --output-file=/dev/null "po/$language.po"
  msgcmp "po/$language.po" "$work/all.pot"
done <po/LINGUAS
