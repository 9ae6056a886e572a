# SPDX-License-Identifier: LGPL-2.1-or-later
"""The desk's page in a real Chromium, as a designer uses it. Expects TRACK (tactile-track) and what it needs in the environment."""
import contextlib
import os
import pathlib
import subprocess
import sys
import tempfile
import traceback

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from desk_driver import Desk, make_film, wait_until, Page as Listener  # noqa: E402, F401

_cache = tempfile.TemporaryDirectory(prefix="desk-cache-", ignore_cleanup_errors=True)
os.environ["XDG_CACHE_HOME"] = _cache.name  # for drafts; gone at the end

HEADER = "WEBVTT\n\nNOTE tactile grid=3x3 rate=5\n"


def cue(start, end, levels, notes=()):
    """A cue as text, as tactile-track writes it. Levels: nine, or a dict of cell to level."""
    if isinstance(levels, dict):
        levels = [levels.get(cell, 0) for cell in range(9)]
    time = lambda ms: f"{ms // 3600000:02}:{ms // 60000 % 60:02}:{ms // 1000 % 60:02}.{ms % 1000:03}"
    rows = "\n".join("".join(f"{level:3}" if i == 0 else f" {level:3}" for i, level in enumerate(levels[row:row + 3])) for row in (0, 3, 6))
    return "".join(f"\nNOTE {note}\n" for note in notes) + f"\n{time(start)} --> {time(end)}\n{rows}\n"


class Page:
    """One page in a browser."""

    def __init__(self, driver, desk):
        self.driver, self.desk = driver, desk
        self.load()

    def load(self):
        self.driver.get(self.desk.address)
        self.wait("the page", lambda: self.js("return document.body.dataset.ready"))
        self.wait("the film", lambda: self.js("return document.getElementById('video').readyState >= 2"))

    def wait(self, what, is_true):
        try:
            return wait_until(what, is_true)
        except AssertionError as error:
            raise AssertionError(f"{error}; at {self.position()} ms the page says {self.says()}, the focus is at {self.js('return document.activeElement.outerHTML')[:150]}, {self.driver.get_log('browser')}") from None

    def js(self, code, *arguments):
        return self.driver.execute_script(code, *arguments)

    def find(self, css):
        return self.driver.find_element(By.CSS_SELECTOR, css)

    def all(self, css):
        return self.driver.find_elements(By.CSS_SELECTOR, css)

    def click(self, css):
        self.find(css).click()

    def says(self):
        return self.js("return ['save-state', 'live', 'alerts', 'news', 'reader'].map((id) => document.getElementById(id)).filter((e) => !e.hidden).map((e) => e.textContent)")

    def errors(self):
        return self.js("return [...document.querySelectorAll('#alerts li span')].map((span) => span.textContent)")

    def news(self):
        return self.js("return [...document.querySelectorAll('#news li span')].map((span) => span.textContent)")

    def keys(self, *keys):
        """Keys where the focus is, one after the other; a tuple is a chord."""
        for key in keys:
            chain = ActionChains(self.driver)
            *held, last = key if isinstance(key, tuple) else (key,)
            for modifier in held:
                chain.key_down(modifier)
            chain.send_keys(last)
            for modifier in reversed(held):
                chain.key_up(modifier)
            chain.perform()

    def down(self, key):
        ActionChains(self.driver).key_down(key).perform()

    def up(self, key):
        ActionChains(self.driver).key_up(key).perform()

    def position(self):
        return self.js("return Math.round(document.getElementById('video').currentTime * 1000)")

    def paused(self):
        return self.js("return document.getElementById('video').paused")

    def go_to(self, ms):
        self.js("""const field = document.getElementById('time'); field.focus(); field.value = arguments[0];
            field.dispatchEvent(new Event('change')); field.blur()""", f"{ms / 1000:.3f}")
        self.wait(f"{ms} ms", lambda: abs(self.position() - ms) <= 1 and not self.js("return document.getElementById('video').seeking"))

    def play_until(self, ms):
        self.wait(f"the film at {ms} ms", lambda: self.position() >= ms)

    def may_write(self):
        """A page that is loaded again has to wait until the desk has noticed that the one before is gone."""
        self.wait("to write", lambda: self.find("#save").is_enabled())

    def record(self, on=True):
        self.may_write()
        if (self.find("#record").get_attribute("aria-pressed") == "true") != on:
            self.click("#record")

    def stamp(self, cell, ms):
        """One map on a cell while the film stands."""
        self.go_to(ms)
        self.record()
        self.keys(str(cell + 1))

    def choose(self, form, name, **values):
        """Fills in a form of kinds and applies it."""
        self.click(f"#{form}-tab")
        Select(self.find(f"#{form} select")).select_by_value(name)
        for option, value in values.items():
            field = self.find(f"#{form} [name={option}]")
            field.clear()
            field.send_keys(str(value))
        self.click(f"#{form} button")

    def settled(self):
        """All edits are on the disk."""
        return self.wait("all edits on the disk", lambda: self.js("return ['saved', 'journal'].includes(document.getElementById('save-state').dataset.state)"))

    def track(self):
        """What the desk has: [(start, end, {cell: level}, [note])]."""
        self.settled()
        return [(each["start"], each["end"], {cell: level for cell, level in enumerate(each["levels"]) if level}, each.get("notes", [])) for each in self.desk.get("track").json["cues"]]

    def save(self):
        self.may_write()
        self.keys((Keys.CONTROL, "s"))
        self.wait("the save", lambda: self.find("#save-state").get_attribute("data-state") == "saved")


