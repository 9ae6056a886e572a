#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compares the levels of two tracks every 10 ms: the rest of a row of a table. A level of 0.02 is not felt.

Usage: track_difference.py ONE.csv OTHER.csv"""
import sys

import numpy

FELT = 0.02


def levels(path):
    lines = [line for line in open(path, encoding="utf-8") if line.strip() and not line.startswith("#")]
    cells = [i for i, name in enumerate(lines[0].strip().split(",")) if name.startswith("t") and name[1:].isdigit()]
    rows = numpy.array([[float(value or 0) for value in line.strip().split(",")] for line in lines[1:]])
    index = numpy.searchsorted(rows[:, 0], numpy.arange(0, rows[-1, 0], 10), side="right") - 1
    return numpy.where((index >= 0)[:, None], rows[index][:, cells], 0)


one, other = levels(sys.argv[1]), levels(sys.argv[2])
count = min(len(one), len(other))
difference = numpy.abs(one[:count] - other[:count])
differs = difference > 1e-6
alone = (one[:count] > FELT) != (other[:count] > FELT)
print(f"{100 * differs.mean():.1f} % | {difference[differs].mean() if differs.any() else 0:.3f} | {difference.max():.2f} | {100 * alone.mean():.2f} % |")
