#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A manual page has each command of its program and, in the command's section, each option and what it does; and mandoc finds nothing wrong.
# Usage: man_pages.sh PROGRAM PAGE
set -euo pipefail
program=$1 page=$2
name=$(basename "$program")
failed=0
wrong() {
  echo "$name: $*"
  failed=$((failed + 1))
}

# help2man writes the date in words.
warnings=$(mandoc -T lint -W warning "$page" | grep -v 'cannot parse date' || true)
[ -z "$warnings" ] || wrong "$warnings"
text=$(mandoc -T utf8 -O width=1000 "$page" | sed -e 's/.\x08//g' -e 's/^ *//')
for section in NAME SYNOPSIS DESCRIPTION 'EXIT STATUS' 'SEE ALSO'; do
  grep -qx "$section" <<<"$text" || wrong "no section $section"
done

# expect_options TEXT COMMAND...: TEXT has what --help says of each option
count=0
expect_options() {
  local text=$1 option what
  shift
  while IFS=$'\t' read -r option what; do
    count=$((count + 1))
    # Short options and what they do are on one line.
    grep -A1 -F -- "$option" <<<"$text" | tr '\n' ' ' | grep -qF -- "$what" || wrong "'$*' has $option ($what), the page has not"
  done < <("$@" --help | sed -nE 's/^  (-[^ ].*[^ ])   *([A-Z].*)$/\1\t\2/p')
}
commands=$("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
for command in $commands; do
  section=$(sed -n "/^$name $command:\$/,\$p" <<<"$text" | sed '1d' | sed "/^$name [a-z]*:\$/,\$d")
  [ -n "$section" ] || wrong "no section of $command"
  expect_options "$section" "$program" "$command"
done
[ -n "$commands" ] || expect_options "$text" "$program"
[ "$count" -ge 4 ] || wrong "only $count options were found"
[ "$failed" -eq 0 ] && echo "$name: the page has all $count options"
