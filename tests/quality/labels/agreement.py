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


def levels(judged, judge, strength):
    """The mean strength that `judge` gives in each span of `judged` with this strength."""
    for start, end, _, _, own in judged:
        if own == strength:
            times = [start + i * STEP for i in range(int((end - start) / STEP))]
            seen = [span_at(judge, time)[4] for time in times if time < judge[-1][1]]
            if seen:
                yield sum(seen) / len(seen)


def main():
    ranked = []
    same, told, shared, overlap, strength = [], [], [], [], []
    for file in sorted((HERE / "second").glob("*.csv")):
        one, other = read(HERE / file.name), read(file)
        for judged, judge in (one, other), (other, one):
            ranked += [(strong > weak) + (strong == weak) / 2
                       for strong in levels(judged, judge, 3) for weak in levels(judged, judge, 1)]
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
    print(f"a blow of one reader above a gesture of the same film by the other's strength: "
          f"{share(ranked)} of {len(ranked)} pairs")


main()
