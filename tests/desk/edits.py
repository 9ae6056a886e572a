#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page's modules and tactile-track desk together: 1000 random edits, undos and redos in Chromium reach the file, all undone it is as
it was to the byte, and neither a killed desk nor a killed browser loses an edit.

Expects what tests/tools/desk_driver.py does in the environment.
"""
import os
import pathlib
import random
import shutil
import signal
import socket
import sys
import tempfile

import webvtt

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from chromium import chromium  # noqa: E402
from desk_driver import Desk, make_film, wait_until  # noqa: E402

CELLS = 9

# A page of the modules alone: window.desk. The name of the page is given, as a test has to know it.
PAGE = """
const [page, done] = arguments;
(async () => {
  const of = (name) => import(new URL(name, location.href));
  const [{ Track }, strokes, { TEMPLATES, template }, { History }, { Sync }] =
    await Promise.all(['track.js', 'strokes.js', 'templates.js', 'history.js', 'sync.js'].map(of));
  const send = async (path, body) => {
    const answer = await fetch(path, { method: 'POST', body: JSON.stringify(body), headers: { 'Content-Type': 'application/json' } });
    return { status: answer.status, body: await answer.json() };
  };
  const events = new EventSource(`events?page=${page}`);
  await new Promise((opened) => { events.onopen = opened; });
  const load = async () => {
    const { revision, saved, cues } = await (await fetch('track')).json();
    return [new Track(3, 3, cues), revision, saved];
  };
  const [track, revision, saved] = await load();
  const history = new History(track);
  const sync = new Sync(history, { page, send, revision, saved, name: 'the track' });
  const writer = (await send('writer', { page })).body;
  const found = await sync.recover();
  if (found.sent > 0) sync.reload(...await load());
  window.desk = { history, sync, strokes, TEMPLATES, template, events };
  return [writer, found];
})().then(done, (error) => done(String(error.stack)));
"""

# As many random edits; waits now and then, so that requests are under way.
EDIT = """
const [seed, count, done] = arguments;
(async () => {
  const { history, strokes, TEMPLATES, template } = desk;
  let state = seed;
  const pick = (from, to) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return from + Math.floor(state / 2 ** 32 * (to - from));
  };
  const edits = [
    (selection) => strokes.draw(history.track, selection, pick(0, 101)),
    (selection) => strokes.erase(history.track, selection),
    (selection) => strokes.setLevel(history.track, selection, pick(1, 101)),
    (selection) => strokes.fade(history.track, selection, pick(0, 150), pick(0, 150)),
    (selection) => strokes.move(history.track, selection, { ms: pick(-500, 500), rows: pick(-1, 2), columns: pick(-1, 2) }),
    (selection) => strokes.stretch(history.track, selection, { from: selection.from, to: selection.to + pick(1, 300) }),
    (selection) => strokes.split(history.track, selection, selection.from),
    (selection) => strokes.merge(history.track, selection),
    (selection) => strokes.paste(history.track, strokes.copy(history.track, selection), { at: pick(0, 7000), cell: pick(0, 9) }),
    (selection) => strokes.paint(history.track, template(TEMPLATES[pick(0, 4)].name, history.track, selection)),
    () => (history.track.cues.length === 0 ? [] : strokes.setNotes(history.track, pick(0, history.track.cues.length),
      pick(0, 2) === 0 ? [] : [`note ${pick(0, 99)}\\nof a designer: ä & <b>`])),
  ];
  for (let i = 0; i < count; i++) {
    const dice = pick(0, 10);
    const from = pick(0, 7000);
    const cells = [0, 1, 2, 3, 4, 5, 6, 7, 8].filter(() => pick(0, 3) === 0);
    if (dice < 2) history.undo();
    else if (dice < 3) history.redo();
    else history.do(edits[pick(0, edits.length)]({ from, to: from + pick(1, 800), ...(cells.length > 0 && { cells }) }), { label: 'x' });
    if (pick(0, 4) === 0) await new Promise((next) => setTimeout(next));
  }
})().then(() => done(null), (error) => done(String(error.stack)));
"""

SETTLE = """
const [states, done] = arguments;
const look = () => {
  if (!states.includes(desk.sync.state)) return false;
  desk.sync.removeEventListener('state', look);
  done(desk.sync.text);
  return true;
};
if (!look()) desk.sync.addEventListener('state', look);
"""


def equal(got, expected, what):
    if got != expected:
        raise AssertionError(f"{what}: expected {str(expected)[:2000]}, got {str(got)[:2000]}")


def a_track():
    """A file as people write them: comments, identifiers, settings, gaps, uneven spaces."""
    pick = random.Random(3)
    blocks = ["WEBVTT a track\n\nNOTE tactile grid=3x3 rate=5\n"]
    time = 0
    while time < 7500:
        end = time + pick.choice([40, 200, 350, 600])
        levels = [pick.choice([0, 0, 0, 25, 75, 100]) for _ in range(CELLS)]
        rows = "\n".join(" ".join(f"{level:{pick.choice([1, 3, 5])}d}" for level in levels[i:i + 3]) for i in (0, 3, 6))
        note = "NOTE is this one felt?\n\n" if pick.random() < 0.2 else ""
        name = f"cue {time}\n" if pick.random() < 0.2 else ""
        blocks.append(f"{note}{name}00:0{time // 1000}.{time % 1000:03d} --> 00:0{end // 1000}.{end % 1000:03d}\n{rows}\n")
        time = end + pick.choice([0, 0, 150])
    return "\n".join(blocks)


def open_page(driver, desk, page):
    driver.get(desk.address)
    return driver.execute_async_script(PAGE, page)


def cues_of(driver):
    return [cue | {"notes": cue.get("notes") or []} for cue in driver.execute_script("return desk.history.track.cues")]


def at_the_desk(desk):
    return [cue | {"notes": cue.get("notes") or []} for cue in desk.get("track").json["cues"]]


def in_the_file(path):
    """Cues as another library reads them."""
    return [{"start": milliseconds(cue.start), "end": milliseconds(cue.end),
             "levels": [int(level) for level in cue.raw_text.split()]} for cue in webvtt.read(str(path))]


def milliseconds(text):
    hours, minutes, seconds = text.split(":")
    whole, rest = seconds.split(".")
    return ((int(hours) * 60 + int(minutes)) * 60 + int(whole)) * 1000 + int(rest)


def edit(driver, seed, count):
    equal(driver.execute_async_script(EDIT, seed, count), None, "edits")


def settle(driver, *states):
    return driver.execute_async_script(SETTLE, states)


def save(driver):
    equal(driver.execute_async_script("const done = arguments[0]; desk.sync.save().then(() => done(null), (error) => done(String(error)))"), None, "saved")


def random_edits(folder):
    film, track = folder / "film.webm", folder / "film.vtt"
    track.write_text(a_track(), encoding="utf-8")
    original = track.read_bytes()
    with chromium() as driver:
        with Desk(film, track) as desk:
            port = desk.port
            equal(open_page(driver, desk, "first"), [{"writer": True}, {"sent": 0, "kept": 0}], "the page writes")
            edit(driver, 1, 1000)
            settle(driver, "journal")
            equal(at_the_desk(desk), cues_of(driver), "after 1000 steps the desk has the page's track")
            driver.execute_script("while (desk.history.undo() !== null);")
            save(driver)
            equal(track.read_bytes(), original, "all undone, the file is as it was")
            driver.execute_script("while (desk.history.redo() !== null);")
            save(driver)
            equal(in_the_file(track), [{key: cue[key] for key in ("start", "end", "levels")} for cue in cues_of(driver)], "all done again, it has the edits")
            # A desk that is killed while the page goes on.
            edit(driver, 2, 50)
            desk.end(signal.SIGKILL)
            edit(driver, 3, 50)
            equal(settle(driver, "waiting").startswith("Not sent: "), True, "the page says so")
            mine = cues_of(driver)
        with Desk(film, track) as desk:
            equal(desk.port, port, "the track's usual port, so that the browser knows the page")
            writer, found = open_page(driver, desk, "second")
            equal((writer, found["sent"] > 0, found["kept"]), ({"writer": True}, True, 0), "the next page sends what was left")
            equal(at_the_desk(desk), mine, "nothing is lost")
            equal(cues_of(driver), mine, "the next page has it, too")
            # A browser that is killed.
            edit(driver, 4, 100)
            settle(driver, "journal")
            mine = cues_of(driver)
            os.kill(driver.capabilities["goog:processID"], signal.SIGKILL)
            wait_until("the desk to know that the browser is gone", lambda: desk.get("session").json["writer"] is None)
            equal(at_the_desk(desk), mine, "the desk has what the killed browser had")
            with chromium() as other:
                equal(open_page(other, desk, "third")[0], {"writer": True}, "another browser goes on")
                equal(cues_of(other), mine, "with all of it")


def a_port_that_is_taken(folder):
    film, tracks = folder / "film.webm", [folder / f"{name}.vtt" for name in ("one", "two")]
    for track in tracks:
        track.write_text(a_track(), encoding="utf-8")
    with Desk(film, tracks[0]) as desk:
        usual = desk.port
    with socket.socket() as line:
        line.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        line.bind(("127.0.0.1", usual))
        line.listen()
        with Desk(film, tracks[0]) as desk:
            equal(desk.port != usual and desk.get("session").status == 200, True, "another port")
    with Desk(film, tracks[0]) as one, Desk(film, tracks[1]) as two:
        equal((one.port, two.port != usual), (usual, True), "two desks")


def main():
    with tempfile.TemporaryDirectory(prefix="desk-edits-") as name:
        folder = pathlib.Path(name)
        # The page's modules, without what it does with them by itself.
        page = folder / "page"
        shutil.copytree(pathlib.Path(__file__).resolve().parents[2] / "tools/tactile-track-desk/page", page)
        (page / "index.html").write_text('<!doctype html><html lang="en"><meta charset="utf-8"><title>Edits</title></html>', encoding="utf-8")
        os.environ["VISUOTACTILE_DESK_PAGE"] = str(page)
        make_film(folder / "film.webm")
        for test in (random_edits, a_port_that_is_taken):
            test(folder)
            print(f"ok {test.__name__}", flush=True)


main()
