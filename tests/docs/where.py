#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""docs/design/where.md names the file of each property, message, driver, format, program, environment variable, name on the session bus and
meta: nothing is missing, nothing is stale, the files exist, and the file that declares a name contains it. Properties are those of
docs/elements, which the test "elements" compares with the plugins.
Usage: where.py ROOT"""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
page = (root / "docs/design/where.md").read_text()
wrong = []


def names(cell):
    return re.findall(r"`([^`]+)`", cell)


def rows(title):
    """Cells of the table below a heading."""
    section = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", page, re.M | re.S).group(1)
    return [[cell.strip() for cell in row.split(" | ")] for row in re.findall(r"^\| (.*) \|$", section, re.M)][1:]


def source(name):
    file = root / name
    if not file.exists():
        wrong.append(f"there is no {name}")
    return file.read_text() if file.is_file() else ""


def compare(kind, expected, listed):
    wrong.extend(f"{kind} {name} is not in the table" for name in sorted(expected - listed))
    wrong.extend(f"{kind} {name} is in the table and not in the sources" for name in sorted(listed - expected))


def section_of(text, title):
    found = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    return found.group(1) if found else ""


properties = {f"{file.stem} {name}" for file in (root / "docs/elements").glob("*.md") for name in re.findall(r"^- `([\w-]+)` \(", section_of(file.read_text(), "Properties"), re.M)}
listed = set()
for heading, table in re.findall(r"^### (.*)\n((?:(?!#).*\n)*)", section_of(page, "Properties"), re.M):
    *elements, declared = names(heading)
    text = source(declared)
    for of_element, effect in (row.split(" | ") for row in re.findall(r"^\| (`.*) \|$", table, re.M)):
        listed |= {f"{element} {name}" for element in elements for name in names(of_element)}
        wrong += [f"{declared} does not declare {name}" for name in names(of_element) if f'"{name}"' not in text]
        for file in names(effect):
            source(file)
compare("property", properties, listed)

# Names of structures, also by a constant of the file; lower case with hyphens, unlike keys of other structures.
structures = set()
for file in sorted((root / "gst").rglob("*.cpp")):
    text = file.read_text()
    for literal, constant in re.findall(r'gst_structure_(?:(?:new|new_empty)\(\s*|set_name\(\w+,\s*)(?:"([^"]+)"|(k\w+))', text):
        structures.add(literal or re.search(rf'\b{constant}\s*=\s*"([^"]+)"', text).group(1))
listed = set()
for structure, _, declared in rows("Messages"):
    listed |= set(names(structure))
    wrong += [f"{declared} does not contain {name}" for name in names(structure) if f'"{name}"' not in source(names(declared)[0])]
compare("structure", {name for name in structures if "-" in name}, listed)

for title, pattern, file in (("Drivers", r'^    \{ "(\w+)", "', "lib/tactor/drivers/registry.cpp"), ("Formats", r'\{ "(\.[\w.]+)", TrackFormat::', "lib/tracks/formats/track_file.cpp")):
    table = rows(title)
    compare(title, set(re.findall(pattern, source(file), re.M)), {name for row in table for name in names(row[0])})
    for row in table:
        wrong += [f"there is no {name}" for name in names(row[1]) if not (root / name).is_file()]

programs = {folder.name for folder in (root / "tools").iterdir() if (folder / "main.cpp").exists()}
compare("program", programs, {name for row in rows("Programs") for name in names(row[0])})
for row in rows("Programs"):
    wrong += [f"there is no {name}" for name in names(row[1]) if not (root / name).exists()]

# Names of the program's surroundings, each with the file that uses it.
code = {file: file.read_text() for folder in ("lib", "gst", "tools") for suffix in ("*.cpp", "*.h") for file in sorted((root / folder).rglob(suffix))}
for title, pattern in (("Environment variables", r'getenv\("(VISUOTACTILE_\w+)"'), ("Programs on the session bus", r'"(org\.visuotactile\.\w+)"'),
                       ("Metas and caps", r'register_moved_map\("(\w+)"|^typedef struct _(Gst\w+Meta) |_MEDIA_TYPE "([\w/-]+)"')):
    found = {name for text in code.values() for match in re.finditer(pattern, text, re.M) for name in match.groups() if name}
    if not found:
        wrong.append(f"{title}: nothing found in the sources")
    table = rows(title)
    compare(title, found, {name for row in table for name in names(row[0])} - {"VISUOTACTILE_", "VISUOTACTILE_MUTE"})
    for row in table:
        file = root / names(row[-1])[0]
        text = "".join(part.read_text() for part in (file.iterdir() if file.is_dir() else [file]) if part.suffix in (".cpp", ".h"))
        wrong += [f"{names(row[-1])[0]} does not contain {name}" for name in names(row[0]) if name != "VISUOTACTILE_MUTE" and name not in text]

print(*wrong, f"{len(properties)} properties, {len(structures)} structures, {len(programs)} programs, {len(wrong)} wrong", sep="\n")
sys.exit(bool(wrong) or len(properties) < 80)
