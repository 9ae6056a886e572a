#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactor-calibrate on the clock: a simulated motor is driven by tactorsink and heard at the same time by a live source, whose latency the
# whole pipeline has; what it is comes back. A bit more than a minute, hardly any of it work.
# Expects CALIBRATE (the program) and the plugins, simulatedsensorsrc among them, on GST_PLUGIN_PATH.
set -euo pipefail
: "${CALIBRATE:?the path of tactor-calibrate}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
  echo "$*"
  exit 1
}

# near WHAT GOT EXPECTED TOLERANCE
near() {
  awk -v got="$2" -v want="$3" -v off="$4" 'BEGIN { exit !(got != "" && got - want <= off && want - got <= off) }' || fail "$1 is '$2' instead of $3 ± $4"
  echo "$1: $2"
}

# value KEY [FIELD]: of motors.calibration
value() {
  sed -n "s/^$1=//p" chair/motors.calibration | cut -d';' -f"${2:-1}"
}

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
for trace in chair/run-*.csv; do
  awk -F, 'NR > 1 { volts = $5 } END { exit volts != 0 }' "$trace" || fail "$trace leaves the motor on"
done
"$CALIBRATE" analyse chair --verbose
near "latency" "$(value latency-ms)" 17 2
near "start voltage" "$(value start-volts)" 0.6 0.001
near "hold voltage" "$(value hold-volts)" 0.4 0.001
near "fall time" "$(value fall-ms)" 40 3
near "rise time" "$(value rise-quadratic-ms)" 250 6
near "its slope" "$(value rise-quadratic-ms 2)" -170 10
near "its R2" "$(value rise-quadratic-r-squared)" 1 0.005
near "vibration at 3 V" "$(sed -n 's/^vibration=//p' chair/motors.calibration | sed 's/;$//; s/.*;//')" 0.75 0.01
echo "live loop: passed"
