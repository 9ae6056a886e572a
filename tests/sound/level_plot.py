#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Draws the strongest level that is felt against the loudness of real sounds, from tables of sound_real on standard input, as SVG."""

import re
import sys

WIDTH, HEIGHT, LEFT, TOP = 640, 360, 60, 24
COLORS = {"explosion": "#c1440e", "impact": "#1f5fa8", "gun": "#6b4fa0", "footstep": "#2b7a3d"}


def x(db):
    return LEFT + (48 + db) / 48 * (WIDTH - LEFT - 110)


def y(level):
    return TOP + (1 - level) * (HEIGHT - TOP - 50)


lines = {}
for line in sys.stdin:
    cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
    if cells[0] in COLORS and len(cells) == 11 and cells[0] not in lines:  # the first table: without look-ahead
        lines[cells[0]] = [float(re.split(r"[ ,]+", cell)[-1]) for cell in cells[2:]]

print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13"><rect width="100%" height="100%" fill="#fff"/>')
for level in (0, 0.25, 0.5, 0.75, 1):
    print(f'<path d="M{x(-48)} {y(level)}H{x(0)}" stroke="#ddd"/><text x="{LEFT - 8}" y="{y(level) + 4}" text-anchor="end">{level:g}</text>')
for db in range(-48, 1, 12):
    print(f'<text x="{x(db)}" y="{HEIGHT - 30}" text-anchor="middle">{str(db).replace("-", "−")} dB</text>')
print(f'<text x="{x(-24)}" y="{HEIGHT - 8}" text-anchor="middle">loudness, against a peak of −3 dB of full scale</text><text x="8" y="14">strongest level felt, mean</text>')
ends = []
for kind, levels in lines.items():
    points = " ".join(f"{x(-6 * i):.1f},{y(level):.1f}" for i, level in enumerate(levels))
    print(f'<polyline points="{points}" fill="none" stroke="{COLORS[kind]}" stroke-width="2"/>')
    ends.append((y(levels[0]), kind))
last = 0.0
for at, kind in sorted(ends):
    last = max(at, last + 16)
    print(f'<text x="{x(0) + 8}" y="{last + 4:.1f}" fill="{COLORS[kind]}">{kind}</text>')
print("</svg>")
