#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the seat sketch for an Arduino Mega (ATmega2560) or Uno (ATmega328P) from Debian's gcc-avr and arduino-core-avr and the Firmata.h of this folder.
# Usage: build_seat.sh SKETCH mega|uno OUTPUT.elf
set -euo pipefail
sketch=$1
case $2 in
  mega) chip=atmega2560 name=AVR_MEGA2560 variant=mega ;;
  uno) chip=atmega328p name=AVR_UNO variant=standard ;;
  *) exit 2 ;;
esac
output=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
avr=/usr/share/arduino/hardware/arduino/avr
core=$avr/cores/arduino

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Flags of platform.txt and boards.txt of the core. The float.h of Debian's gcc-avr lacks DECIMAL_DIG.
flags=(-mmcu="$chip" -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_"$name" -DARDUINO_ARCH_AVR -DDECIMAL_DIG=17 -Os -g
  -ffunction-sections -fdata-sections -I"$core" -I"$avr/variants/$variant" -I"$here")
cxx=(avr-g++ "${flags[@]}" -std=gnu++11 -fpermissive -fno-exceptions -fno-threadsafe-statics)

"${cxx[@]}" -Wall -Wextra -include Arduino.h -x c++ -c "$sketch" -o "$work/sketch.o"
for source in "$core"/*.c; do
  avr-gcc "${flags[@]}" -std=gnu11 -w -c "$source" -o "$work/$(basename "$source").o"
done
for source in "$core"/*.cpp; do
  "${cxx[@]}" -w -c "$source" -o "$work/$(basename "$source").o"
done
avr-gcc -mmcu="$chip" -Os -Wl,--gc-sections "$work"/*.o -lm -o "$output"
