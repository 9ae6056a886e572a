#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes page/export-template.html, one file that needs no other: film_page.html with its style, its script and the modules that the script imports. The policy in it names the hashes of both, so that nothing else runs.

Usage: make.py [--check]    --check writes nothing and fails if the file is not what would be written"""

import base64
import hashlib
import pathlib
import re
import sys

folder = pathlib.Path(__file__).resolve().parent
template = folder.parent / "page" / "export-template.html"
IMPORT = re.compile(r"^import .* from '(.*)';\n", re.M)


def hashed(text):
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def script(path):
    text = path.read_text(encoding="utf-8").replace("// SPDX-License-Identifier: LGPL-2.1-or-later\n", "")
    modules = [script((path.parent / name).resolve()) for name in IMPORT.findall(text)]
    return "".join(modules) + re.sub(r"^export ", "", IMPORT.sub("", text), flags=re.M)


style = "\n" + (folder / "film_page.css").read_text(encoding="utf-8")
code = "\n// SPDX-License-Identifier: LGPL-2.1-or-later" + script(folder / "film_page.js")
policy = f"default-src 'none'; script-src {hashed(code)}; style-src {hashed(style)}; media-src 'self' file: blob:; base-uri 'none'; form-action 'none'"
html = (folder / "film_page.html").read_text(encoding="utf-8")
for name, text in {"POLICY": policy, "STYLE": style, "SCRIPT": code}.items():
    assert html.count(f"@{name}@") == 1, f"film_page.html: expected @{name}@ once"
    html = html.replace(f"@{name}@", text)
assert html.count("@DATA@") == 1, "expected @DATA@ once: the desk puts film and track there"
if "--check" in sys.argv[1:]:
    if not template.exists() or template.read_text(encoding="utf-8") != html:
        sys.exit(f"{template} is not what {pathlib.Path(__file__).name} makes: run it")
else:
    template.write_text(html, encoding="utf-8")
