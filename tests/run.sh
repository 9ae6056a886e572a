#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, runs every test.
#
# Usage: tests/run.sh [--asan | --tsan | --valgrind] [meson test arguments]
#        tests/run.sh (--tidy | --cppcheck) [FILE ...]
#   --asan      build and run under AddressSanitizer and UndefinedBehaviorSanitizer, in C++ alone: no Python
#   --tsan      build and run under ThreadSanitizer, likewise
#   --valgrind  run under valgrind's memcheck, without real clips (libavcodec's pictures count as uninitialized there); without names the tests of
#               libraries and elements but allocations and hostile_tracks, which measure memory themselves, and Python's
#   --tidy      clang-tidy, with .clang-tidy, over lib, gst and tools or over some of their files
#   --cppcheck  cppcheck over lib, gst, tools, tests and examples, likewise
# Examples: tests/run.sh          tests/run.sh --asan          tests/run.sh tactorsink -v
#           tests/run.sh --valgrind text_cue     tests/run.sh --tidy gst/tactor/tactorscheduler.cpp
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../tools/build.sh
. "$here/../tools/build.sh"

directory=$root/build
patience=1
options=(-Dsaliency=enabled -Dusb=enabled -Dgl=enabled -Dintrospection=enabled -Dtools=enabled -Ddesk=enabled -Dtests=enabled -Dexamples=enabled -Ddocs=enabled)
parts="build play test players docs study"
wrapper=()
analyzer=
scans_first=
case ${1:-} in
  -h | --help) sed -n '3,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
  --valgrind)
    shift
    parts+=" analysis"
    directory=$root/build-valgrind
    patience=20
    # valgrind 3.19 does not know all of AVX2 (a vmovq from register to register): the same source for SSE4 is looked at.
    options+=(-Ddebug=true "-Dcpp_args=-DHWY_DISABLED_TARGETS=(HWY_AVX2|HWY_AVX3|HWY_AVX3_DL)")
    wrapper=(--wrapper "env TEST_CLIPS= valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite --num-callers=30
      --suppressions=/usr/share/glib-2.0/valgrind/glib.supp --suppressions=$root/tests/sanitizers/valgrind.supp")
    export G_SLICE=always-malloc
    scans_first=yes
    ;;
  --tidy | --cppcheck) analyzer=${1#--}; shift; parts+=" analysis" ;;
  --asan) shift; directory=$root/build-asan; patience=5; options+=(-Ddebug=true "-Db_sanitize=address,undefined" -Db_lundef=false -Dintrospection=disabled -Ddocs=disabled) ;;
  --tsan) shift; directory=$root/build-tsan; patience=5; options+=(-Ddebug=true -Db_sanitize=thread -Db_lundef=false -Dintrospection=disabled -Ddocs=disabled); scans_first=yes ;;
esac

# On a PC with a stable Debian, set-up includes arm64's libraries, for the test of its maps.
# shellcheck disable=SC1091 # the machine's
machine=$(. /etc/os-release && echo "${ID:-}-${VERSION_ID:-}-$(uname -m)")
target=
if [ "$directory" = "$root/build" ] && [ -z "$analyzer" ] && [[ $machine == debian-1[23]-x86_64 ]]; then
  parts+=" arm64"
  target="$here/machines/target.sh"
fi

# cppcheck reads sources alone.
if [ "$analyzer" != cppcheck ]; then
  build_project "$directory" "$parts" "" "${options[@]}"
elif [ -z "${VISUOTACTILE_NO_SETUP:-}" ]; then
  "$root/tools/setup.sh" analysis
fi

# Without arm64's libraries all other tests run, and the run fails.
lacks=
if [ -n "$target" ] && [ -z "${VISUOTACTILE_NO_SETUP:-}" ]; then
  "$target" >/dev/null || lacks="arm64_maps did not run, for want of arm64's libraries"
fi

