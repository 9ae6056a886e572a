#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The rows of the table in docs/measured/study.md: simulated studies without an effect and with one, 250 of each of four seeds. By hand: five minutes
# of one processor.
set -euo pipefail
here=$(dirname "$(realpath "$0")")
for effect in ${*:-0 10}; do
  Rscript --vanilla "$here/study_power.R" "$here/../../tools/visuotactile-study/r" "$effect" 12 250 1 2 3 4
done
