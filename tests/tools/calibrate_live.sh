#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactor-calibrate on the clock. tactorsink drives a simulated motor while a live source records it,
# whose latency the whole pipeline has. The measurement must return the motor's values. Takes a bit
# more than a minute, nearly all of it waiting.
# Expects CALIBRATE (the program) and the plugins, simulatedsensorsrc among them, on
# GST_PLUGIN_PATH.
# shellcheck source=calibrate_common.sh
. "$(dirname "$0")/calibrate_common.sh"

cat >simulated <<'INI'
[Calibration]
version=1

[Tactor 0]
latency-ms=17
start-volts=0.6
hold-volts=0.4
fall-ms=40
rise-quadratic-ms=250;-170;-120;36;48;17;
INI

"$CALIBRATE" measure chair --driver=simulator --source="simulatedsensorsrc motors=simulated" --step=1
expect_silence
"$CALIBRATE" analyze chair --verbose
near "latency" "$(value 0 latency-ms)" 17 2
near "start voltage" "$(value 0 start-volts)" 0.6 0.001
near "hold voltage" "$(value 0 hold-volts)" 0.4 0.001
near "fall time" "$(value 0 fall-ms)" 40 3
near "rise time" "$(value 0 rise-quadratic-ms)" 250 6
near "its slope" "$(value 0 rise-quadratic-ms 2)" -170 10
near "its R2" "$(value 0 rise-quadratic-r-squared)" 1 0.005
near "vibration at 3 V" "$(value 0 vibration 1- | sed 's/;$//; s/.*;//')" 0.75 0.01
echo "live loop: passed"
