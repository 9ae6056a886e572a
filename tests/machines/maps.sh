#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Compiles the analysis for arm64, without a warning, and runs it in an emulator: its maps, of saliency and of tactors, are those of this machine, bit by
# bit, with NEON and with vectors of other lengths. The films carry many levels.
#
# Usage: maps.sh SOURCE_FOLDER BUILD_FOLDER [all]     (of this machine; BUILD_FOLDER/machines is used)
#   all  all kinds of vectors that Highway knows, and all plugins, in three times the time; else NEON and SVE2, and the analysis alone
# Skipped where `tests/machines/target.sh` was not run.
set -euo pipefail
source=$1
build=$(cd "$2" && pwd)
all=${3:-}
# shellcheck disable=SC1091 # the machine's
folder=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/visuotactile/machines/$(. /etc/os-release && echo "$VERSION_CODENAME")-arm64
[ -f "$folder/complete" ] || { echo "there are no libraries of arm64: run tools/setup.sh arm64, then tests/machines/target.sh"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "maps.sh: $1" >&2
  exit 1
}

cross=$build/machines/arm64${all:+-$all}
kinds='(HWY_SVE|HWY_SVE_256|HWY_SVE2_128)'
targets=(tests/maps)
[ -z "$all" ] || { kinds=0; targets+=(play); }
if [ ! -f "$cross/build.ninja" ]; then
  rm -rf "$cross"
  mkdir -p "$build/machines"
cat >"$cross.ini" <<INI
[built-in options]
cpp_args = ['--sysroot=$folder/root', '-DHWY_DISABLED_TARGETS=$kinds']
INI
  meson setup "$cross" "$source" --cross-file "$folder/meson.ini" --cross-file "$cross.ini" --werror --auto-features=disabled -Dsaliency=enabled >"$work/log" 2>&1 ||
    { tail -n 20 "$work/log" >&2; fail "meson could not configure a build for arm64 (see above)"; }
fi
ninja -C "$cross" "${targets[@]}" >"$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; fail "the analysis could not be compiled for arm64 (see above)"; }
grep -q -- "-isystem$folder/root/usr/include/opencv4" "$cross/compile_commands.json" || fail "OpenCV's headers are not the target's"
# What this machine's compiler would not see: arm64 has FMA everywhere.
contracted=$(grep '"command":' "$cross/compile_commands.json" | grep -vc -- '-ffp-contract=off' || true)
[ "$contracted" = 0 ] || fail "$contracted sources are compiled for arm64 with contraction into FMA"

frames=30
drawn() {
  ffmpeg -v error -f lavfi -i "$2:rate=30" -vf scale=320:240:flags=neighbor -frames:v $frames -pix_fmt yuv420p -f rawvideo "$work/$1.i420"
}
drawn chart testsrc2=size=320x240
drawn life life=size=20x15:seed=3:mold=10:death_color=blue:life_color=yellow # of large squares: small ones are noise

# maps PROGRAM... FILM PROFILE OUT: maps into OUT, levels into OUT.levels
maps() {
  local program=("${@:1:$#-3}")
  shift $(($# - 3))
  "${program[@]}" "$2" 320 240 <"$work/$1.i420" >"$3" 2>"$3.levels" || { cat "$3.levels" >&2; fail "${program[*]} failed"; }
}
levels() {
  tr ' ' '\n' <"$1" | sed '/^$/d' | sort -u | wc -l
}
# FILM PROFILE LEVELS: as many different ones at least
while read -r film profile least; do
  maps "$build/tests/maps" "$film" "$profile" "$work/here"
  [ "$(wc -w <"$work/here.levels")" -eq $((frames * 9)) ] || fail "expected $frames maps of 3 x 3 tactors of $film, got $(wc -w <"$work/here.levels") levels"
  found=$(levels "$work/here.levels")
  [ "$found" -ge "$least" ] || fail "expected $least levels in the maps of $film, profile $profile, got $found"
  # A Raspberry Pi 4 has NEON alone; others have SVE of 128, of 256 and of as many bits as the emulator has.
  cpus=(cortex-a72)
  [ "$film" != life ] || cpus+=("max,sve256=off,sve512=off" ${all:+"max,sve256=on,sve512=off"} max)
  for cpu in "${cpus[@]}"; do
    CPU=$cpu maps "$folder/run" "$cross/tests/maps" "$film" "$profile" "$work/there"
    cmp "$work/here" "$work/there" || fail "arm64 ($cpu) makes other maps of $film, profile $profile"
    echo "$film, $profile, $cpu: $found levels, as here"
  done
done <<FILMS
chart tuned 40
chart paper 200
life tuned 40
life paper 200
FILMS
