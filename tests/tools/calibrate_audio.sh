#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# tactor-calibrate on a sound card: PulseAudio's null sink plays the right channel, and what its
# monitor has drives a shaker of known resonance and quality, which a live source records. Takes a
# minute and a half, nearly all of it waiting.
# Expects CALIBRATE (the program) and the plugins, simulatedshaker among them, on GST_PLUGIN_PATH.
# shellcheck source=calibrate_common.sh
. "$(dirname "$0")/calibrate_common.sh"

# shellcheck source=background.sh
. "$here/background.sh"
export XDG_RUNTIME_DIR=$work HOME=$work
trap 'pactl exit; rm -rf "$work"' EXIT
sound_card

# Neither clock follows the other: where a recording begins is found by its sound.
hear="pulsesrc device=shakers.monitor provide-clock=false slave-method=none buffer-time=40000 latency-time=5000 ! \
  audio/x-raw,channels=1,rate=8000 ! audioconvert ! simulatedshaker frequency=60 quality=4"
audio=(--driver=audio --device="Bass Shakers")

# The first of three runs: rises from rest to 1 V and to 1.5 V.
"$CALIBRATE" measure chair "${audio[@]}" --tactors=1 --step=1.5 --run=0 --source="$hear"
expect_silence
awk -F, 'NR > 1 && $4 != 1 { exit 1 }' chair/run-000.csv || fail "another channel than 1 is driven: $(cat chair/run-000.csv)"
"$CALIBRATE" analyze chair --align --verbose
grep -q '^latency-ms=' chair/motors.calibration && fail "a latency without a common clock"

# ln(10) Q / (pi f) is 48.9 ms, of the rise and of the fall. The monitor has half of the right
# channel: of both the mean.
near "rise time to 1 V" "$(value 1 rise-table-ms 11)" 48.9 2
near "rise time to 1.5 V" "$(value 1 rise-table-ms 16)" 48.9 2
near "fall time" "$(value 1 fall-ms)" 48.9 2
near "vibration at 1.5 V" "$(value 1 vibration 1- | sed 's/;$//; s/.*;//')" 0.25 0.005

refused() {
  local status=0
  "$CALIBRATE" "$@" >out 2>err || status=$?
  [ "$status" -eq 1 ] || [ "$status" -eq 2 ] || fail "$* ends with $status"
}
refused measure third "${audio[@]}" --tactors=2 --source="$hear"
grep -q "expected tactors of 0 to 1, which are the card's channels, got 2" err || fail "$(cat err)"
refused measure nothing --driver=audio --device=Nothing --source="$hear"
grep -q "found 'Bass Shakers'" err || fail "$(cat err)"
refused measure other --driver=audio --source=simulator
grep -q "leave out --driver=audio" err || fail "$(cat err)"
echo "shaker: passed"
