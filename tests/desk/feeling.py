#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The film in the hand: a gamepad in the desk's page, and the film page that it exports, opened as a file.

The gamepad is a stand-in, as Chromium has none without hardware. Usage: feeling.py [TEST ...]
"""
import contextlib
import pathlib

from chromium import chromium
from desk_page import Page, cue, desk_with, run, wait_until

PAD = (pathlib.Path(__file__).parent / "pad.js").read_text(encoding="utf-8")
LEFT = cue(1000, 19000, {3: 60})
END = [(19800, 20000, {}, [])]


@contextlib.contextmanager
def a_pad(driver):
    script = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": PAD})
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)


def rumbles(driver):
    return driver.execute_script("return window.rumbles")


def last(driver):
    found = rumbles(driver)
    return (found[-1]["strong"], found[-1]["weak"]) if found else None


def a_pad_plays_along(driver):
    with a_pad(driver), desk_with(driver, [LEFT]) as (desk, _):
        page = Page(driver, desk)
        assert page.find("#pad-state").text == "Pad of a test"
        page.keys("k")
        page.wait("the left grip", lambda: last(driver) == (0.6, 0))
        assert all(each["kind"] == "dual-rumble" and each["duration"] == 250 for each in rumbles(driver) if each["strong"])
        page.keys("k")
        page.wait("silence in a pause", lambda: last(driver) == (0, 0))
        before = len(rumbles(driver))
        page.go_to(2000)
        page.wait("a moment of the frame", lambda: (0.6, 0) in [(each["strong"], each["weak"]) for each in rumbles(driver)[before:]] and last(driver) == (0, 0))
        page.keys("k")
        page.wait("the left grip again", lambda: last(driver) == (0.6, 0))
        at_once = page.js("const before = rumbles.length; window.dispatchEvent(new Event('blur')); return rumbles.slice(before)")
        assert [(each["strong"], each["weak"]) for each in at_once] == [(0, 0)], at_once
        page.click("#feel-pad")
        page.wait("silence when it is switched off", lambda: last(driver) == (0, 0))
        count = len(rumbles(driver))
        page.play_until(page.position() + 500)
        # Zeros may follow: a film that stalls stops the pad again.
        assert all((each["strong"], each["weak"]) == (0, 0) for each in rumbles(driver)[count:]), rumbles(driver)[count:]


def a_pad_paints(driver):
    with a_pad(driver), desk_with(driver) as (desk, _):
        page = Page(driver, desk)
        page.record()
        page.keys("k")
        page.play_until(300)
        page.js("pad.axes = [1, -1, 0, 0]; pad.buttons[7] = { pressed: true, value: 0.52 }")  # right and up, half a trigger
        page.wait("cell 3", lambda: "held" in page.find("#cells button:nth-child(3)").get_attribute("class"))
        page.play_until(page.position() + 300)
        page.js("pad.axes = [-1, 1, 0, 0]")  # to the left and down
        page.wait("cell 7", lambda: "held" in page.find("#cells button:nth-child(7)").get_attribute("class"))
        page.play_until(page.position() + 300)
        page.js("pad.buttons[7] = { pressed: false, value: 0 }")
        page.wait("nothing held", lambda: not page.all("#cells .held"))
        page.keys("k")
        (first, middle, levels, _), (begin, end, other, _), *rest = page.track()
        assert (levels, other, rest) == ({2: 50}, {6: 50}, END), page.track()
        assert 300 <= first and middle == begin and middle - first >= 300 and end - begin >= 300, page.track()


def export(desk, folder):
    answer = desk.get("export.html")
    assert answer.status == 200 and "attachment" in answer.headers.get("Content-Disposition", ""), answer.headers
    path = folder / "to feel.html"
    path.write_bytes(answer.body)
    return path


def an_exported_page_is_felt(driver):
    with a_pad(driver), desk_with(driver, [LEFT, cue(19000, 19500, {8: 100})]) as (desk, folder):
        path = export(desk, folder)
        desk.end()
        driver.get(path.as_uri())
        js = driver.execute_script
        wait_until("the film", lambda: js("return document.getElementById('video').readyState >= 2"))
        assert js("return document.getElementById('pad').textContent") == "Felt on Pad of a test"
        js("document.getElementById('video').play()")
        wait_until("the left grip", lambda: last(driver) == (0.6, 0))
        js("document.getElementById('video').pause()")
        wait_until("silence in a pause", lambda: last(driver) == (0, 0))
        js("const v = document.getElementById('video'); v.currentTime = 19.1; v.play()")
        wait_until("the right grip", lambda: (0, 1) in [(each["strong"], each["weak"]) for each in rumbles(driver)])
        wait_until("silence at the end", lambda: js("return document.getElementById('video').ended") and last(driver) == (0, 0))
        names = js("return performance.getEntriesByType('resource').map(({ name }) => name)")
        # Chromium may ask for the icon of a tab's last page again, which the policy refuses.
        assert all(name.startswith("file:") for name in names if not name.endswith("/icon.svg")), names
        policy = js("return document.querySelector('meta[http-equiv]').content")
        assert "default-src 'none'" in policy and "http" not in policy and "unsafe" not in policy, policy
        assert js("""return new Promise((done) => { const image = new Image(); image.onerror = () => done('refused'); image.onload = () => done('loaded');
            image.src = 'data:image/gif;base64,R0lGODlhAQABAAAAACwAAAAAAQABAAA='; })""") == "refused"
        told = [entry["message"] for entry in driver.get_log("browser") if "icon.svg" not in entry["message"]]
        assert len(told) == 1 and "data:image/gif" in told[0], told


def an_exported_page_without_its_film_asks_for_it(driver):
    with desk_with(driver, [LEFT]) as (desk, folder):
        path = export(desk, folder)
        film = folder / "film.webm"
        other = film.rename(folder / "renamed.webm")
        driver.get(path.as_uri())
        js = driver.execute_script
        wait_until("what to do", lambda: js("return !document.getElementById('problem').hidden"))
        driver.find_element("id", "file").send_keys(str(other))
        wait_until("the film", lambda: js("return document.getElementById('video').readyState >= 2 && document.getElementById('problem').hidden"))


def a_track_cannot_break_out_of_an_exported_page(driver):
    with desk_with(driver, [cue(1000, 2000, {4: 50}, ["</script><script>window.broken = true</script><!-- "])]) as (desk, folder):
        driver.get(export(desk, folder).as_uri())
        wait_until("the film", lambda: driver.execute_script("return document.getElementById('video').readyState >= 2"))
        assert driver.execute_script("return window.broken") is None
        assert driver.execute_script("return JSON.parse(document.getElementById('data').textContent).track.cues.length") == 2


TESTS = [a_pad_plays_along, a_pad_paints, an_exported_page_is_felt, an_exported_page_without_its_film_asks_for_it, a_track_cannot_break_out_of_an_exported_page]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
