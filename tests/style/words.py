#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pages written by hand and manual pages use the words of docs/guide/glossary.md, and their sentences name a subject. Code, links and messages in
quotes are left out.

Usage: words.py SOURCE_FOLDER"""

import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
# What is refused, and what to write instead.
REFUSED = [
    (r"(?:^|[.:;|] |- )(?:Of|Else|Nor) [a-z]", "a sentence that begins with its subject"),
    (r"(?:^|[.:] |- )What (?:is|was|it|they|comes|came|an?|the) ", "a noun instead of 'what'"),
    (r"\b(?:it is said|is told|are told|cannot be told|be told)\b", "post, report or notify"),
    (r"\b(?:tells|hears)\b", "report, post or receive"),
    (r"\b(?:lets all be|let all be) felt\b", "delay or advance the vibration"),
    (r"\bstrangers?\b", "unknown device"),
    (r"\bunasked\b", "'never uses', or what must be named"),
    (r"\b(?:is|are|was|were) passed over\b", "skip"),
    (r"\bgoes on to be\b|\bgo on to be\b", "continue"),
    (r"\bsays so\b|\btells so\b", "what is posted or printed"),
]
names = subprocess.run(["git", "-c", f"safe.directory={root}", "-C", root, "ls-files", "*.md", "*.h2m"], check=True, capture_output=True, text=True).stdout.split()
wrong = []
pages = 0
for name in names:
    text = (root / name).read_text()
    if re.search(r"^(?:Made by .*do not edit|<!-- Made by )", text, re.M):
        continue
    pages += 1
    text = re.sub(r"^ *```.*?^ *```$|`[^`\n]*`|\"[^\"\n]*\"|\]\([^)\n]*\)", lambda code: "\n" * code.group().count("\n") + "x", text, flags=re.M | re.S)
    for number, line in enumerate(text.split("\n"), 1):
        wrong += [f"{name}:{number}: '{found.group().strip()}': expected {instead}" for refused, instead in REFUSED if (found := re.search(refused, line))]

print(*wrong, f"{pages} pages, {len(wrong)} words", sep="\n")
sys.exit(bool(wrong) or pages < 30)
