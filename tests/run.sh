#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, runs every test.
#
# Usage: tests/run.sh [--asan | --tsan] [meson test arguments]
#   --asan   build and run under AddressSanitizer and UndefinedBehaviorSanitizer, in C++ alone: no Python
#   --tsan   build and run under ThreadSanitizer, likewise
# Examples: tests/run.sh          tests/run.sh --asan          tests/run.sh tactorsink -v
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../tools/build.sh
. "$here/../tools/build.sh"

directory=$root/build
patience=1
options=(-Dsaliency=enabled -Dusb=enabled -Dintrospection=enabled -Dtools=enabled -Dtests=enabled -Dexamples=enabled)
case ${1:-} in
  -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
  --asan) shift; directory=$root/build-asan; patience=5; options+=("-Db_sanitize=address,undefined" -Db_lundef=false -Dintrospection=disabled) ;;
  --tsan) shift; directory=$root/build-tsan; patience=5; options+=(-Db_sanitize=thread -Db_lundef=false -Dintrospection=disabled) ;;
esac

build_project "$directory" "build play test players" "${options[@]}"

# Plugins of others start threads as GStreamer looks through them, before tests fork: that is not ours (die_after_fork).
# Suppressions are for libraries alone, each with its reason. Leaks in libraries without frame pointers are only told apart with full stacks.
supp=$root/tests/sanitizers
export ASAN_OPTIONS="detect_leaks=1:fast_unwind_on_malloc=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export LSAN_OPTIONS="suppressions=$supp/lsan.supp:print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
export TSAN_OPTIONS="ignore_noninstrumented_modules=1:halt_on_error=1:die_after_fork=0:suppressions=$supp/tsan.supp${TSAN_OPTIONS:+:$TSAN_OPTIONS}"

# The last lines are meson's, then one in a form that any CI reads.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
meson test -C "$directory" --no-rebuild --print-errorlogs --timeout-multiplier "$patience" "$@" 2>&1 | tee "$log" || status=$?
count() { sed -n "s/^$1: *\([0-9][0-9]*\).*/\1/p" "$log" | tail -n 1; }
passed=$(count Ok); failed=$(count Fail); timeouts=$(count Timeout); unexpected=$(count 'Unexpected Pass'); skipped=$(count Skipped)
failed=$((${failed:-0} + ${timeouts:-0} + ${unexpected:-0}))
echo
echo "${passed:-0} passed, $failed failed, ${skipped:-0} skipped"
if [ "$status" -eq 0 ] && [ "${passed:-0}" -eq 0 ]; then
  echo "run.sh: no test ran; expected at least one" >&2
  status=1
fi
exit "$status"
