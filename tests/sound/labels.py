#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How well a track of a film fits the film's labels (tests/quality/labels): as tests/quality/labels.h, every 40 ms.

Usage: labels.py LABELS TRACK.csv      prints precision, recall and the share of quiet time that is felt, with commas between"""

import csv
import math
import sys

STEP = 0.04


def spans(file):
    for row in csv.DictReader(open(file, encoding="utf-8")):
        cells = range(9) if row["cells"] == "*" else map(int, row["cells"].split())
        yield float(row["start"]), float(row["end"]), row["verdict"], set(cells)


def levels(file):
    """(time, nine levels), in order"""
    rows = list(csv.reader(line for line in open(file, encoding="utf-8") if not line.startswith("#")))
    return [(float(row[0]) / 1000, [float(level) for level in row[1:10]]) for row in rows[1:]]


def share(part, whole):
    return f"{part / whole:.2f}" if whole else "–"


track = levels(sys.argv[2])
right = felt = quiet = quiet_felt = found = halves = 0
at, now = 0, [0] * 9
for start, end, verdict, cells in spans(sys.argv[1]):
    hits = set()
    for step in range(math.ceil(start / STEP - 1e-6), math.ceil(end / STEP - 1e-6)):
        time = step * STEP
        while at < len(track) and track[at][0] <= time + 1e-6:
            now = track[at][1]
            at += 1
        on = max(now) > 0
        fits = on and now.index(max(now)) in cells
        if verdict == "quiet":
            quiet += 1
            quiet_felt += on
        if on and (verdict != "allowed" or len(cells) < 9):
            felt += 1
            right += fits
        if fits and verdict == "felt":
            hits.add(int((time - start) / 0.5))
    if verdict == "felt":
        halves += math.ceil((end - start) / 0.5 - 1e-6)
        found += len(hits)
print(share(right, felt), share(found, halves), share(quiet_felt, quiet), sep=", ")
