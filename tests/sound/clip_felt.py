#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rows of a table: how much of a film's time its sound is felt, in all and between times.

Usage: clip_felt.py MAPS [BEGIN-END NAME] ...      MAPS: soundtactile's, 3 x 3 cells, 100 a second, as they are"""

import sys

import numpy as np

levels = np.fromfile(sys.argv[1], "<f4").reshape(-1, 9).max(axis=1)
for span, name in [(f"0-{len(levels) / 100}", "all")] + list(zip(sys.argv[2::2], sys.argv[3::2])):
    begin, end = (round(100 * float(time)) for time in span.split("-"))
    part = levels[begin:end]
    print(f"| {begin / 100:.2f}–{end / 100:.2f} s | {name} | {100 * (part > 0).mean():.1f} % | {part.max():.2f} |")
