#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes what several of espeak-ng's voices say, a WAV file each.
#
# Usage: speech.sh FOLDER
set -euo pipefail
text="The inspector examined every drawer, but the documents were gone. Who did this? Benjamin tapped the table twice.
Down by the docks, people talk. Go! Get the doctor before it is too late. Don't touch that. Bring a torch, a rope and two
bottles of water. Today's paper reports a bank robbery in Detroit. Keep calm, take a deep breath, and begin again."
speed=130
pitch=25
for voice in en-gb-x-rp en-us+m1 en+f1 en-gb-x-gbclan+m8 en-029 en-us+f2 en+m6 en-gb-x-gbcwmd+f4; do
  espeak-ng -v "$voice" -s $speed -p $pitch -w "$1/$voice.wav" "$text"
  speed=$((speed + 10))
  pitch=$((pitch + 7))
done
