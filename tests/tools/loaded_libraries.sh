#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A process that plays on a board, or looks for one, loads no library that only other devices need;
# one that plays on such a device does. The dynamic loader's own log tells.
#
# Usage: loaded_libraries.sh LIBRARY DRIVER      as libSDL2 gamepad
set -euo pipefail
library=$1
driver=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What a film on a driver loads, into $work/loaded. Without the device it ends with an error.
play() {
  rm -f "$work"/log*
  LD_DEBUG=files LD_DEBUG_OUTPUT=$work/log gst-launch-1.0 -q tactiletestsrc num-buffers=5 ! \
    video/x-raw,width=160,height=120 ! saliencytactile ! tactorsink driver="$1" > "$work/said" 2>&1 || true
  cat "$work"/log* | sed -n 's/.*calling init: //p' > "$work/loaded"
  grep -q libgsttactor "$work/loaded" || { echo "driver=$1 did not load tactorsink's plugin:"; cat "$work/said"; exit 1; }
}

gst-inspect-1.0 > /dev/null # where there is no registry, all plugins are loaded for it
for board in simulator auto firmata seat; do
  play $board
  ! grep "$library" "$work/loaded" || { echo "a play with driver=$board loads it"; exit 1; }
done
play "$driver"
grep -q "$library" "$work/loaded" || { echo "a play with driver=$driver does not load $library:"; cat "$work/said"; exit 1; }
