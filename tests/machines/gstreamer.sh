#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs the elements' tests of a build on this machine with other releases' GStreamer, and prints a table. The tests are not compiled again: of
# binaries that this machine built, what GStreamer does otherwise is seen, not what another compiler does.
#
# Usage: tests/machines/gstreamer.sh BUILD_FOLDER [--gapless[=TIMES]] [RELEASE...]      (default: trixie sid; `here` is this machine's own)
#   --gapless   two films without a gap in playbin3, TIMES (50) times with the chair and without it
#
# Fails if a test failed. Tests of this machine's other programs (servers, X) are those programs' here, too.
set -euo pipefail
case ${1:-} in
  '' | -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../.." && pwd)
build=$(cd "$1" && pwd)
shift
times=
releases=()
for argument in "$@"; do
  case $argument in
    --gapless) times=50 ;;
    --gapless=*) times=${argument#*=} ;;
    -*) echo "gstreamer.sh: expected --gapless or a release of Debian, got '$argument'" >&2; exit 2 ;;
    *) releases+=("$argument") ;;
  esac
done
[ ${#releases[@]} -gt 0 ] || releases=(trixie sid)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# with RELEASE PROGRAM...: by the release's loader and libraries
with() {
  local folder run=()
  if [ "$1" != here ]; then
    folder=$("$here/target.sh" amd64 "$1")
    run=("$folder/run")
  fi
  GST_PLUGIN_PATH_1_0=$build/gst GST_REGISTRY_1_0=$work/$1.registry LD_LIBRARY_PATH=$build/lib/gst/tactile VISUOTACTILE_MODULES=$build/lib/modules \
    XDG_STATE_HOME=$work/state TEST_DATA=$source/tests/check/data TEST_CLIPS=$source/../shared/data/clips \
    TEST_PHOTOGRAPHS=$source/../shared/data/osie G_DEBUG=fatal-warnings "${run[@]}" "${@:2}"
}
version() {
  local program
  program=$(command -v gst-inspect-1.0 || true)
  [ "$1" = here ] || program=$("$here/target.sh" amd64 "$1")/root/usr/bin/gst-inspect-1.0
  with "$1" "$program" --version | sed -n 's/^GStreamer //p'
}

failed=0
if [ -n "$times" ]; then
  echo "| GStreamer | gapless with the chair | without it |"
  echo "|---|---|---|"
  for release in "${releases[@]}"; do
    row="| $(version "$release") |"
    for of in gapless "gapless without the chair"; do
      good=0
      for ((i = 0; i < times; i++)); do
        if CK_RUN_CASE=$of CK_DEFAULT_TIMEOUT=60 with "$release" "$build/tests/check/elements-visuotactiledecoder_players" >"$work/said" 2>&1; then
          good=$((good + 1))
        else
          sed "s/^/$release, $of, play $((i + 1)): /" "$work/said" >&2
          [ "$of" != gapless ] || failed=1
        fi
      done
      row+=" $good of $times |"
    done
    echo "$row"
  done
  exit $failed
fi

echo "| test | $(for release in "${releases[@]}"; do printf '%s | ' "$(version "$release")"; done)"
echo "|---|${releases[*]/*/---|}" | tr -d ' '
for test in "$build"/tests/check/elements-*; do
  [ -f "$test" ] || continue
  row="| ${test##*/elements-} |"
  for release in "${releases[@]}"; do
    if CK_DEFAULT_TIMEOUT=120 with "$release" "$test" >"$work/said" 2>&1; then
      row+=" $(sed -n 's/.*Checks: \([0-9]*\),.*/\1/p' "$work/said" | paste -sd+) passed |"
    else
      failed=1
      row+=" $(sed -n 's/.*Failures: \([0-9]*\), Errors: \([0-9]*\)/\1 failed, \2 died/p' "$work/said" | paste -sd+) |"
      sed "s/^/$release: /" "$work/said" >&2
    fi
  done
  echo "$row"
done
exit $failed
