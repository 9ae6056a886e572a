# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks that two command traces drive each tactor alike, except for small differences.

Usage: same_commands.py A B VOLTS MS      fails if some tactor differs by more than VOLTS for longer than MS
"""
import csv
import sys


def levels(path):
    steps = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            steps.setdefault(int(row["tactor"]), []).append((int(row["effect_ns"]) // 1_000_000, float(row["volts"])))
    return steps


def course(steps, end):
    volts = [0.0] * end
    for at, value in steps:
        volts[at:] = [value] * (end - at)
    return volts


a, b = levels(sys.argv[1]), levels(sys.argv[2])
if len(a) == 0:
    sys.exit(f"{sys.argv[1]} holds no command")
end = 1 + max(at for steps in (a, b) for tactor in steps.values() for at, _ in tactor)
longest = 0
for tactor in a.keys() | b.keys():
    run = 0
    for x, y in zip(course(a.get(tactor, []), end), course(b.get(tactor, []), end)):
        run = run + 1 if abs(x - y) > float(sys.argv[3]) else 0
        longest = max(longest, run)
print(f"longest stretch in which a tactor differs by more than {sys.argv[3]} V: {longest} ms")
sys.exit(longest > float(sys.argv[4]))
