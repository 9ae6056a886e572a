#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# visuotactile-settings, and what programs make of it: the decoder's rank, and whether decodebin
# takes it.
# Expects the programs SETTINGS, PLAY and TRACK, and the plugins on GST_PLUGIN_PATH.
set -euo pipefail
: "${SETTINGS:?the path of visuotactile-settings}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export XDG_CONFIG_HOME=$work/config
file=$XDG_CONFIG_HOME/visuotactile/chair.conf

fail() {
  echo "$*"
  exit 1
}
# expect STATUS ARGUMENT...: of visuotactile-settings; what it says is in `said`
expect() {
  local expected=$1 status=0
  shift
  "$SETTINGS" "$@" >said 2>&1 || status=$?
  [ "$status" -eq "$expected" ] || fail "visuotactile-settings $* ends with $status instead of $expected: $(cat said)"
}
said() {
  grep -qF -- "$1" said || fail "expected '$1', got: $(cat said)"
}
rank() {
  gst-inspect-1.0 visuotactiledecoder >inspected
  sed -nE 's/^ *Rank *.*\(([0-9]+)\)$/\1/p' inspected
}

# ---- the file ----
expect 0 list
expect 0 set intensity=0.5 grid=2x4
said "written: $file"
expect 0 set --program=totem mute=true
expect 0 list
said "$(printf '[chair]\ngrid=2x4\nintensity=0.5')"
said "$(printf '[totem]\nmute=true')"
cp "$file" before
expect 2 set mute=true intensity=2
said "intensity: expected a number from 0 to 1, got '2'"
expect 2 set intensiti=1
said "unknown key 'intensiti': expected one of enabled, driver"
expect 2 set intensity
said "expected KEY=VALUE, got 'intensity'"
expect 2 on a/b
expect 2 set
cmp before "$file" || fail "a wrong command line changed the file"
expect 0 unset --program=totem mute
expect 0 unset mute
said "not set: mute of [chair]"
grep -q totem "$file" && fail "an empty section is kept"
expect 0 unset -q intensity grid
[ -s said ] && fail "with -q it says: $(cat said)"
# Programs that change the settings at the same time lose nothing.
for number in {1..40}; do
  "$SETTINGS" set -q --program="player$number" mute=true &
done
wait
[ "$(grep -c '^.player' "$file")" = 40 ] || fail "of 40 settings at once there are: $(cat "$file")"
rm "$file"
printf '[chair]\nintensity=loud\n' >"$file"
expect 1 list -q
said "[chair] intensity: expected a number from 0 to 1, got 'loud'"
printf 'no key file\n' >"$file"
expect 1 on
said "cannot read the settings '$file'"
[ "$(cat "$file")" = "no key file" ] || fail "a file that could not be read was replaced"
rm "$file"
mkdir "$file"
expect 1 on
rmdir "$file"

# A link stays one, and its target is written.
printf '[chair]\nintensity=0.5\n' >elsewhere
ln -s "$work/elsewhere" "$file"
expect 0 set mute=true
[ -L "$file" ] && grep -q mute=true elsewhere || fail "a link was replaced: $(ls -l "$file")"
rm "$file"

# ---- devices ----
# What belongs to a device is kept for it.
printf '[chair]\ngrid=2x4\nmapping=1,0\nintensity=0.5\n' >"$file"
expect 0 use driver=gamepad "device=Bob's [pad]"
expect 0 list
said "$(printf '[chair]\ndevice=Bob'\''s [pad]\ndriver=gamepad\nintensity=0.5')"
said "$(printf '[device auto]\ngrid=2x4\nmapping=1,0')"
cp "$file" before
expect 0 use driver=gamepad "device=Bob's [pad]"
cmp before "$file" || fail "the device that is used already changes the file"
expect 0 set mapping=0,0
expect 0 use driver=auto
expect 0 use driver=simulator
expect 0 use driver=gamepad "device=Bob's [pad]"
expect 0 list
said "mapping=0,0"
expect 0 use driver=auto
expect 0 list
said "$(printf '[chair]\ndriver=auto\ngrid=2x4\nintensity=0.5\nmapping=1,0')"
# In German, --help has the same parts.
expect 0 --help
wc -l <said >lines
LC_ALL=C.UTF-8 LANGUAGE=de expect 0 --help
wc -l <said | cmp - lines || fail "the help in German has other parts: $(cat said)"
expect 2 use gamepad
expect 2 use device=x
expect 2 use driver=gamepad mute=true
expect 2 use driver=nope
expect 2 set driver=nope
rm "$file"

