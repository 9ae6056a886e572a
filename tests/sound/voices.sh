#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Of each voice that speech.sh makes, something is felt for at most 1.5 % of its time, in silence and in noise, and for at most 0.7 % of
# all. Known to be worse are recordings with knocks, steps and puffs of breath at the microphone: each has a bound of its own.
#
# Usage: voices.sh SOUND_QUALITY
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$(dirname "$0")/speech.sh" "$work"
"$1" --only=voices "$work"/*.wav | tee "$work/table"
awk -F ' *[|] *' 'BEGIN { known["cards"] = known["cards-8kHz"] = known["cards-above-80Hz"] = known["cards-8kHz-above-80Hz"] = 4
    known["commands-8kHz"] = 4.5; known["fr-Armelle"] = 2.5; known["commands-8kHz-above-80Hz"] = 3; known["all unfiltered"] = 0.7 }
  /^[|].* % / { rows++; most = $2 in known ? known[$2] : 1.5
  if ($4 + 0 > most || $5 + 0 > most) { print "expected at most " most " %: " $0; bad = 1 } }
  END { if (rows != 37) { print "expected 36 voices and a sum, got " rows " rows"; bad = 1 } exit bad }' "$work/table"