# Of this project's own code, what is compiled here.
if [ -n "$analyzer" ]; then
  cd "$root"
  if [ $# -eq 0 ]; then
    names=('lib/*.cpp' 'lib/*.c' 'gst/*.cpp' 'tools/*.cpp')
    [ "$analyzer" = tidy ] || names+=('tests/*.cpp' 'examples/*.c')
    mapfile -t names < <(git ls-files "${names[@]}")
    set -- "${names[@]}"
  fi
  if [ "$analyzer" = tidy ]; then
    # The count of what it found in other people's headers is no finding.
    printf '%s\0' "$@" | xargs -0 -P "$(nproc)" -n 1 clang-tidy -p "$directory" --quiet 2> >(grep -v 'warnings\? generated\.$\|^Suppressed\|^Use -header-filter' >&2)
  else
    # Each file by itself, because functions for other translation units look unused in all of them. Tests are programs, so two may define
    # the same name. cppcheck 2.10 cannot read loops over chrono literals ("input was not completely consumed: 29s") and skips such tests.
    cppcheck --quiet --std=c++20 -j "$(nproc)" --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
      --suppress=unknownMacro '--suppress=ctuOneDefinitionRuleViolation:tests/*' '--suppress=cppcheckError:tests/*' -I . -I lib -I tests \
      --library=gtk "$@"
  fi
  echo "$analyzer: nothing found in $# files"
  exit 0
fi

# Suppressions are for libraries alone, each with its reason. Leaks in libraries without frame pointers are only told apart with full stacks.
supp=$root/tests/sanitizers
export ASAN_OPTIONS="detect_leaks=1:fast_unwind_on_malloc=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
export LSAN_OPTIONS="suppressions=$supp/lsan.supp:print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
export TSAN_OPTIONS="ignore_noninstrumented_modules=1:halt_on_error=1:suppressions=$supp/tsan.supp${TSAN_OPTIONS:+:$TSAN_OPTIONS}"

# A test's own limit of time, check's, beside meson's.
export CK_TIMEOUT_MULTIPLIER=$patience

# GStreamer looks through all plugins once for all tests. Under valgrind that is slow. Under ThreadSanitizer, plugins of others start threads
# then, before a test forks; in the child it ignores everything, or ends with "dup thread". die_after_fork, its default, tells of that.
if [ -n "$scans_first" ]; then
  TSAN_OPTIONS=$TSAN_OPTIONS:die_after_fork=0 meson test -C "$directory" --no-rebuild --timeout-multiplier "$patience" inherited_properties >/dev/null || true
fi

if [ ${#wrapper[@]} -gt 0 ] && [ $# -eq 0 ]; then
  mapfile -t names < <(meson test -C "$directory" --list --suite libs --suite elements | sed -n 's|.* / ||p' | grep -vxE 'allocations|hostile_tracks|tactile_meta_python')
  set -- "${names[@]}"
fi

# Most tests wait for a clock or a device rather than compute: twice as many as processors.
processes=$((2 * $(nproc)))

# The last lines are meson's, then one in a form that any CI reads.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
run_tests() { # PROCESSES [meson test arguments]
  meson test -C "$directory" --no-rebuild --print-errorlogs --num-processes "$1" --timeout-multiplier "$patience" "${wrapper[@]}" "${@:2}" 2>&1 | tee "$log"
}
count() { sed -n "s/^$1: *\([0-9][0-9]*\).*/\1/p" "$log" | tail -n 1; }
failures() { # of real-time tests: names; of all others: a word alone
  /usr/bin/python3 - "$directory/meson-logs/testlog.json" <<'END'
import json, sys
REAL_TIME = ("tools", "desk", "theatre", "usb", "chaos", "soak")
for line in open(sys.argv[1], encoding="utf-8"):
    test = json.loads(line)
    suite, _, name = test["name"].rpartition(" / ")
    if test["result"] in ("FAIL", "TIMEOUT", "ERROR", "INTERRUPT"):
        print(name if suite.rpartition(":")[2] in REAL_TIME else "*")
END
}
status=0
run_tests "$processes" "$@" || status=$?
passed=$(count Ok); failed=$(count Fail); timeouts=$(count Timeout); unexpected=$(count 'Unexpected Pass'); skipped=$(count Skipped)
failed=$((${failed:-0} + ${timeouts:-0} + ${unexpected:-0}))

# Browsers, players and servers that share a busy computer with other tests can miss a moment. In a run of everything, few such failures are run
# once more, alone, and named. Sanitizers' findings are not.
again=()
if [ "$status" -ne 0 ] && [ "$directory" = "$root/build" ] && [ $# -eq 0 ]; then
  mapfile -t again < <(failures)
fi
unsteady=
if [ ${#again[@]} -gt 0 ] && [ ${#again[@]} -le 4 ] && [ ${#again[@]} -eq "$failed" ] && [[ " ${again[*]} " != *' * '* ]]; then
  cp "$directory/meson-logs/testlog.txt" "$directory/meson-logs/testlog-first.txt"
  echo "run.sh: once more, alone: ${again[*]}"
  if run_tests 1 "${again[@]}"; then
    unsteady="; passed alone after a failure beside other tests: ${again[*]}"
    status=0
    passed=$((${passed:-0} + failed)) failed=0
  fi
fi
echo
echo "${passed:-0} passed, $failed failed, ${skipped:-0} skipped$unsteady"
if [ -n "$lacks" ]; then
  echo "run.sh: $lacks" >&2
  status=1
fi
if [ "$status" -eq 0 ] && [ "${passed:-0}" -eq 0 ]; then
  echo "run.sh: no test ran; expected at least one" >&2
  status=1
fi
exit "$status"