# ---- what is there ----
expect 1 devices
mkdir -p "$work/state/visuotactile"
printf 'bhaptics\nvest-back\nVest\n' >"$work/state/visuotactile/device"
XDG_STATE_HOME=$work/state expect 1 devices
said "driver=bhaptics 'device=vest-back'  Vest, not connected now"
said 'No device is connected: plug in a board or a gamepad'
mkdir bin
printf '#!/bin/sh\n' >bin/totem
printf '#!/bin/sh\necho "$@" >>%s/calls\nexit 3\n' "$work" >bin/systemctl
chmod +x bin/*
path=$PATH
PATH=$work/bin:$PATH
expect 0 on totem
expect 0 players
grep -q '^totem  *on ' said || fail "totem is not on: $(cat said)"
expect 0 on mpv
expect 0 players
grep -q '^mpv  *\(on\|not installed\) ' said || fail "mpv is not on: $(cat said)"
[ -r "$XDG_CONFIG_HOME/mpv/scripts/visuotactile.lua" ] || fail "mpv has no script"
expect 0 off mpv totem
[ ! -e "$XDG_CONFIG_HOME/mpv/scripts/visuotactile.lua" ] || fail "mpv has a script"
expect 1 on follow
said 'systemctl cannot enable visuotactile-follow.service'
[ "$(cat calls)" = '--user --now enable visuotactile-follow.service' ] || fail "systemctl was called with: $(cat calls)"
PATH=$path
rm "$file"

# ---- programs ----
gst-launch-1.0 -q tactiletestsrc pattern=dynamic-motion num-buffers=30 ! video/x-raw,width=160,height=120 ! jpegenc ! matroskamux ! filesink location=film.mkv
# plays_felt BIN: whether gst-launch-1.0 takes the decoder; it plays to the end either way
plays_felt() {
  VISUOTACTILE_DRIVER=simulator GST_DEBUG_NO_COLOR=1 GST_DEBUG=GST_ELEMENT_FACTORY:4 \
    gst-launch-1.0 -m filesrc location=film.mkv ! "$1" ! fakesink sync=true >messages 2>elements || fail "$1: $(cat messages)"
  grep -q 'eos' messages || fail "$1 did not reach the end: $(cat messages)"
  grep -q '"visuotactiledecoder[0-9]*" (' messages
}
[ "$(rank)" = 0 ] || fail "after the installation the decoder has a rank: $(rank)"
for bin in decodebin decodebin3; do
  plays_felt $bin && fail "$bin takes the decoder though nothing is switched on"
done
expect 0 on totem
[ "$(rank)" = 1256 ] || fail "with a program switched on the decoder's rank is $(rank)"
for bin in decodebin decodebin3; do
  plays_felt $bin && grep -q visuotactile messages && fail "$bin takes the decoder though only another program is switched on"
  grep -qE 'WARNING|ERROR' messages && fail "$bin: $(cat messages)"
done
expect 0 on gst-launch-1.0
for bin in decodebin decodebin3; do
  plays_felt $bin || fail "$bin does not take the decoder: $(cat messages)"
done
expect 0 off gst-launch-1.0
for bin in decodebin decodebin3; do
  plays_felt $bin && fail "$bin takes the decoder though the program is switched off"
done
expect 0 off totem
[ "$(rank)" = 0 ] || fail "switched off, the decoder has the rank $(rank)"

# ---- test ----
expect 0 set grid=1x2 mute=true
expect 0 test --driver=simulator
[ "$(cat said)" = "$(printf 'simulated, as the driver is the simulator\nrow 1, column 1\nrow 1, column 2')" ] || fail "expected two tactors: $(cat said)"
expect 1 test --driver=nothing
said nothing

# ---- the project's own programs ----
# line OPTION...: of visuotactile-play
line() {
  "$PLAY" --print-pipeline "$@" >line 2>said || fail "visuotactile-play --print-pipeline $*: $(cat said)"
}
# has TEXT; lacks TEXT
has() {
  grep -qF -- "$1" line || fail "expected '$1' in: $(cat line)"
}
lacks() {
  ! grep -qF -- "$1" line || fail "'$1' is not expected in: $(cat line)"
}
expect 0 unset mute grid
line
lacks intensity=
[ "$(cat said)" = 'visuotactile-play: plays on driver=auto (default)' ] || fail "without settings it says: $(cat said)"
expect 0 set driver=simulator device=chair grid=2x4 mapping=7,6,5,4,3,2,1,0 intensity=0.5 mute=true delay=20 sensitivity=2 density=0.25 people=fast sound=music
line
for setting in driver=simulator rows=2 columns=4 intensity=0.5 mute=true delay=20 sensitivity=2 density=0.25 people=fast 'mapping="7,6,5,4,3,2,1,0"'; do
  has "$setting"
done
said "settings of the user: driver=simulator, device=chair, mapping=7,6,5,4,3,2,1,0, intensity=0.5, mute=true, delay=20, sensitivity=2, density=0.25, people=fast, sound=music, grid=2x4"
# Options override them.
line --intensity=1 --rows=3 --people=off --sound=off
has rows=3
has people=off
lacks intensity=
said "settings of the user: driver=simulator, device=chair, mapping=7,6,5,4,3,2,1,0, mute=true, delay=20, sensitivity=2, density=0.25, grid=2x4"
# A device, a mapping and a grid are of the user's driver, and not of another, unless they are given.
line --driver=gamepad
has driver=gamepad
has intensity=0.5
for setting in mapping device=chair rows=; do
  lacks "$setting"
done
line --driver=gamepad --device=chair --rows=2 --columns=4
for setting in device=chair rows=2 columns=4; do
  has "$setting"
done
line --quiet
[ -s said ] && fail "with --quiet it says: $(cat said)"
# Shakers are for programs that can play on them; another one says so.
expect 0 use driver=audio device=Card
expect 1 test # simulated: there is no board
said 'plays on no shakers'
if [ -n "${FOLLOW:-}" ]; then
  "$FOLLOW" --list-players >said 2>&1 || fail "visuotactile-follow with shakers: $(cat said)"
  said 'plays on no shakers'
fi
expect 0 use driver=simulator device=chair
# A section of its own.
expect 0 set --program=visuotactile-play intensity=0.25
line
has intensity=0.25
if [ -n "${VISUOTACTILE_DESK:-}" ]; then
  "$TRACK" desk --no-browser "$work/none.mkv" >said 2>&1 && fail "a desk without a film ends with 0"
  said "settings of the user: driver=simulator, device=chair, mapping=7,6,5,4,3,2,1,0, intensity=0.5, mute=true"
fi
echo "settings are as the programs take them"
