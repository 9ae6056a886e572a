#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes the sounds of listen_sounds.h: music, voices and effects of Debian's games, mono at 16 kHz. What is there stays.
#
# Usage: tests/bench/listen_pool.sh CACHE      packages are unpacked in CACHE/x; the sounds are in CACHE/listen
set -euo pipefail
cache=$1
pool=$cache/listen
mkdir -p "$pool" "$cache/x" "$cache/deb"
for package in asc-music btanks-data colobot-common-sounds endless-sky-data extremetuxracer-data fillets-ng-data-cs fillets-ng-data-nl frozen-bubble-data \
  gunroar-data hedgewars-data ktuberling-data lugaru-data marsshooter-data mu-cade-data nexuiz-music parsec47-data pinball-data pink-pony-data scorched3d-data \
  starfighter-data torus-trooper-data ufoai-sound wesnoth-1.16-data wesnoth-1.16-music; do
  [ -d "$cache/x/$package" ] || {
    (cd "$cache/deb" && apt-get download -q "$package")
    dpkg -x "$cache/deb/${package}"_*.deb "$cache/x/$package"
  }
done
cd "$cache/x"
decode() { # KIND SECONDS; names on standard input
  local name out
  while read -r name; do
    out=$pool/$1_$(tr '/ ' '__' <<<"$name").s16
    [ -s "$out" ] || ffmpeg -v quiet -nostdin -i "$name" -t "$2" -ac 1 -ar 16000 -f s16le "$out" </dev/null || rm -f "$out"
  done
}
find . -type f \( -name '*.ogg' -o -name '*.mp3' -o -name '*.flac' \) -size +500k | sort | decode music 240
find ./wesnoth-1.16-data ./hedgewars-data/usr/share/games/hedgewars/Data/Sounds ./endless-sky-data ./ufoai-sound ./colobot-common-sounds \
  \( -name '*.ogg' -o -name '*.wav' \) -size -500k | sort | grep -v voices | awk 'NR % 2 == 0 && n++ < 320' | decode effect 20
# Sentences of many people, in eight long recordings.
if ! ls "$pool"/speech_* >/dev/null 2>&1; then
  find "$PWD"/ktuberling-data "$PWD"/fillets-ng-data-cs "$PWD"/fillets-ng-data-nl -name '*.ogg' -size -500k | sort | awk -v q="'" 'NR % 2 == 0 { print "file " q $0 q }' >"$pool/voices.list"
  ffmpeg -v quiet -nostdin -f concat -safe 0 -i "$pool/voices.list" -ac 1 -ar 16000 -f s16le - >"$pool/voices"
  split -n 8 -d --additional-suffix=.s16 "$pool/voices" "$pool/speech_"
  rm "$pool/voices" "$pool/voices.list"
fi
