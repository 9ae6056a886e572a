#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, runs every test.
#
# Usage: tests/run.sh [--asan | --tsan] [meson test arguments]
#   --asan   build and run under AddressSanitizer and UndefinedBehaviorSanitizer
#   --tsan   build and run under ThreadSanitizer
# Examples: tests/run.sh          tests/run.sh --asan          tests/run.sh tactorsink -v
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../tools/build.sh
. "$here/../tools/build.sh"

directory=$root/build
options=(-Dsaliency=enabled -Dintrospection=enabled -Dtools=enabled -Dtests=enabled)
case ${1:-} in
  -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
  --asan) shift; directory=$root/build-asan; options+=("-Db_sanitize=address,undefined" -Db_lundef=false) ;;
  --tsan) shift; directory=$root/build-tsan; options+=(-Db_sanitize=thread -Db_lundef=false) ;;
esac

build_project "$directory" "build play test" "${options[@]}"

# The last lines are meson's, then one in a form that any CI reads.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
meson test -C "$directory" --no-rebuild --print-errorlogs "$@" 2>&1 | tee "$log" || status=$?
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