def validate(path):
    subprocess.run([os.environ["TRACK"], "validate", str(path)], check=True, timeout=60, stdout=subprocess.DEVNULL)


def changed_lines(before, after):
    """What `diff` says: (lines taken away, lines added)."""
    diff = subprocess.run(["diff", "-U0", str(before), str(after)], capture_output=True, text=True).stdout.splitlines()[2:]
    return [line[1:] for line in diff if line[0] == "-"], [line[1:] for line in diff if line[0] == "+"]


_film = None


@contextlib.contextmanager
def desk_with(driver, cues=(), *options, seconds=20):
    """A desk for a film and a track of these cues, which are text; also gives the folder."""
    global _film
    with tempfile.TemporaryDirectory(prefix="desk-page-", ignore_cleanup_errors=True) as folder:
        folder = pathlib.Path(folder)
        film = folder / "film.webm"
        if _film is None or _film[0] != seconds:
            # Chromium cannot seek in webmmux's film with sound where it is a file, without a server.
            make_film(folder / "made.webm", seconds)
            subprocess.run(["ffmpeg", "-v", "error", "-i", folder / "made.webm", "-c", "copy", film], check=True, timeout=60)
            _film = (seconds, film.read_bytes())
        else:
            film.write_bytes(_film[1])
        end = cue(seconds * 1000 - 200, seconds * 1000, {})
        (folder / "film.vtt").write_text(HEADER + "".join(cues) + end, encoding="utf-8")
        (folder / "before.vtt").write_bytes((folder / "film.vtt").read_bytes())
        with Desk(film, *options) as desk:
            yield desk, folder
            driver.get("about:blank")


def run(tests, driver):
    """Runs functions of (driver), or those that the command line names."""
    names = sys.argv[1:]
    failed = 0
    for test in tests:
        if names and test.__name__ not in names:
            continue
        try:
            test(driver)
            print(f"ok {test.__name__}", flush=True)
        except Exception:  # each test is run, and all failures are told
            traceback.print_exc()
            print(f"not ok {test.__name__}", flush=True)
            failed += 1
        driver.get("about:blank")
        for entry in driver.get_log("browser"):
            print(f"browser: {entry['level']} {entry['message']}")
            if entry["level"] == "SEVERE" and "Failed to load resource" not in entry["message"]:
                failed += 1
    if failed:
        sys.exit(f"{failed} failed")
