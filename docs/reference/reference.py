#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the API reference of libgsttactile-1.0 with gi-docgen. Pages of the guide become pages of the reference: their links to one another and
their pictures go along, links to other files lose their target. A warning is an error, and so is a link that leads nowhere."""
import argparse
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--gi-docgen", required=True)
parser.add_argument("--gir", required=True, type=pathlib.Path)
parser.add_argument("--version", required=True)
parser.add_argument("--root", required=True, type=pathlib.Path)
parser.add_argument("--output", required=True, type=pathlib.Path)
parser.add_argument("pages", nargs="+", help="relative to the root; the first is the overview")
options = parser.parse_args()
root = options.root.resolve()

# All lie in one folder there: `docs/hardware/README.md` is hardware.md.
names = {}
for page in options.pages:
    path = pathlib.PurePath(page)
    names[root / page] = "overview" if page == options.pages[0] else path.parent.name if path.stem == "README" else path.stem
images = {}


def link(page, picture, text, target):
    """A link or a picture of this page, as it is in the reference."""
    if re.match(r"[a-z]+:", target):
        return f"{picture}[{text}]({target})"
    path, _, anchor = target.partition("#")
    file = pathlib.Path(os.path.normpath(page.parent / path)) if path else page
    if not file.exists():
        sys.exit(f"{page}: there is no {target}")
    if picture:
        images[file.name] = file
        return f"![{text}]({file.name})"
    if file not in names:
        return text
    return f"[{text}]({names[file]}.html{'#' + anchor if anchor else ''})"


def in_reference(page):
    """The text of a page, with its title where gi-docgen looks for it. Code stays as it is."""
    parts = re.split(r"(^```.*?^```$|`[^`\n]*`)", page.read_text(), flags=re.M | re.S)
    # Set aside: the text of a link may hold code.
    text = ""
    marks = []
    for index, part in enumerate(parts):
        if index % 2:
            marks.append(part)
            text += f"\0{len(marks) - 1}\0"
        else:
            text += part
    text = re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", lambda found: link(page, *found.groups()), text)
    title = re.search(r"^# (.*)", text, re.M).group(1)
    return re.sub(r"\0(\d+)\0", lambda found: marks[int(found.group(1))], f"Title: {title}\n\n{text}")


with tempfile.TemporaryDirectory() as folder:
    content = pathlib.Path(folder)
    for page, name in names.items():
        (content / f"{name}.md").write_text(in_reference(page))
    for name, file in images.items():
        shutil.copy(file, content / name)
    lines = ["[library]", 'name = "GStreamer tactile library"', f'version = "{options.version}"', 'authors = "The visuotactile authors"',
             'license = "LGPL-2.1-or-later"', 'description = "Tactile maps on video frames and as a stream"', "search_index = true",
             'dependencies = ["Gst-1.0"]', 'devhelp = true', "[theme]", 'name = "basic"', "show_index_summary = true", "[extra]",
             f"content_files = {json.dumps([name + '.md' for name in names.values()])}", f"content_images = {json.dumps(list(images))}",
             '[dependencies."Gst-1.0"]', 'name = "GStreamer"', 'description = "Pipelines of elements"',
             'docs_url = "https://gstreamer.freedesktop.org/documentation/gstreamer/gi-index.html"']
    (content / "reference.toml").write_text("\n".join(lines) + "\n")

    check = subprocess.run([options.gi_docgen, "check", "--fatal-warnings", "--config", content / "reference.toml", options.gir])
    if check.returncode != 0:
        sys.exit(check.returncode)
    shutil.rmtree(options.output, ignore_errors=True)
    made = subprocess.run([options.gi_docgen, "generate", "--quiet", "--fatal-warnings", "--no-namespace-dir", "--config", content / "reference.toml",
                           "--content-dir", content, "--output-dir", options.output, options.gir])
    if made.returncode != 0:
        sys.exit(made.returncode)

places = {file.name: file.read_text() for file in options.output.glob("*.html")}
for name, text in places.items():
    for target in re.findall(r'(?:href|src)="([^"]+)"', text):
        path, _, anchor = html.unescape(target).partition("#")
        path = path or name
        if re.match(r"[a-z]+:|//", path):
            continue
        if not (options.output / path).exists() or (anchor and path in places and f'id="{anchor}"' not in places[path]):
            sys.exit(f"{name}: the link {target} leads nowhere")
