#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Compiles the analysis for arm64, without a warning, and runs it in an emulator: its maps are those of this machine, bit by bit, with NEON and with
# vectors of every length. The films carry many levels, and are rawvideo, so that both analyze the same bytes.
#
# Usage: maps.sh SOURCE_FOLDER BUILD_FOLDER      (of this machine, with the plugins 'saliency' and 'tactile'; BUILD_FOLDER/machines is used)
# Skipped where `tests/machines/target.sh` was not run.
set -euo pipefail
source=$1
build=$2
# shellcheck disable=SC1091 # the machine's
folder=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/visuotactile/machines/$(. /etc/os-release && echo "$VERSION_CODENAME")-arm64
[ -f "$folder/complete" ] || { echo "there are no libraries of arm64: run tools/setup.sh arm64, then tests/machines/target.sh"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "maps.sh: $1" >&2
  exit 1
}

cross=$build/machines/arm64
if [ ! -f "$cross/build.ninja" ]; then
  rm -rf "$cross"
  meson setup "$cross" "$source" --cross-file "$folder/meson.ini" --werror --auto-features=disabled -Dsaliency=enabled >"$work/log" 2>&1 ||
    { tail -n 20 "$work/log" >&2; fail "meson could not configure a build for arm64 (see above)"; }
fi
ninja -C "$cross" gst/saliency/libgstsaliency.so gst/tactile/libgsttactile.so >"$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; fail "the analysis could not be compiled for arm64 (see above)"; }
grep -q -- "-isystem$folder/root/usr/include/opencv4" "$cross/compile_commands.json" || fail "OpenCV's headers are not the target's"
# What this machine's compiler would not see: arm64 has FMA everywhere.
contracted=$(grep '"command":' "$cross/compile_commands.json" | grep -vc -- '-ffp-contract=off' || true)
[ "$contracted" = 0 ] || fail "$contracted sources are compiled for arm64 with contraction into FMA"

# here and there GST-PROGRAM...: with this build's plugins and those that read films
here() {
  GST_PLUGIN_PATH_1_0=$build/gst LD_LIBRARY_PATH=$build/lib/gst/tactile GST_REGISTRY_1_0=$work/here.registry "$@"
}
plugins=$folder/root/usr/lib/aarch64-linux-gnu/gstreamer-1.0
mkdir "$work/plugins"
ln -s "$plugins"/libgst{coreelements,rawparse}.so "$work/plugins"
there() {
  local program=$1
  shift
  "$folder/run" -E LD_LIBRARY_PATH="$cross/lib/gst/tactile" -E GST_PLUGIN_SYSTEM_PATH_1_0= -E GST_PLUGIN_PATH_1_0="$cross/gst/saliency:$cross/gst/tactile:$work/plugins" \
    -E GST_REGISTRY_1_0="$work/there.registry" -E GST_REGISTRY_FORK=no "$folder/root/usr/bin/$program" "$@"
}

size=video/x-raw,format=I420,width=320,height=240,framerate=30/1
drawn() {
  ffmpeg -v error -f lavfi -i "$2:size=320x240:rate=30" -frames:v 45 -pix_fmt yuv420p -f rawvideo "$work/$1.i420"
}
drawn chart testsrc2=sar=1
drawn life life=seed=3:mold=10:death_color=blue:life_color=yellow
here gst-launch-1.0 -q tactiletestsrc num-buffers=45 pattern=dynamic-motion noise=2 ! $size ! filesink location="$work/ball.i420"

# maps WHERE FILM PROFILE OUT
maps() {
  "$1" gst-launch-1.0 -q filesrc location="$work/$2.i420" ! rawvideoparse format=i420 width=320 height=240 framerate=30/1 ! saliencytactile profile="$3" \
    ! tactileextractor name=x ! fakesink async=false x.tactile ! filesink async=false location="$4"
}
levels() {
  od -An -v -tx4 -w4 "$1" | sort -u | wc -l
}
# FILM PROFILE LEVELS: as many different ones at least
while read -r film profile least; do
  maps here "$film" "$profile" "$work/here"
  [ "$(stat -c %s "$work/here")" -eq $((45 * 9 * 4)) ] || fail "expected 45 maps of 3 x 3 tactors of $film, got $(stat -c %s "$work/here") bytes"
  [ "$(levels "$work/here")" -ge "$least" ] || fail "expected $least levels in the maps of $film, profile $profile, got $(levels "$work/here")"
  # A Raspberry Pi 4 has NEON alone; others are SVE of 128, of 256 and of as many bits as the emulator has.
  cpus=(cortex-a72)
  [ "$film" != life ] || cpus+=("max,sve256=off,sve512=off" "max,sve256=on,sve512=off" max)
  for cpu in "${cpus[@]}"; do
    CPU=$cpu maps there "$film" "$profile" "$work/there"
    cmp "$work/here" "$work/there" || fail "arm64 ($cpu) makes other maps of $film, profile $profile"
    echo "$film, $profile, $cpu: $(levels "$work/there") levels, as here"
  done
done <<FILMS
chart tuned 60
chart paper 300
life tuned 60
life paper 300
ball tuned 10
ball paper 200
FILMS
