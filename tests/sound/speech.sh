#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes what voices of espeak-ng and flite and people say, a WAV file each. None was learned from or chosen by.
# The people's recordings are those of Debian's packages asterisk-core-sounds-{en,es}-g722, alsa-utils, asterisk-prompt-es-co,
# asterisk-prompt-fr-armelle, asterisk-prompt-it-menardi-wav and pocketsphinx-testdata (tools/setup.sh).
#
# Of those that are less clean, and of telephones, it writes what is above 80 Hz, too.
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
join=$(dirname "$0")/join.py
asterisk=/usr/share/asterisk/sounds
sphinx=/usr/share/pocketsphinx/test/data
"$join" 16000 "$1/Allison.wav" $asterisk/en_US_f_Allison/{demo,conf,dir}-*.g722
"$join" 16000 "$1/Allison-es.wav" $asterisk/es_MX_f_Allison/{demo,conf,dir}-*.g722
"$join" 48000 "$1/ALSA.wav" /usr/share/sounds/alsa/{Front,Rear,Side}_*.wav
"$join" 16000 "$1/LibriVox.wav" $sphinx/librivox/*.wav
"$join" 16000 "$1/cards.wav" $sphinx/cards/*.wav
"$join" 16000 "$1/commands.wav" $sphinx/{goforward,numbers,something}.raw
for voice in Allison Allison-es ALSA LibriVox cards commands; do
  ffmpeg -v error -i "$1/$voice.wav" -ar 8000 "$1/$voice-8kHz.wav"
done
"$join" 8000 "$1/es-co.wav" $asterisk/es/{conf,dir}-*.gsm
"$join" 8000 "$1/fr-Armelle.wav" $asterisk/fr/{conf,dir}-*.gsm
"$join" 8000 "$1/it-Menardi.wav" $asterisk/it_IT_f_Menardi/{demo,conf,dir}-*.wav
for voice in Allison-es-8kHz es-co fr-Armelle it-Menardi {cards,commands}{,-8kHz}; do
  "$(dirname "$0")/split.py" 80 "$1/$voice.wav" "$1/below" "$1/$voice-above-80Hz.wav"
done
rm "$1/below"
