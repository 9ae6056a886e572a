#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the fuzz targets with clang in a folder of their own and runs each for a while on its corpus; what it learns is not kept.
#
# Usage: tests/fuzz/run.sh [SECONDS] [TARGET ...]     (20 seconds; all targets)
# Ends with the count of runs; with 1 at the first input that breaks something, which it names.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../../tools/build.sh
. "$here/../../tools/build.sh"
case ${1:-} in -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
seconds=${1:-20}
[ $# -eq 0 ] || shift
directory=$root/build-fuzz

export CC=clang CXX=clang++
[ -n "${VISUOTACTILE_NO_SETUP:-}" ] || "$root/tools/setup.sh" build test fuzz
if [ ! -f "$directory/build.ninja" ]; then
  meson setup "$directory" "$root" -Dsaliency=disabled -Dusb=disabled -Dintrospection=disabled -Dtools=disabled -Dexamples=disabled \
    -Dtests=enabled -Dbuildtype=release -Db_lundef=false >/dev/null
fi
if [ $# -eq 0 ]; then
  for folder in "$here"/corpus/*/; do set -- "$@" "$(basename "$folder")"; done
fi
mapfile -t programs < <(printf "tests/fuzz/%s_fuzzer\n" "$@")
ninja -C "$directory" "${programs[@]}" >"$directory/ninja.log" 2>&1 || { cat "$directory/ninja.log" >&2; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
total=0
for target in "$@"; do
  mkdir "$work/$target"
  "$directory/tests/fuzz/${target}_fuzzer" -max_len=4096 -malloc_limit_mb=256 -rss_limit_mb=1024 -timeout=10 -max_total_time="$seconds" \
    -print_final_stats=1 -artifact_prefix="$directory/$target-" "$work/$target" "$here/corpus/$target" >"$work/log" 2>&1 \
    || { tail -n 30 "$work/log" >&2; echo "run.sh: $target was broken" >&2; exit 1; }
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/log")
  echo "$target: $runs runs"
  total=$((total + runs))
done
echo "$total runs in all, nothing broken"
