#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pages written by hand, manual pages, comments and messages use the words of docs/guide/glossary.md, and their sentences name a subject. On
pages, code, links and messages in quotes are left out. Pages by hand have MOST words at most, besides docs/measured,
code blocks and docs/design/where.md, whose names a test compares with the sources.

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
# What comments and messages refuse, too.
REFUSED_IN_CODE = [
    (r"\b(?:tells?|telling|told)\b", "report, post, show or notify"),
    (r"\b(?:asks?|asked|asking)\b", "query, probe or request"),
    (r"\bwhom\b|\bwhoever\b|\bunasked\b|\bstrangers?\b", "a noun of the glossary"),
    (r"^/*<? ?(?:What|Of|Who|Whose) ", "a noun as the subject"),
]
MOST = 25_000


def listed(*patterns):
    return subprocess.run(["git", "-c", f"safe.directory={root}", "-C", root, "ls-files", *patterns], check=True, capture_output=True, text=True).stdout.split()


wrong = []
pages = 0
words = 0
for name in listed("*.md", "*.h2m"):
    text = (root / name).read_text()
    if re.search(r"^(?:Made by .*do not edit|<!-- Made by )", text, re.M):
        continue
    pages += 1
    if not name.startswith(("docs/measured/", "docs/man/", "docs/design/where.md", "tests/", ".github/")):
        words += sum(bool(re.search(r"\w", word)) for word in re.sub(r"^ *```.*?^ *```$", "", text, flags=re.M | re.S).split())
    text = re.sub(r"^ *```.*?^ *```$|`[^`\n]*`|\"[^\"\n]*\"|\]\([^)\n]*\)", lambda code: "\n" * code.group().count("\n") + "x", text, flags=re.M | re.S)
    for number, line in enumerate(text.split("\n"), 1):
        wrong += [f"{name}:{number}: '{found.group().strip()}': expected {instead}" for refused, instead in REFUSED if (found := re.search(refused, line))]

if words > MOST:
    wrong.append(f"pages by hand have {words} words, expected {MOST} at most: shorten some")

CODE = re.compile(r'(?P<comment>//.*|/\*.*|^ +\* .*)|(?P<text>"(?:[^"\\\n]|\\.)*")|\'(?:[^\'\\]|\\.)\'')
sources = [name for name in listed("lib/*.h", "lib/*.cpp", "gst/*.h", "gst/*.cpp", "tools/*.h", "tools/*.cpp")]
for name in sources:
    follows = False  # a comment line of the same comment precedes
    for number, line in enumerate((root / name).read_text().split("\n"), 1):
        for part in CODE.finditer(line):
            kind = part.lastgroup
            if kind is None or (kind == "text" and " " not in part.group()):
                continue
            refused = REFUSED_IN_CODE[:3] if kind == "text" or follows or not name.startswith(("lib/", "gst/")) else REFUSED_IN_CODE
            wrong += [f"{name}:{number}: '{found.group().strip()}': expected {instead}" for pattern, instead in refused if (found := re.search(pattern, re.sub(r"`[^`]*`", "x", part.group())))]
        follows = bool(re.match(r" *//", line))

print(*wrong, f"{pages} pages, {words} words by hand, {len(sources)} sources, {len(wrong)} wrong", sep="\n")
sys.exit(bool(wrong) or pages < 30 or len(sources) < 300)
