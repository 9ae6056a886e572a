# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by the tests of tactor-calibrate: a working folder and comparisons.
# Expects CALIBRATE (the program) and the plugins on GST_PLUGIN_PATH.
set -euo pipefail
: "${CALIBRATE:?the path of tactor-calibrate}"
# shellcheck disable=SC2034 # for the tests
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
  echo "$*"
  exit 1
}

# near WHAT GOT EXPECTED TOLERANCE
near() {
  awk -v got="$2" -v want="$3" -v off="$4" 'BEGIN { exit !(got != "" && got - want <= off && want - got <= off) }' || fail "$1 is '$2' instead of $3 ± $4"
  echo "$1: $2"
}

# value TACTOR KEY [FIELD]: of chair/motors.calibration
value() {
  sed -n "/^\[Tactor $1\]/,/^\[/s/^$2=//p" chair/motors.calibration | cut -d';' -f"${3:-1}"
}

# expect_silence: each run's commands leave every motor at zero
expect_silence() {
  local trace
  for trace in chair/run-*.csv; do
    awk -F, 'NR > 1 { last[$4] = $5 } END { for (t in last) if (last[t] != 0) exit 1 }' "$trace" || fail "$trace leaves a motor on"
  done
}
