#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Of each voice that speech.sh makes, something is felt for at most 1 % of its time, in silence and in noise. Known to be worse are
# recordings with steps, puffs of breath and knocks at the microphone, and one announcer at 8 kHz (docs/measured/sound.md): each has a
# bound of its own.
#
# Usage: voices.sh SOUND_QUALITY
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$(dirname "$0")/speech.sh" "$work"
"$1" --only=voices "$work"/*.wav | tee "$work/table"
awk -F ' *[|] *' 'BEGIN { known["cards"] = known["cards-8kHz"] = 8; known["commands"] = known["commands-8kHz"] = 5
    known["cards-above-80Hz"] = known["cards-8kHz-above-80Hz"] = known["fr-Armelle"] = known["it-Menardi"] = 4; known["Allison-es-8kHz"] = 1.5 }
  /^[|].* % / { rows++; most = $2 in known ? known[$2] : 1
  if ($4 + 0 > most || $5 + 0 > most) { print "expected at most " most " %: " $0; bad = 1 } }
  END { if (rows != 37) { print "expected 36 voices and a sum, got " rows " rows"; bad = 1 } exit bad }' "$work/table"
