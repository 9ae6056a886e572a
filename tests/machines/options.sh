#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Configures and builds 'play' with each feature of meson_options.txt switched off in turn, and with all of them off. Prints a table.
#
# Usage: tests/machines/options.sh [OPTION...]      (default: all)
#   CXX, CXXFLAGS: another compiler or other flags; warnings are counted
# In the folder build-options: with ccache, what is compiled as in the folder build is not compiled again.
set -euo pipefail
case ${1:-} in
  -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
root=$(cd "$(dirname "$0")/../.." && pwd)
options=("$@")
if [ $# -eq 0 ]; then
  mapfile -t options < <(sed -n "s/^option('\([^']*\)', type: 'feature'.*/\1/p" "$root/meson_options.txt")
  options+=(auto_features)
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build=$root/build-options
failed=0
echo "| off | configured and built | warnings |"
echo "|---|---|---|"
for option in "${options[@]}"; do
  others=()
  [ "$option" = auto_features ] || others=(-Dtests=disabled -Ddocs=disabled -Dexamples=disabled)
  row=yes
  rm -rf "$build"
  if ! meson setup "$build" "$root" "${others[@]}" "-D$option=disabled" >"$work/log" 2>&1 ||
    ! ninja -C "$build" play >"$work/log" 2>&1; then
    row="**no**: $(grep -m 1 -iE 'error' "$work/log" | cut -c 1-120)"
    tail -n 20 "$work/log" >&2
    failed=1
  fi
  grep "warning:" "$work/log" >&2 || true
  echo "| $option | $row | $(grep -c 'warning:' "$work/log" || true) |"
done
exit $failed
