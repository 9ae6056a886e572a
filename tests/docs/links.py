#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks that every link between pages leads to an existing file and heading. Pages are the *.md files in the root and below docs/.
Usage: links.py ROOT"""

import pathlib
import re
import sys

CODE = re.compile(r"^ *```.*?^ *```$|`[^`\n]*`", re.M | re.S)
LINK = re.compile(r"\[[^\]]*\]\(\s*([^)\s]+)\)")


def anchors(page):
    """The anchors of its headings, as forges generate them."""
    text = re.sub(r"^ *```.*?^ *```$", "", page.read_text(), flags=re.M | re.S)
    titles = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title) for title in re.findall(r"^#+ (.*)$", text, re.M)]
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


root = pathlib.Path(sys.argv[1])
wrong = []
count = 0
for page in sorted([*root.glob("*.md"), *(root / "docs").rglob("*.md")]):
    for target in LINK.findall(CODE.sub("code", page.read_text())):
        if re.match(r"[a-z]+:", target):
            continue
        count += 1
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        if not file.exists():
            wrong.append(f"{page.relative_to(root)}: there is no {target}")
        elif anchor and anchor not in anchors(file):
            wrong.append(f"{page.relative_to(root)}: no heading for {target}")

print(*wrong, f"{count} links, {len(wrong)} wrong", sep="\n")
sys.exit(bool(wrong) or count < 50)
