#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks the pages for contributors: the files they name exist, and the example on each page compiles. A page's first table names the
example's files. Its code blocks that begin with a license are the files that the table calls new, in this order; a page that only
changes files has none.

Usage: contributing.py SOURCE_FOLDER COMPILER..."""
import pathlib
import re
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1])
compiler = sys.argv[2:]
modules = ["gstreamer-check-1.0", "gstreamer-base-1.0", "gstreamer-video-1.0"]
flags = subprocess.run(["pkg-config", "--cflags", *modules], check=True, capture_output=True, text=True).stdout.split()
includes = ["lib", "gst/tactile", "tests", "tests/check/libs", "tests/check/elements"]
wrong = []
compiled = 0

for page in sorted((root / "docs/contributing").glob("*.md")):
    text = page.read_text()
    new = []
    for row in re.findall(r"^\|[^|\n]*\|(.*)\|$", text, re.M):
        parts = row.split("(new)")
        for index, part in enumerate(parts):
            for name in re.findall(r"`([\w.-]+(?:/[\w.-]+)+|\w+\.md)`", part):
                # "(new)" applies to all names before it in the cell.
                if index < len(parts) - 1:
                    new.append(name)
                elif not (root / name).exists():
                    wrong.append(f"{page.name}: there is no {name}")
    sources = [name for name in new if name.endswith((".h", ".cpp"))]
    code = [block for block in re.findall(r"^```cpp\n(.*?)^```", text, re.M | re.S) if block.startswith("// SPDX")]
    compiled += len(code)
    if len(sources) != len(code):
        wrong.append(f"{page.name}: {len(code)} files are written out, {len(sources)} are called new")
        continue
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder, name) for name in sources]
        for file, block in zip(files, code):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block)
        places = [f"-I{base}/{include}" for base in (folder, root) for include in includes]
        for file in files:
            if file.suffix == ".cpp":
                done = subprocess.run([*compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-missing-field-initializers", '-DPACKAGE="page"',
                                       *places, *flags, file], capture_output=True, text=True)
                if done.returncode != 0:
                    wrong.append(f"{page.name}: {done.stderr}")

print("\n".join(wrong) or f"the pages for contributors: {compiled} files compiled")
sys.exit(bool(wrong) or compiled < 9)
