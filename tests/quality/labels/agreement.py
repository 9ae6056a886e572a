#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""How far the two readers of the films in unseen/ and unseen/second/ agree."""
import csv
import pathlib

HERE = pathlib.Path(__file__).parent / "unseen"
STEP = 0.01  # s


def read(file):
    with open(file, encoding="utf-8") as text:
        return [(float(row["start"]), float(row["end"]), row["verdict"],
                 set(row["cells"].split()), int(row["strength"] or 0))
                for row in csv.DictReader(text)]


def span_at(labels, time):
    return next(span for span in labels if span[0] <= time < span[1])


def share(values):
    return f"{sum(values) / len(values):.2f}"


def main():
    same, told, shared, overlap, strength = [], [], [], [], []
    for file in sorted((HERE / "second").glob("*.csv")):
        one, other = read(HERE / file.name), read(file)
        end = min(one[-1][1], other[-1][1])
        for i in range(1, int(end / STEP)):
            a, b = (span_at(labels, i * STEP) for labels in (one, other))
            same.append(a[2] == b[2])
            if "allowed" not in (a[2], b[2]):
                told.append(a[2] == b[2])
            if a[2] == b[2] == "felt":
                shared.append(bool(a[3] & b[3]))
                overlap.append(len(a[3] & b[3]) / len(a[3] | b[3]))
                strength.append(a[4] == b[4])
    print(f"verdicts equal: {share(same)}, where neither allows: {share(told)}")
    print(f"both felt, {len(shared) * STEP:.0f} s: a shared cell {share(shared)}, "
          f"cells of either that both name {share(overlap)}, strengths equal {share(strength)}")


main()
