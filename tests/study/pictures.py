#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the pictures of docs/measured/study.md: each page of a session, and the report's figure of data that were made to the paper's figures. By hand.

Usage: meson devenv -C build ../tests/study/pictures.py [FOLDER]      FOLDER: by default docs/images/study
"""
import os
import pathlib
import sys
import tempfile

from PIL import Image

import report
import sessions
from study_page import HERE, Person, Server, chromium, small_study

PAGES = ("consent", "instructions", "film", "questionslider", "rest", "questionlikert", "questiontext", "done")
GAP, GRAY = 10, "#8a94a0"


def likert_scale(browser):
    with small_study() as folder, Server(folder) as server:
        server.act("start")
        Person(browser, server, 5).go(before=lambda state: sessions.look(browser, state, "questionlikert") if "L1" in state["step"]["name"] else None)


def side_by_side(pictures):
    """Two columns, at half the size."""
    width, height = (side * 52 // 100 for side in pictures[0].size)
    rows = -(-len(pictures) // 2)
    sheet = Image.new("RGB", (2 * width + 3 * GAP, rows * height + (rows + 1) * GAP), GRAY)
    for i, picture in enumerate(pictures):
        sheet.paste(picture.resize((width, height), Image.Resampling.LANCZOS), (GAP + i % 2 * (width + GAP), GAP + i // 2 * (height + GAP)))
    return sheet


def save(picture, path):
    picture.convert("RGB").quantize(64).save(path, optimize=True)


to = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent.parent / "docs/images/study"
with tempfile.TemporaryDirectory(prefix="study-pictures-") as parent, chromium(width=1000, height=640) as browser:
    folder = sessions.pictures = pathlib.Path(parent)
    sessions.people = 1
    for take in (sessions.the_paper_study, sessions.a_film_that_is_cut_off, likert_scale):
        take(browser)
    taken = {path.stem: Image.open(path).convert("RGB") for path in folder.glob("*.png")}
    with chromium(width=1000, height=640, scale=2) as large:
        likert_scale(large)
    taken["participant-200"] = Image.open(folder / "questionlikert.png").convert("RGB")
    os.environ["PICTURES"] = str(folder / "report")
    (folder / "paper").mkdir()
    report.the_papers_conclusions(folder / "paper")
    taken["figure"] = Image.open(folder / "report/figure.png")
    to.mkdir(parents=True, exist_ok=True)
    save(side_by_side([taken[page] for page in PAGES]), to / "participant.png")
    for name in ("participant-200", "experimenter", "experimenter-film", "figure"):
        save(taken[name], to / f"{name}.png")
