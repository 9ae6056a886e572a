#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# po/POTFILES names the sources with texts, and each language has all of them.
#
# Usage: translations.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -lE '(^|[^[:alnum:]_])(_|N_|in_text)\(("|$)' tools/*/*.{cpp,h} lib/chair/*.cpp | sort >"$work/sources"
diff "$work/sources" po/POTFILES || { echo "expected these sources in po/POTFILES"; exit 1; }
mapfile -t options < <(grep -oE "'--[^']*'" po/meson.build | tr -d \')
xgettext "${options[@]}" --files-from=po/POTFILES --output="$work/all.pot" --language=C++
# No two buttons of a page have the same key; those of window.cpp, on and off, are never there at once.
keys() {
  msggrep --no-wrap -N "tools/visuotactile/$2.cpp" "$1" | sed -nE 's/^msgstr ".*_([[:alpha:]]).*/\L\1/p'
}
different_keys() {
  for page in chair_page film_page; do
    twice=$({ keys "$1" window | sort -u; keys "$1" "$page"; } | sort | uniq -d | tr '\n' ' ')
    [ -z "$twice" ] || { echo "in $2, these keys of $page.cpp are there twice: $twice"; exit 1; }
  done
}
msgen --output-file="$work/en.po" "$work/all.pot"
different_keys "$work/en.po" English
while read -r language; do
  msgfmt --check --output-file=/dev/null "po/$language.po"
  msgcmp "po/$language.po" "$work/all.pot"
  msgmerge --quiet --no-fuzzy-matching --output-file="$work/$language.po" "po/$language.po" "$work/all.pot"
  different_keys "$work/$language.po" "$language"
done <po/LINGUAS
