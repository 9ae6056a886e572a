#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes what voices of espeak-ng and flite and a person say, a WAV file each. None was learned from or chosen by.
# The person's recordings are those of asterisk-core-sounds-en-g722 (tools/setup.sh).
#
# Usage: speech.sh FOLDER
set -euo pipefail
text="At breakfast nobody spoke. Then Tom dropped his cup, and everybody talked at once. Be quiet, please! Could
you pass the butter? Kate packed both cases, paid the bill and took a taxi to the port. Bad weather was coming; dark
clouds gathered above the pier. Don't panic, the captain said. Today we depart. Goodbye, and take good care of the dog."
speed=130
pitch=25
for voice in en-gb-x-gbcwmd+m3 en-us+f1 en+m4 en-gb-scotland+f3 en-029+m7 en-us+m2 en-gb-x-rp+f5 en-gb+m5; do
  espeak-ng -v "$voice" -s $speed -p $pitch -w "$1/$voice.wav" "$text"
  speed=$((speed + 10))
  pitch=$((pitch + 7))
done
for voice in awb kal kal16 rms slt; do
  flite -voice $voice -t "$text" -o "$1/flite-$voice.wav" 2>/dev/null
done
spoken=(/usr/share/asterisk/sounds/en_US_f_Allison/{demo,conf,dir}-*.g722)
ffmpeg -v error -f g722 -i "concat:$(IFS='|' && echo "${spoken[*]}")" -t 60 "$1/Allison.wav"
ffmpeg -v error -i "$1/Allison.wav" -ar 8000 "$1/Allison-8kHz.wav"
