#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Of each voice that speech.sh makes, something is felt for at most 1 % of its time, in silence and in noise.
#
# Usage: voices.sh SOUND_QUALITY
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$(dirname "$0")/speech.sh" "$work"
"$1" --only=voices "$work"/*.wav | tee "$work/table"
awk -F ' *[|] *' '/ % / { rows++; if ($4 + 0 > 1 || $5 + 0 > 1) { print "expected at most 1 %: " $0; bad = 1 } }
  END { if (rows != 16) { print "expected 15 voices and a sum, got " rows " rows"; bad = 1 } exit bad }' "$work/table"
