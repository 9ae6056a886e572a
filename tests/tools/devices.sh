#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-play on each family of devices: --list-devices, --driver and --device, and --feel-test, which drives all motors of a server's device,
# one after the other, and names each; so does visuotactile-settings test. A sound card is PulseAudio's null sink.
# Expects PLAY, SETTINGS, SERVER (haptic_server.py) and the plugins on GST_PLUGIN_PATH.
set -euo pipefail
work=$(mktemp -d)
# shellcheck source=background.sh
. "$(dirname "$0")/background.sh"
cleanup() {
  [ "${#pids[@]}" -eq 0 ] || kill "${pids[@]}" 2>kills || true
  [ ! -S "$work/socket" ] || pactl exit
  wait
  rm -rf "$work"
}
trap cleanup EXIT
cd "$work"
export XDG_RUNTIME_DIR=$work HOME=$work XDG_CONFIG_HOME=$work/config

fail() {
  echo "$*"
  exit 1
}
# expect STATUS COMMAND...: what it prints is in `out`, and with its errors in `said`
expect() {
  local expected=$1 status=0
  shift
  timeout 60 "$@" >out 2>err || status=$?
  cat out err >said
  [ "$status" -eq "$expected" ] || fail "${*##*/} ends with $status instead of $expected: $(cat said)"
}
said() {
  grep -qF -- "$1" said || fail "expected '$1', got: $(cat said)"
}
# ---- servers ----
# walked FILE WHERE FULL MOTOR...: the server's motors were on in this order, each by itself and up to FULL
walked() {
  local file=$1 where=$2 full=$3 on
  shift 3
  on=$(sed -nE "s/^motors $where ([0-9]+=[^ ].*[^ ]|[0-9]+=[^ ]+) *$/\1/p" "$file")
  [ "$(sed 's/=.*//' <<<"$on" | uniq | paste -sd' ')" = "$*" ] || fail "expected the motors $*, one after the other, got: $on"
  grep -q ' ' <<<"$on" && fail "several motors at once: $on"
  for motor in "$@"; do
    grep -qx "$motor=$full" <<<"$on" || fail "motor $motor does not reach $full: $on"
  done
  [ "$(grep '^motors' "$file" | tail -n 1 | sed 's/ *$//')" = "motors $where" ] || fail "it does not end at zero: $(tail -n 3 "$file")"
}

serve buttplug4
expect 0 "$PLAY" --feel-test --driver=intiface --device="Test Vibrator@127.0.0.1:$port"
[ "$(cat out)" = "$(printf 'Test Vibrator, motor 1\nTest Vibrator, motor 2')" ] || fail "expected two motors, got: $(cat said)"
walked buttplug4 0 20 0 2
expect 1 "$PLAY" --feel-test --driver=intiface --device="@127.0.0.1:$port"
said "it has 'Test Vibrator', 'Mine'"

serve bhaptics
expect 0 "$SETTINGS" set driver=bhaptics "device=sleeve-left@127.0.0.1:$port"
expect 0 "$SETTINGS" test
[ "$(cat out)" = "$(printf 'left arm, row %d, column %d\n' 1 1 1 2 1 3 2 1 2 2 2 3)" ] || fail "expected the sleeve's motors, got: $(cat said)"
walked bhaptics ForearmL 100 0 1 2 3 4 5

# ---- what has no motors of its own: the grid ----
expect 0 "$PLAY" --feel-test --driver=simulator --rows=1 --columns=2
[ "$(cat out)" = "$(printf 'simulated, as the driver is the simulator\nrow 1, column 1\nrow 1, column 2')" ] ||
  fail "expected two cells, got: $(cat said)"
expect 0 "$PLAY" --feel-test --quiet --driver=simulator --rows=1 --columns=1
[ ! -s said ] || fail "with --quiet it says: $(cat said)"
# Nothing is plugged in: that is the first line, and no motor is named.
expect 0 "$SETTINGS" unset driver device
for program in "$PLAY --feel-test" "$SETTINGS test"; do
  for quiet in '' --quiet; do
    # shellcheck disable=SC2086
    expect 1 $program $quiet
    head -n 2 said | grep -q 'the motors are simulated: no tactor board is plugged in' || fail "expected 'simulated' in the first lines, got: $(cat said)"
    [ ! -s out ] || fail "it names motors: $(cat out)"
  done
done

# ---- the list ----
expect 0 "$PLAY" --list-devices
for line in '--driver=bhaptics --device=vest-back' '--driver=intiface --device=NAME' '--driver=audio ' '--driver=simulator'; do
  said "$line"
done

# ---- a sound card ----
sound_card
expect 0 "$PLAY" --list-devices
said "--driver=audio '--device=Bass Shakers'"
expect 0 "$PLAY" --print-pipeline --driver=audio --device='Bass Shakers' --channels=4 --intensity=0.5
said 'tactoraudiosink channels=4 '
said 'pulsesink device=shakers'
# What is heard at the card's monitor: left, then right.
begin heard -c1 parec --raw --format=s16le --rate=8000 --channels=2 --device=shakers.monitor
expect 0 "$PLAY" --feel-test --driver=audio --device='Bass Shakers'
[ "$(cat out)" = "$(printf 'channel 1\nchannel 2')" ] || fail "expected two channels, got: $(cat said)"
kill "${pids[-1]}"
# 50 ms of one channel count as sound where they are above 3 % of full scale on average.
order=$(od -An -v -td2 -w4 heard | awk '{ left += $1 < 0 ? -$1 : $1; right += $2 < 0 ? -$2 : $2 }
  NR % 400 == 0 { l = left > 400000; r = right > 400000; if (l || r) print (l ? "left" : "") (r ? "right" : ""); left = right = 0 }' | uniq | paste -sd' ')
[ "$order" = "left right" ] || fail "expected the left channel, then the right one, heard: '$order'"
expect 1 "$PLAY" --feel-test --driver=audio --device=Nothing
said "expected --device to name a sound card, got 'Nothing'; found 'Bass Shakers'"

# ---- wrong ones ----
expect 2 "$PLAY" --driver=shaker
said "--driver is one of auto, firmata"
expect 2 "$PLAY" --driver=audio --compensation=none
said "has no effect with --driver=audio, which always compensates exactly"
expect 2 "$PLAY" --feel-test film.mkv
said "--feel-test plays no film"
echo "each device is felt"
