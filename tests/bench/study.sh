#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The rows of the table in docs/measured/study.md: simulated studies without an effect and with some. By hand: ten minutes.
#
# Usage: study.sh [STUDIES]
set -euo pipefail
here=$(dirname "$(realpath "$0")")
for effect in 0 6 10; do
  Rscript --vanilla "$here/study_power.R" "$here/../../tools/visuotactile-study/r" "$effect" 12 "${1:-1000}" 1
done
