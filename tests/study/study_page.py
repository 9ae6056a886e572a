# SPDX-License-Identifier: LGPL-2.1-or-later
"""A study that runs, and its pages in a real Chromium. Expects in the environment what `meson devenv -C build` sets; STUDY is the program of another place."""
import contextlib
import csv
import io
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

os.environ.setdefault("STUDY", shutil.which("visuotactile-study") or "visuotactile-study")
HERE = pathlib.Path(__file__).resolve().parent
for folder in ("desk", "tools"):
    sys.path.insert(0, str(HERE.parent / folder))
from chromium import chromium  # noqa: E402, F401
from desk_driver import LATEST, Desk, run_gst, wait_until  # noqa: E402

# Answers a trial of jsPsych as a person does: by the elements of the page. Returns whether there was one.
ANSWER = """
    const { kind, value } = arguments[0];
    const stage = document.getElementById('stage');
    const form = stage.querySelector('form');
    const slider = stage.querySelector('input[type=range]');
    const button = stage.querySelector('button');
    if (document.body.dataset.key !== arguments[0].key) return false;
    if (kind === 'question') {
      if (slider) {
        slider.value = value; slider.dispatchEvent(new MouseEvent('mousedown')); slider.dispatchEvent(new Event('input', { bubbles: true }));
        slider.dispatchEvent(new Event('change', { bubbles: true }));
        if (button.disabled) return false;
        button.click();
        return true;
      }
      if (!form) return false;
      const radios = form.querySelectorAll('input[type=radio]');
      if (radios.length > 0) radios[value - 1].click();
      else form.querySelector('textarea').value = value;
      form.requestSubmit();
      return true;
    }
    if (!button || button.disabled) return false;
    button.click();
    return true;"""


def run_study(*words, **more):  # R needs ten seconds on an idle machine
    return subprocess.run([os.environ["STUDY"], *map(str, words)], check=True, timeout=5 * LATEST, capture_output=True, text=True, **more).stdout


class Server(Desk):
    """visuotactile-study run; `with` ends it as Ctrl-C does. Asks and answers like the desk."""

    def __init__(self, folder, *options, env=None):
        self.folder = pathlib.Path(folder)
        self.errors = self.folder / "errors.txt"
        words = [os.environ["STUDY"], "run", str(folder), "--no-browser", *(() if env else ("--no-window",)), "--driver=simulator", *map(str, options)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=self.errors.open("ab"), text=True, env=env)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            self.process.wait(LATEST)
            raise RuntimeError(f"exit status {self.process.returncode}: {self.errors.read_text()}")
        self.experimenter = self.process.stdout.readline().strip()
        assert self.experimenter.startswith(self.address)
        found = urllib.parse.urlparse(self.address)
        self.port, self.path = found.port, found.path

    def kill(self):
        self.process.kill()
        self.process.wait(LATEST)
        self.process.stdout.close()

    def state(self):
        return self.get("state").json

    def act(self, name, participant=""):
        answer = self.post(self.experimenter.removeprefix(self.address) + "act", {"act": name, "participant": participant})
        assert answer.status == 200, answer.body
        return answer.json


class Person:
    """A simulated participant, who answers by a seed."""

    def __init__(self, driver, server, seed):
        self.driver, self.server, self.random = driver, server, random.Random(seed)
        self.given = {}  # step: answer
        driver.get(server.address)

    def moved_to(self, server):
        """The server was started again. The page is still open."""
        assert server.address == self.server.address
        self.server = server

    def choice(self, question):
        if question["kind"] == "slider":
            return str(self.random.randint(int(question["low"]), int(question["high"])))
        if question["kind"] == "likert":
            return str(self.random.randint(1, len(question["labels"])))
        return "Good, \"but\" short; é"

    def answer(self, state):
        """Does what the page of this state is for."""
        step = state["step"]
        value = self.choice(step["question"]) if step["kind"] == "question" else ""
        key = f"{state['participant']} {step['name']} {step['phase']}"
        wait_until(f"the page {key}", lambda: self.driver.execute_script(ANSWER, {"kind": step["kind"], "value": value, "key": key}))
        return value

    def go(self, until="done", before=lambda state: None):
        """Goes on up to a step. `before` may replace the server."""
        while True:
            state = self.server.state()
            step = state["step"]
            if step["name"] == until:
                return state
            if step["phase"] == "playing":
                wait_until("the end of the film", lambda: self.server.state()["step"]["phase"] != "playing")
                continue
            before(state)
            value = self.answer(state)
            # The server has the answer before the page has the next step.
            wait_until(f"the step after {step['name']}", lambda: (now := self.server.state()["step"])["name"] != step["name"] or now["phase"] != step["phase"])
            if step["kind"] == "question":
                self.given[step["name"]] = value


def exported(folder):
    run_study("export", folder, "--force", f"--output={folder}/answers.csv")
    return list(csv.DictReader(io.StringIO((pathlib.Path(folder) / "answers.csv").read_text(encoding="utf-8"), newline="")))


def answers_of(rows, participant):
    """As Person.given has them."""
    session = lambda row: {"practice": "0"}.get(row["session"], row["session"])
    return {f"{session(row)}/{row['question']}": row["answer"] or row["text"] for row in rows if row["participant"] == participant}


def change(folder, *replacements):
    file = pathlib.Path(folder) / "study.ini"
    text = file.read_text()
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new)
    file.write_text(text)


@contextlib.contextmanager
def paper_study(seconds=2):
    """The paper's study with short films and breaks."""
    with tempfile.TemporaryDirectory(prefix="study-", ignore_cleanup_errors=True) as parent:
        folder = pathlib.Path(parent) / "study"
        run_study("new", folder, f"--length={seconds}", "--side=160", f"--film={folder}/films/dynamic-motion.mkv")
        change(folder, ("break=121", "break=0"))
        yield folder


SMALL = """[study]
title=Small
consent=You may stop & leave <at any time>.
consent-version=3
instructions=Look.
break=0.05
[settings]
film=film.mkv
[factor touch]
levels=off;on;
[level touch off]
intensity=0
[question Q1]
text=Good?
[question L1]
text=It fits.
kind=likert
labels=no;so-so;yes;
when=touch:on;
[question E]
text=Anything else?
kind=text
time=at-end
"""


@contextlib.contextmanager
def small_study(buffers=12, rate=25):
    """Two sessions; films of `buffers` frames, `rate` a second."""
    with tempfile.TemporaryDirectory(prefix="study-", ignore_cleanup_errors=True) as folder:
        folder = pathlib.Path(folder)
        (folder / "study.ini").write_text(SMALL)
        run_gst(f"videotestsrc num-buffers={buffers} pattern=ball ! video/x-raw,width=160,height=120,framerate={rate}/1 ! vp8enc deadline=1 ! matroskamux ! filesink location={folder}/film.mkv")
        yield folder


