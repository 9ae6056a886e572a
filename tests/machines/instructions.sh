#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Counts the instructions with which a frame is analyzed, by SSE4.2, AVX2, NEON and SVE2 of 128 bits, in an emulator: the figures are the same on every computer,
# however busy. An emulator knows nothing of how long an instruction takes, nor of caches. Prints docs/measured/instructions.md.
#
# Usage: tests/machines/instructions.sh BUILD_FOLDER     (of a PC, where the test arm64_maps ran)
set -euo pipefail
case ${1:-} in
  '' | -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
arm64=$build/machines/arm64/tests/maps
[ -x "$arm64" ] || { echo "instructions.sh: there is no $arm64: run the test arm64_maps" >&2; exit 1; }
libraries=$("$here/target.sh" arm64)/root
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cc -O2 -shared -fPIC -o "$work/plugin.so" "$here/instructions.c"

# After ten frames, five are counted.
counted() { # SIZE PROFILE EMULATOR...: instructions a frame, all and of vectors
  local size=$1 profile=$2 frames
  shift 2
  for frames in 10 15; do
    head -c $((size_bytes * frames)) "$work/$size.i420" | "$1" -plugin "$work/plugin.so,to=$work/$frames" "${@:2}" "$profile" "${size%x*}" "${size#*x}" >/dev/null 2>&1
  done
  paste -d' ' "$work/10" "$work/15" | awk '{ printf "%d %d\n", ($3 - $1) / 5, ($4 - $2) / 5 }'
}

cat <<PAGE
# Instructions of the analysis

Made by \`tests/machines/instructions.sh build\`; do not edit.

Instructions with which one frame of ffmpeg's \`testsrc2\`, I420, is analyzed and mapped to 3 × 3 levels, on one
core of an emulator; SVE2 is of 128 bits. They are the same on every computer. How long they take depends on the processor: the
[speed](speed.md) was measured on x86 alone. GCC $(gcc -dumpversion).

| profile | size | vectors | million a frame | a pixel | of vectors or floating point |
|---|---|---|---|---|---|
PAGE
for size in 640x480 1920x1080; do
  size_bytes=$((${size%x*} * ${size#*x} * 3 / 2))
  ffmpeg -v error -f lavfi -i "testsrc2=size=$size:rate=30" -frames:v 15 -pix_fmt yuv420p -f rawvideo "$work/$size.i420"
  for profile in tuned paper; do
    while read -r name emulator; do
      # shellcheck disable=SC2086 # words
      counted "$size" "$profile" $emulator | awk -v row="$profile | ${size/x/×} | $name" -v pixels=$((size_bytes * 2 / 3)) -v arm="${emulator%%64*}" '
        { printf "| %s | %.2f | %.2f | %s |\n", row, $1 / 1e6, $1 / pixels, arm == "qemu-aarch" ? sprintf("%.0f %%", 100 * $2 / $1) : "" }'
    done <<WITH
SSE4.2 qemu-x86_64 -cpu Nehalem $build/tests/maps
AVX2 qemu-x86_64 -cpu max $build/tests/maps
NEON qemu-aarch64 -cpu cortex-a72 -L $libraries $arm64
SVE2 qemu-aarch64 -cpu max,sve256=off,sve512=off -L $libraries $arm64
WITH
  done
done
