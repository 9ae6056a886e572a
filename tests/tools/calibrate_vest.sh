#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactor-calibrate on a vest, whose motors have a layout: one motor is driven and no other, a live
# source records it, and the vest plays with the result in time. Takes a minute, nearly all of it
# waiting.
# Expects CALIBRATE (the program), SERVER (haptic_server.py) and the plugins, simulatedsensorsrc
# among them, on GST_PLUGIN_PATH.
# shellcheck source=calibrate_common.sh
. "$(dirname "$0")/calibrate_common.sh"
# shellcheck source=background.sh
. "$here/background.sh"
trap 'kill "${pids[@]}"; rm -rf "$work"' EXIT

cat >simulated <<'INI'
[Calibration]
version=1

[Tactor 7]
latency-ms=17
start-volts=0.4
hold-volts=0.3
fall-ms=40
rise-quadratic-ms=250;-170;-120;36;48;17;
INI

serve bhaptics
vest=(--driver=bhaptics --device="vest-back@127.0.0.1:$port" --tactors=7 --source="simulatedsensorsrc motors=simulated")

# only_motor_7: has been on since the last call, and no other was
only_motor_7() {
  local on
  on=$(grep '^motors' bhaptics | sed -E 's/^motors VestBack *//; s/=[0-9]+//g; /^ *$/d; s/ *$//' | sort -u)
  [ "$on" = 7 ] || fail "expected motor 7 alone, the vest had: $on"
  [ "$(grep '^motors' bhaptics | tail -n 1 | sed 's/ *$//')" = "motors VestBack" ] || fail "it does not end at zero: $(tail -n 3 bhaptics)"
}

# The first of three runs: rises from rest to 1 V and to 1.5 V.
"$CALIBRATE" measure chair "${vest[@]}" --step=1.5 --run=0
expect_silence
only_motor_7
"$CALIBRATE" analyze chair
near "latency" "$(value 7 latency-ms)" 17 2
near "start voltage" "$(value 7 start-volts)" 0.4 0.001

# the median of the errors, in ms
p50() {
  sed -nE 's/^all .*p50 +([0-9.]+),.*/\1/p' out
}
"$CALIBRATE" check "${vest[@]}" --events=4 --calibration=chair/motors.calibration >out
only_motor_7
cat out
with=$(p50)
"$CALIBRATE" check "${vest[@]}" --events=4 >out
cat out
awk -v with="$with" -v without="$(p50)" 'BEGIN { exit !(with != "" && with < without / 2) }' || fail "the calibration does not help: $with ms with it, $(p50) ms without"
echo "vest: passed"
