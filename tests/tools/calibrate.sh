#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactor-calibrate in a closed loop, without waiting for a clock. tactorsink drives simulated motors
# that all differ, a GStreamer source records them, and the program measures them. Then they are
# played again with the result.
# Expects CALIBRATE (the program) and the plugins on GST_PLUGIN_PATH.
# shellcheck source=calibrate_common.sh
. "$(dirname "$0")/calibrate_common.sh"

cat >simulated <<'INI'
[Calibration]
version=1

[Tactor 0]
latency-ms=4
start-volts=0.4
hold-volts=0.3
rise-quadratic-ms=200;-140;-95;31;40;14;
vibration-volts=3
vibration=0.6

[Tactor 2]
latency-ms=22
start-volts=0.7
hold-volts=0.4
fall-ms=45
rise-quadratic-ms=300;-200;-140;42;55;20;
vibration-volts=3
vibration=0.3
INI

hear=(--source=simulator --simulated-motors=simulated "--tactors=0,2")

# Stopped after its first run, it resumes with the second. A complete measurement is not repeated. A
# used folder is not taken for another measurement.
"$CALIBRATE" measure chair "${hear[@]}" --motor="two of them" --run=0 >out
[ "$(grep -c ^run out)" -eq 1 ] || fail "--run=0 played $(cat out)"
"$CALIBRATE" measure chair "${hear[@]}" --motor="two of them" >out
head -n 1 out | grep -q '^run 2 of' || fail "it did not go on: $(cat out)"
"$CALIBRATE" measure chair "${hear[@]}" --motor="two of them" >out
[ ! -s out ] || fail "there was nothing left to do, but: $(cat out)"
"$CALIBRATE" measure chair "${hear[@]}" --motor="two of them" --force >out
[ "$(grep -c ^run out)" -eq "$(find chair -name 'run-*.csv' | wc -l)" ] || fail "--force did not play all of it anew: $(cat out)"
"$CALIBRATE" measure chair "${hear[@]}" --motor="two of them" --run=0 --quiet >out
[ ! -s out ] || fail "--quiet, but: $(cat out)"
"$CALIBRATE" measure chair "${hear[@]}" --repetitions=3 2>err && fail "it took a used folder"
grep -q "another measurement" err || fail "$(cat err)"
expect_silence

"$CALIBRATE" analyze chair >out
grep -q '^motor=two of them$' chair/motors.calibration || fail "the motor's name is lost"
near "latency of tactor 0" "$(value 0 latency-ms)" 4 2
near "latency of tactor 2" "$(value 2 latency-ms)" 22 2
near "start voltage of tactor 0" "$(value 0 start-volts)" 0.4 0.001
near "start voltage of tactor 2" "$(value 2 start-volts)" 0.7 0.001
near "hold voltage of tactor 0" "$(value 0 hold-volts)" 0.3 0.001
near "hold voltage of tactor 2" "$(value 2 hold-volts)" 0.4 0.001
near "fall time of tactor 2" "$(value 2 fall-ms)" 45 3
near "rise time of tactor 0" "$(value 0 rise-quadratic-ms)" 200 5
near "rise time of tactor 2" "$(value 2 rise-quadratic-ms)" 300 6
near "its slope" "$(value 2 rise-quadratic-ms 2)" -200 8
near "its R2" "$(value 2 rise-quadratic-r-squared)" 1 0.005
near "vibration of tactor 0" "$(value 0 vibration | sed 's/.*;//')" 0.06 0.03

# check: with the calibration all rises are on time, without it none is.
p95() {
  sed -nE 's/^all .*p95 +([0-9.]+),.*/\1/p' out
}
"$CALIBRATE" check "${hear[@]}" --calibration=chair/motors.calibration >out
near "error with the calibration" "$(p95)" 0 5
[ "$(grep -cE '^tactor [02] +10 rises: ' out)" -eq 2 ] || fail "not every rise of each tactor was checked: $(cat out)"
"$CALIBRATE" check "${hear[@]}" >out
awk -v p95="$(p95)" 'BEGIN { exit !(p95 > 20) }' || fail "without the calibration: $(cat out)"

"$CALIBRATE" show chair --tactor=2 >out
for picture in envelope rise-times residuals; do
  grep -q '</svg>' "chair/tactor-2-$picture.svg" || fail "tactor-2-$picture.svg is not whole"
done

"$CALIBRATE" show chair --tactor=2 --output=two.png >out
for picture in envelope rise-times residuals; do
  head -c 8 "two-$picture.png" | cmp -s - <(printf '\211PNG\r\n\032\n') || fail "two-$picture.png is no PNG"
done

# A recording from elsewhere, with a clock of its own.
cp chair/run-002.wav elsewhere.wav
"$CALIBRATE" analyze --recording=elsewhere.wav --commands=chair/run-002.csv --align --output=elsewhere.calibration >out
grep -q '^start-volts=' elsewhere.calibration || fail "$(cat out)"
grep -q '^latency-ms=' elsewhere.calibration && fail "a latency without a common clock"

# A phone beside the chair: one sound file for each run.
mkdir phone
cp chair/session.ini chair/run-*.csv phone
for sound in chair/run-*.wav; do
  cp "$sound" "phone/$(basename "$sound" .wav).sound"
done
"$CALIBRATE" analyze phone >out
sed -n '/^\[Tactor 2\]/,/^\[/s/^start-volts=//p' phone/motors.calibration | grep -qx 0.7 || fail "$(cat out)"
grep -q '^latency-ms=' phone/motors.calibration && fail "a latency without a common clock"

# An error is one line, with status 1 or 2.
refused() {
  local status=0
  "$CALIBRATE" "$@" >out 2>err || status=$?
  [ "$status" -eq 1 ] || [ "$status" -eq 2 ] || fail "$* ends with $status"
  [ -s err ] || fail "$* says nothing"
}
refused
refused frobnicate
refused measure
refused measure other --tactors=x
refused measure other --step=0
refused measure other --source="nosuchsource" --driver=simulator
# Nothing is plugged in: nothing is measured.
refused measure unplugged --source="audiotestsrc is-live=true"
head -n 2 err | grep -q "the motors are simulated: no tactor board is plugged in" || fail "$(cat err)"
refused analyze nowhere
refused analyze --recording=simulated --commands=chair/run-002.csv --output=x
refused show nowhere
refused show chair --output=picture.jpg
# Sound files with false headers: 4 GiB of one channel, no channels.
head -c 40 elsewhere.wav >lying.wav
printf '\377\377\377\377' >>lying.wav
refused analyze --recording=lying.wav --commands=chair/run-002.csv --output=x
{ head -c 22 elsewhere.wav; printf '\0\0'; tail -c +25 elsewhere.wav; } >lying.wav
refused analyze --recording=lying.wav --commands=chair/run-002.csv --output=x
refused check --source=none
refused check --source=simulator --calibration=nowhere
"$CALIBRATE" --help >out && grep -q "calibrate measure" out
echo "closed loop: passed"
