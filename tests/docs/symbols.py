#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The library exports the functions that its headers declare, no other, and debian/libgsttactile-1.0-0.symbols lists them with the release
that added each, which is not later than this one. A symbol that was listed once stays: docs/guide/library.md promises it.
Usage: symbols.py ROOT LIBRARY"""

import pathlib
import re
import subprocess
import sys

root, library = pathlib.Path(sys.argv[1]), sys.argv[2]
exported = set(re.findall(r"^\w+ [TDBRVW] (\w+)", subprocess.run(["nm", "--dynamic", "--defined-only", library], check=True, capture_output=True, text=True).stdout, re.M))
declared = {name for header in (root / "lib/gst/tactile").glob("*.h") for name in re.findall(r"\bGST_TACTILE_API\b[^;(]*?\b(gst_\w+)\s*\(", header.read_text())}
symbols = (root / "debian/libgsttactile-1.0-0.symbols").read_text()
since = dict(re.findall(r"^ (\w+)@Base (\S+)", symbols, re.M))
soname = symbols.split()[0]
version = re.search(r"^  version: '(.*)',", (root / "meson.build").read_text(), re.M).group(1)


def number(text):
    return [int(part) for part in text.split(".")]


wrong = []
for what, names in (("declared in lib/gst/tactile", declared), ("listed in debian/libgsttactile-1.0-0.symbols", set(since))):
    wrong += [f"{name} is exported and not {what}" for name in sorted(exported - names)]
    wrong += [f"{name} is {what} and not exported" for name in sorted(names - exported)]
wrong += [f"{name} is since {release}, after this version, {version}" for name, release in since.items() if number(release) > number(version)]
dynamic = subprocess.run(["readelf", "--dynamic", library], check=True, capture_output=True, text=True).stdout
if f"[{soname}]" not in dynamic:
    wrong.append(f"expected the library's name to be {soname}, which programs were linked to")
print(*wrong, f"{len(exported)} functions, {len(wrong)} wrong", sep="\n")
sys.exit(bool(wrong) or not exported)
