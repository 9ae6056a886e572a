#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the fuzz targets with clang in their own build folder, and runs each on its corpus. New inputs are not kept.
#
# Usage: tests/fuzz/run.sh [OPTION ...] [SECONDS] [TARGET ...]     (20 seconds; all targets)
#   --fast      without AddressSanitizer: several times as many runs, but fewer kinds of errors
#   --runs=N    N runs of each target instead of SECONDS
#   --length=N  maximum input size in bytes (4096)
#   --jobs=N    targets at a time (1)
# Prints the number of runs. Exits with 1 at the first failing input, and names it.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../../tools/build.sh
. "$here/../../tools/build.sh"
kind=fuzzer runs='' length=4096 jobs=1
while [[ ${1:-} = -* ]]; do
  case $1 in
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --fast) kind=fast ;;
    --runs=*) runs=${1#*=} ;;
    --length=*) length=${1#*=} ;;
    --jobs=*) jobs=${1#*=} ;;
    *) echo "run.sh: expected --fast, --runs=N, --length=N or --jobs=N, got '$1'" >&2; exit 2 ;;
  esac
  shift
done
limit=-max_total_time=20
if [[ ${1:-} =~ ^[0-9]+$ ]]; then
  limit=-max_total_time=$1
  shift
fi
[ -z "$runs" ] || limit=-runs=$runs
directory=$root/build-fuzz

export CC=clang CXX=clang++
[ -n "${VISUOTACTILE_NO_SETUP:-}" ] || "$root/tools/setup.sh" build test fuzz
if [ ! -f "$directory/build.ninja" ]; then
  meson setup "$directory" "$root" -Dsaliency=enabled -Dusb=enabled -Dtools=enabled -Dintrospection=disabled -Dexamples=disabled \
    -Dtests=enabled -Dbuildtype=release -Db_lundef=false >/dev/null
fi
if [ $# -eq 0 ]; then
  for folder in "$here"/corpus/*/; do set -- "$@" "$(basename "$folder")"; done
fi
mapfile -t programs < <(printf "tests/fuzz/%s_$kind\n" "$@")
ninja -C "$directory" "${programs[@]}" >"$directory/ninja.log" 2>&1 || { cat "$directory/ninja.log" >&2; exit 1; }

export GST_REGISTRY_1_0=$directory/fuzz.registry
gst-inspect-1.0 identity >"$directory/gst-inspect.log" # looks through all plugins, which would be one very slow run
export GST_REGISTRY_FORK=no # a fuzzer's plug-in scanner would have to be one, too
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fuzz() {
  local target=$1
  # gst_caps_from_string() of GStreamer 1.22 leaks 200 bytes for a list that is not closed. Plugins that decode sound leak more.
  case $target in caps | sound) export ASAN_OPTIONS=detect_leaks=0 ;; esac
  mkdir "$work/$target"
  "$directory/tests/fuzz/${target}_$kind" -max_len="$length" -malloc_limit_mb=256 -rss_limit_mb=1024 -timeout=10 "$limit" \
    -print_final_stats=1 -artifact_prefix="$directory/$target-" "$work/$target" "$here/corpus/$target" >"$work/$target.log" 2>&1 \
    || { tail -n 30 "$work/$target.log" >&2; echo "run.sh: $target was broken" >&2; return 255; }
  sed -n "s/^stat::number_of_executed_units: */$target: /p; s/^\(stat::average_exec_per_sec\): */  \1 /p" "$work/$target.log" \
    | paste -s | sed 's/\t  stat::average_exec_per_sec/ runs,/; s/$/ a second/' | tee -a "$work/counts"
}
export -f fuzz
export directory kind length limit work here
# 255 ends xargs.
# shellcheck disable=SC2016 # expanded by the shell that xargs starts
printf '%s\0' "$@" | xargs -0 -n 1 -P "$jobs" bash -c 'fuzz "$1"' bash
awk '{ total += $2 } END { printf "%d runs in all, nothing broken\n", total }' "$work/counts"
