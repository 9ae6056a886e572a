#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sessions of visuotactile-study in a real Chromium with simulated participants: orders, completeness, kills at every page, films that fail.

Usage: sessions.py [--people=N] [TEST ...]      N: by default 2; 12 is the paper's study
"""
import collections
import csv
import os
import pathlib
import signal
import subprocess
import sys

from study_page import Person, Server, answers_of, chromium, change, exported, paper_study, run_study, small_study, wait_until
from selenium.webdriver.common.by import By

people = 2
pictures = None  # the folder of pictures.py


def picture(driver, name):
    if pictures:
        driver.save_screenshot(str(pictures / f"{name}.png"))


def look(driver, state, name):
    """Takes a picture of the page of this state."""
    key = f"{state['participant']} {state['step']['name']} {state['step']['phase']}"
    wait_until(f"the page {key}", lambda: driver.execute_script("return document.body.dataset.key === arguments[0] && document.querySelector('#stage button, #stage input')", key))
    picture(driver, name)


def volts_of(path):
    with path.open() as trace:
        return [float(row["volts"]) for row in csv.DictReader(trace)]


def the_paper_study(driver):
    """From the first page to the table: everybody answers everything once; conditions are balanced; the chair vibrates with cues alone."""
    with paper_study() as folder, Server(folder) as server:
        given = {}
        for number in range(1, people + 1):
            name = f"P{number:02}"
            driver.get(server.experimenter)
            wait_until("the experimenter's page", lambda: driver.execute_script("return document.body.dataset.ready && !document.getElementById('start').disabled"))
            driver.find_element(By.ID, "start").click()
            wait_until("a participant", lambda: server.state()["participant"] == name and server.state()["step"]["name"] == "consent")
            person = Person(driver, server, number)
            seen = set()

            def look_once(state):
                kind = state["step"]["kind"] + state["step"].get("question", {}).get("kind", "")
                if number == 1 and kind not in seen:
                    seen.add(kind)
                    look(driver, state, kind)
            person.go(before=look_once)
            given[name] = person.given
            assert len(person.given) == 4 + 6 * 4 + 3 * 2 + 1
        wait_until("the thanks", lambda: "Thank you" in driver.find_element(By.ID, "stage").text)
        picture(driver, "done")
        driver.get(server.experimenter)
        wait_until("the last participant", lambda: f"{people} of 12" in driver.find_element(By.ID, "count").text)
        picture(driver, "experimenter")
        rows = exported(folder)
        for name, answers in given.items():
            assert answers_of(rows, name) == answers, name
        assert len(rows) == people * 35
        orders = list(csv.reader(run_study("status", "--orders", folder).splitlines()))[1:]
        assert len(orders) == people
        for position in range(6):
            at = collections.Counter(order[4 + position] for order in orders)
            assert max(at.values()) - (min(at.values()) if len(at) == 6 else 0) <= 1, at
        after = collections.Counter((order[i], order[i + 1]) for order in orders for i in range(4, 9))
        assert max(after.values()) <= -(-people // 6), after
        for row in rows:
            if row["session"] == "end":
                continue
            assert set(row["marks"].split()) <= {"not-shown", "no-noise", "simulated", "no-commands"}, row
            assert row["state"] == "done" and row["consent"] == "1" and row["settings"] and row["program"] and row["gstreamer"]
            assert int(row["frames"]) + int(row["frames_dropped"]) > 0, row
            volts = volts_of(folder / "data" / row["trace"])
            assert len(volts) == int(row["commands"])
            if row["cues"] == "without":
                assert not any(volts)
            elif row["cues"] == "with" and row["film"] != "static":
                assert any(volts), row
        print(f"{people} people, {len(rows)} answers, {sum('late' in row['marks'].split() for row in rows)} in late sessions", flush=True)


def killed_at_every_page(driver):
    """kill -9 at each page, before the answer and after it: the next server begins at the right step, with all answers."""
    with small_study() as folder:
        servers = [Server(folder)]
        servers[-1].act("start")
        person = Person(driver, servers[-1], 5)
        steps = []

        def kill(state):
            steps.append(state["step"]["name"])
            for _ in range(2 if state["step"]["kind"] == "question" else 1):
                servers[-1].kill()
                servers.append(Server(folder))
                again = servers[-1].state()
                assert again["participant"] == "P01" and again["step"]["name"] == state["step"]["name"], (again, state)
            person.moved_to(servers[-1])
        person.go(before=kill)
        servers[-1].end()
        rows = exported(folder)
        assert answers_of(rows, "P01") == person.given and len(rows) == 4, rows
        assert [step for step in steps if "/" not in step] == ["consent", "instructions"] and len(steps) == len(set(steps)) == 9, steps
        assert all(row["marks"] in ("", "not-shown simulated", "not-shown simulated no-commands") for row in rows), rows


def killed_between_question_and_answer(driver):
    """The server dies with an answer that it has been sent: the page, which nobody touches, gives it to the next one. A refused text is kept in the page."""
    with small_study() as folder:
        server = Server(folder)
        server.act("start")
        person = Person(driver, server, 8)
        state = person.go("1/Q1")
        driver.execute_script("const send = fetch; window.sent = 0; window.fetch = (...words) => { window.sent += 1; return send(...words); };")
        os.kill(server.process.pid, signal.SIGSTOP)
        given = {**person.given, "1/Q1": person.answer(state)}
        wait_until("the request", lambda: driver.execute_script("return window.sent > 0"))
        server.kill()
        wait_until("the trouble", lambda: "does not answer" in driver.find_element(By.ID, "trouble").text)
        with Server(folder) as server:
            person.moved_to(server)
            person.given = given
            wait_until("the next step", lambda: server.state()["step"]["name"] != "1/Q1")
            person.choice = lambda question, choice=person.choice: "x" * 30_001 if question["name"] == "E" else choice(question)
            person.answer(person.go("end/E"))
            wait_until("the reason", lambda: "at most 30000 bytes" in driver.find_element(By.ID, "trouble").text)
            wait_until("the text", lambda: driver.execute_script("return document.querySelector('#stage textarea')?.value.length === 30001"))
            assert driver.execute_script("return document.querySelector('#stage textarea').maxLength") == 10_000
            del person.choice
            person.go()
            for name in folder.joinpath("data").glob(".pages"):
                assert name.stat().st_mode & 0o777 == 0o600
        assert answers_of(exported(folder), "P01") == person.given


def a_file_system_without_permissions(_driver):
    """Secrets that others could read are not kept, and the program says so."""
    with small_study() as folder:
        addresses = set()
        for _ in range(2):
            with Server(folder, "--no-window", env={**os.environ, "LD_PRELOAD": os.environ["NO_MODES"]}) as server:
                addresses |= {server.address, server.experimenter}
                assert not folder.joinpath("data/.pages").exists()
        assert len(addresses) == 4, addresses
        assert "keep data of people on a file system with permissions" in server.errors.read_text()
        with Server(folder) as server:  # with permissions, they are
            assert folder.joinpath("data/.pages").exists()


def a_film_that_is_cut_off(driver):
    """The server is killed while a film plays; the experimenter plays it again, then stops one and skips it: both sessions are marked."""
    with small_study(buffers=3600, rate=1) as folder:
        server = Server(folder)
        server.act("start")
        person = Person(driver, server, 6)
        person.go("1/film")
        person.answer(server.state())
        wait_until("the film", lambda: server.state()["step"]["phase"] == "playing")
        server.kill()
        server = Server(folder)
        assert server.state()["step"]["phase"] == "failed"
        driver.get(server.experimenter)
        wait_until("the button", lambda: driver.find_element(By.ID, "again").is_enabled())
        driver.find_element(By.ID, "again").click()
        wait_until("the levels of the chair", lambda: driver.find_elements(By.CSS_SELECTOR, "#chair div"))
        assert "playing, play 2" in driver.find_element(By.ID, "sessions").text
        picture(driver, "experimenter-film")
        driver.find_element(By.ID, "stop").click()
        wait_until("the end of the film", lambda: driver.find_element(By.ID, "go-on").is_enabled())
        driver.get(server.address)
        person.moved_to(server)
        wait_until("the page", lambda: "call the experimenter" in driver.find_element(By.ID, "stage").text)
        server.act("go-on", "P01")
        wait_until("the next step", lambda: server.state()["step"]["name"] == "1/Q1")
        person.go("1/break")
        server.end()
        assert {row["marks"] for row in exported(folder)} == {"repeated stopped not-shown simulated"}


def groups_and_a_questionnaire(driver):
    """A factor between people, which the experimenter sees, and a questionnaire from a file."""
    with small_study() as folder:
        (folder / "hxi.txt").write_text("# The authors' words\n\nIt felt right.\nIt was late.\n")
        change(folder, ("[question Q1]", "[factor age]\nlevels=young;old;\ndesign=between\n[question Q1]"),
               ("[question E]", "[questionnaire HXI]\nfile=hxi.txt\nkind=likert\nlabels=no;so-so;yes;\nwhen=touch:on;\n[question E]"))
        given = {}
        with Server(folder) as server:
            for number, group in ((1, "young"), (2, "old")):
                server.act("start")
                person = Person(driver, server, number)
                person.go()
                given[f"P0{number}", group] = person.given
                driver.get(server.experimenter)
                wait_until("the group", lambda: driver.find_element(By.ID, "who").text == f"P0{number}, {group}")
        rows = exported(folder)
        for (name, group), answers in given.items():
            assert answers_of(rows, name) == answers and {row["age"] for row in rows if row["participant"] == name} == {group}
            assert [row["touch"] for row in rows if row["participant"] == name and row["question"] in ("HXI1", "HXI2")] == ["on", "on"]


def a_participant_is_dropped(driver):
    """The page returns to its beginning, and the next participant has the same order."""
    with small_study() as folder, Server(folder) as server:
        server.act("start")
        Person(driver, server, 7).go("1/film")
        server.act("drop", "P01")
        wait_until("the first page", lambda: "wait until" in driver.find_element(By.ID, "stage").text)
        server.act("start")
        wait_until("the consent", lambda: "<at any time>" in driver.find_element(By.ID, "stage").text)
        orders = list(csv.reader(run_study("status", "--orders", folder).splitlines()))[1:]
        assert [order[1] for order in orders] == ["dropped", "running"] and orders[0][3:] == orders[1][3:], orders
        assert "P01    dropped" in run_study("status", folder)
        refused = subprocess.run([os.environ["STUDY"], "forget", folder, "P01"], capture_output=True, text=True)
        assert refused.returncode == 1 and "is in use" in refused.stderr


def hostile_requests(driver):
    """Nothing without the token, nothing that is not the step, no large bodies."""
    with small_study() as folder, Server(folder) as server:
        assert server.get("/state").status == 404
        assert server.get("state", headers={"Host": "evil.example"}).status == 403
        assert server.get("../study.ini").status == 404 and server.get("vendor-../index.html").status == 404
        assert server.post("step", {"step": "consent", "answer": "3", "response": 1}).status == 409
        server.act("start")
        for body in ("", "[]", "{", {"step": "consent"}, {"step": "consent", "answer": "3", "response": -1}, {"step": "consent", "answer": "3", "response": "1"}):
            assert server.post("step", body).status == 400, body
        for body in ({"step": "consent", "answer": "2", "response": 1}, {"step": "1/Q1", "answer": "3", "response": 1}):
            assert server.post("step", body).status == 409, body
        assert server.post("play", {"step": "1/film"}).status == 409
        assert server.post(server.experimenter.removeprefix(server.address) + "act", {"act": "explode"}).status == 400
        assert server.post("step", "x" * 70_000).status == 413
        assert server.get("step").status == 405
        # The participant's page is told no condition, and acts for nobody.
        assert server.get("overview").status == 404 and server.get("experimenter").status == 404 and server.post("act", {"act": "stop"}).status == 405
        assert server.state()["step"]["name"] == "consent"


TESTS = [the_paper_study, groups_and_a_questionnaire, killed_at_every_page, killed_between_question_and_answer, a_file_system_without_permissions, a_film_that_is_cut_off, a_participant_is_dropped, hostile_requests]

if __name__ == "__main__":
    names = [word for word in sys.argv[1:] if not word.startswith("--")]
    for word in sys.argv[1:]:
        if word.startswith("--people="):
            people = int(word.removeprefix("--people="))
    with chromium(width=1000, height=640) as browser:
        for test in TESTS:
            if not names or test.__name__ in names:
                test(browser)
                print(f"ok {test.__name__}", flush=True)
                browser.get("about:blank")
                for entry in browser.get_log("browser"):
                    assert entry["level"] != "SEVERE" or "Failed to load resource" in entry["message"] or "ERR_" in entry["message"], entry
