#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Each folder of lib/ or tools/ that has a meson.build is a house. Its door is the list of headers after "Door" in that file's
comments, which others may include. Tests may include all headers. Includes have no cycles: no two houses include each other, directly or
through others, and nothing outside gst/ includes the elements' headers.
Usage: doors.py ROOT"""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
lib = root / "lib"
above = (lib, root / "tools")
houses = sorted((b.parent for top in above for b in top.rglob("meson.build") if b.parent != top), key=lambda h: -len(h.parts))
doors = {}
for house in houses:
    comments = " ".join(re.findall(r"^# ?(.*)$", (house / "meson.build").read_text(), re.M))
    doors[house] = {h for sentence in re.findall(r"\bDoor\b[^:]*: (.*?)(?:\.(?: |$)|$)", comments) for h in re.findall(r"[\w/-]+\.h\b", sentence)}


def house_of(path):
    return next((h for h in houses if path.is_relative_to(h)), None)


wrong = []
arrows = {house: set() for house in houses}
looked_at = 0
for source in sorted(p for folder in ("lib", "gst", "tools", "examples") for p in (root / folder).rglob("*") if p.suffix in (".c", ".cpp", ".h")):
    mine = house_of(source)
    for included in re.findall(r'^#\s*include ["<]([\w/.-]+)[">]', source.read_text(), re.M):
        if source.relative_to(root).parts[0] != "gst" and (root / included).is_relative_to(root / "gst") and (root / included).is_file():
            wrong.append(f"{source.relative_to(root)} includes {included}, which is an element's")
        header = next((top / included for top in above if (top / included).is_file()), None)
        theirs = house_of(header) if header else None
        if theirs is None or theirs == mine:
            continue
        looked_at += 1
        if mine is not None:
            arrows[mine].add(theirs)
        if str(header.relative_to(theirs)) not in doors[theirs] and theirs != lib / "gst" / "tactile":
            wrong.append(f"{source.relative_to(root)} includes {included}, which is inside: expected one of {theirs.relative_to(root)}/meson.build's door")

for house in houses:
    reached, next_ones = set(), set(arrows[house])
    while next_ones:
        reached |= next_ones
        next_ones = set().union(*(arrows[h] for h in next_ones)) - reached
    if house in reached:
        wrong.append(f"{house.relative_to(root)} includes what includes it")

print(*wrong, f"{looked_at} ways into {len(houses)} houses, {len(wrong)} wrong", sep="\n")
sys.exit(bool(wrong) or looked_at < 50)
