#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The timeline in Chromium: keys, mouse, wheel and fingers, what is drawn, and what screen readers get.

Usage: timeline.py [TEST ...]
"""
import contextlib
import pathlib
import sys
import traceback

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.action_builder import ActionBuilder
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from chromium import chromium, files

FRAME = "const done = arguments[arguments.length - 1]; requestAnimationFrame(() => requestAnimationFrame(() => done()));"


class Desk:
    """The page with its timeline; times are ms, cells are from 0."""

    def __init__(self, driver, address):
        self.driver = driver
        self.address = address

    def open(self, query=""):
        self.driver.get(f"{self.address}/tests/desk/timeline.html{query}")
        self.canvas = self.driver.find_element(By.CSS_SELECTOR, "#timeline canvas")

    def js(self, code, *arguments):
        return self.driver.execute_script(f"return {code}", *arguments)

    def drawn(self):
        self.driver.execute_async_script(FRAME)

    def press(self, *keys):
        """Keys one after the other; a tuple: together."""
        for key in keys:
            chain = ActionChains(self.driver)
            *held, last = key if isinstance(key, tuple) else (key,)
            for one in held:
                chain.key_down(one)
            chain.send_keys(last)
            for one in held:
                chain.key_up(one)
            chain.perform()

    def felt(self):
        """Events as (cell, start, end, levels)."""
        return [tuple(one) for one in self.js("""Array.from({ length: desk.history.track.cells }, (_, cell) =>
            [...desk.history.track.events(cell, 0, 1e8)].map(({ start, end }) => [cell, start, end,
            desk.history.track.spans({ from: start, to: end, cells: [cell] }).map(({ level }) => level).join(' ')])).flat()""")]

    def selection(self):
        return self.js("desk.timeline.selection && [desk.timeline.selection.from, desk.timeline.selection.to, desk.timeline.selection.cells ?? null]")

    def playhead(self):
        return self.js("desk.timeline.playhead")

    def said(self):
        return self.js("desk.timeline.live.textContent").strip("\u00a0")

    def x(self, ms):
        return round(self.js("desk.timeline.view.x(arguments[0])", ms))

    def y(self, cell, level=None):
        """The middle of a row's lowest part, or the top of a bar."""
        if level is not None:
            return self.js("desk.timeline.view.bar(...arguments)[0]", cell, level)
        return round(self.js("desk.timeline.view.top(arguments[0]) + desk.timeline.view.rowHeight - 8", cell))

    def drag(self, *places, key=None, then=None):
        """With the mouse from the first place over the others."""
        self.drawn()
        pointer = ActionChains(self.driver, duration=20)
        if key:
            pointer.key_down(key)
        move = self.offset
        pointer.move_to_element_with_offset(self.canvas, *move(places[0])).click_and_hold()
        for place in places[1:]:
            pointer.move_to_element_with_offset(self.canvas, *move(place))
        if then:
            pointer.send_keys(then)
        pointer.release()
        if key:
            pointer.key_up(key)
        pointer.perform()

    def offset(self, place):
        """From the canvas's middle, as the driver counts."""
        size = self.canvas.size
        return round(place[0] - size["width"] / 2), round(place[1] - size["height"] / 2)

    def wheel(self, place, dx, dy, key=None):
        chain = ActionChains(self.driver)
        if key:
            chain.key_down(key)
        chain.scroll_from_origin(ScrollOrigin.from_element(self.canvas, *self.offset(place)), dx, dy)
        if key:
            chain.key_up(key)
        chain.perform()

    def touch(self, *steps):
        """Fingers: lists of places, one a step; then all leave."""
        left, top = self.js("[arguments[0].getBoundingClientRect().x, arguments[0].getBoundingClientRect().y]", self.canvas)
        for kind, points in zip(["touchStart"] + ["touchMove"] * len(steps), steps):
            self.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [
                {"x": left + x, "y": top + y, "id": i} for i, (x, y) in enumerate(points)]})
        self.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    def pixel(self, x, y):
        """The color at CSS pixels of the canvas."""
        return "#" + "".join(f"{value:02x}" for value in self.js(
            "[...arguments[0].getContext('2d').getImageData(arguments[1] * devicePixelRatio, arguments[2] * devicePixelRatio, 1, 1).data]",
            self.canvas, x, y)[:3])

    @contextlib.contextmanager
    def media(self, **features):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": name.replace("_", "-"), "value": value} for name, value in features.items()]})
        try:
            self.drawn()
            self.drawn()
            yield
        finally:
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def equal(got, expected, what=""):
    if got != expected:
        raise AssertionError(f"{what}: expected {expected}, got {got}")


def keyboard_alone(desk):
    desk.open()
    desk.press(Keys.TAB)
    equal(desk.js("document.activeElement === arguments[0]", desk.canvas), True, "the timeline is reached by Tab")
    desk.press(*[Keys.RIGHT] * 5)
    equal(desk.playhead(), 200, "5 frames of 40 ms")
    equal(desk.said(), "Cell 1, 0:00.200, silent")
    desk.press(Keys.ENTER)
    equal(desk.felt(), [(0, 200, 400, "75")], "Enter draws")
    equal(desk.said(), "Drawn at level 75, 0:00.200 to 0:00.400")
    desk.press((Keys.ALT, Keys.RIGHT), (Keys.ALT, Keys.RIGHT), (Keys.ALT, Keys.DOWN), (Keys.ALT, Keys.SHIFT, Keys.RIGHT))
    equal(desk.felt(), [(1, 280, 520, "75")], "moved and stretched")
    desk.press(*[(Keys.ALT, Keys.DOWN)] * 9, *[(Keys.ALT, Keys.UP)] * 7)
    equal(desk.felt(), [(1, 280, 520, "75")], "no further than the last cell, and back")
    desk.press("+", "+", "-")
    equal(desk.felt(), [(1, 280, 520, "80")], "louder")
    equal(desk.js("desk.timeline.level"), 80)
    desk.press(Keys.ESCAPE)
    equal((desk.selection(), desk.said()), (None, "Nothing selected"))
    desk.press((Keys.CONTROL, Keys.RIGHT))
    equal((desk.playhead(), desk.said()), (280, "Cell 2, 0:00.280, level 80, event from 0:00.280 to 0:00.520"))
    desk.press(Keys.RIGHT, Keys.RIGHT, "s")
    equal(desk.felt(), [(1, 280, 360, "80"), (1, 460, 520, "80")], "split at 360 ms, with a rest")
    desk.press((Keys.CONTROL, Keys.LEFT), "i", (Keys.CONTROL, Keys.RIGHT), (Keys.CONTROL, Keys.RIGHT), (Keys.CONTROL, Keys.RIGHT), "o")
    equal(desk.selection(), [280, 520, [1]], "from I to O")
    desk.press("m")
    equal(desk.felt(), [(1, 280, 520, "80")], "merged")
    desk.press("f")
    equal(desk.felt(), [(1, 280, 520, "72 56 40 24 8")], "faded out in 5 steps: 90, 70, 50, 30 and 10 %")
    desk.press((Keys.CONTROL, "z"), (Keys.SHIFT, "f"))
    equal(desk.felt(), [(1, 280, 520, "8 24 40 56 72")], "faded in")
    desk.press((Keys.CONTROL, "z"), (Keys.CONTROL, "c"), Keys.END, Keys.HOME, Keys.UP, (Keys.CONTROL, "v"))
    equal(desk.felt(), [(0, 0, 240, "80"), (1, 280, 520, "80")], "pasted at 0 in cell 1")
    desk.press((Keys.CONTROL, "d"))
    equal(desk.felt()[0], (0, 0, 480, "80"), "repeated")
    equal(desk.selection(), [240, 480, [0]])
    desk.press((Keys.CONTROL, "x"))
    equal(desk.felt()[0], (0, 0, 240, "80"), "cut")
    desk.press(Keys.ESCAPE, Keys.DELETE)
    equal(desk.felt(), [(1, 280, 520, "80")], "the event at the playhead is deleted")
    equal(desk.said(), "Delete. Selected 0:00.000 to 0:00.240")
    desk.press((Keys.CONTROL, "a"), Keys.DELETE)
    equal(desk.felt(), [], "all deleted")
    before = desk.js("JSON.stringify(desk.history.track.cues)")
    steps = 0
    while desk.js("desk.history.undoLabel") is not None:
        desk.press((Keys.CONTROL, "z"))
        steps += 1
    equal((desk.js("desk.history.track.cues"), steps), ([], 13), "all undone")
    desk.press((Keys.CONTROL, "z"))
    equal(desk.said(), "Nothing to undo")
    desk.press((Keys.CONTROL, Keys.SHIFT, "z"), *[(Keys.CONTROL, "y")] * 12)
    equal(desk.js("JSON.stringify(desk.history.track.cues)"), before, "all done again")


def a_move_covers_nothing_on_its_way(desk):
    desk.open()
    desk.driver.execute_script("""const { history, strokes, timeline } = desk;
        for (const from of [0, 300, 600]) history.do(strokes.draw(history.track, { from, to: from + 80, cells: [4] }, 50), { label: `${from}` });
        timeline.selection = { from: 0, to: 80, cells: [4] };
        timeline.focus()""")
    desk.press(*[(Keys.ALT, Keys.RIGHT)] * 8)
    equal(desk.felt(), [(4, 300, 400, "50"), (4, 600, 680, "50")], "over the second")
    desk.press(*[(Keys.ALT, Keys.RIGHT)] * 3)
    equal(desk.felt(), [(4, 300, 380, "50"), (4, 440, 520, "50"), (4, 600, 680, "50")], "past it")
    desk.press(*[(Keys.ALT, Keys.LEFT)] * 11)
    equal((desk.felt()[0], desk.js("desk.history.undoLabel")), ((4, 0, 80, "50"), "600"), "and back, which is no edit")
    desk.press(*[(Keys.ALT, Keys.RIGHT)] * 3, "+", (Keys.ALT, Keys.RIGHT))
    equal(desk.felt()[0], (4, 160, 240, "55"), "after another edit it begins anew")
    desk.press((Keys.CONTROL, "z"), (Keys.CONTROL, "z"))
    equal(desk.felt()[0], (4, 120, 200, "50"))
    desk.press((Keys.CONTROL, "z"))
    equal(desk.felt()[0], (4, 0, 80, "50"), "the steps are undone as one")


def keys_that_move_and_select(desk):
    desk.open("?cues=300")
    desk.js("desk.timeline.focus()")
    desk.press((Keys.SHIFT, Keys.RIGHT), (Keys.SHIFT, Keys.RIGHT), (Keys.SHIFT, Keys.DOWN))
    equal(desk.selection(), [0, 80, [0, 1]], "with Shift")
    equal(desk.said(), "Selected 0:00.000 to 0:00.080, cells 1, 2")
    desk.press((Keys.SHIFT, Keys.LEFT), (Keys.SHIFT, Keys.LEFT))
    equal(desk.selection(), None, "back to where it began")
    desk.press("c")
    equal(desk.playhead(), 1040, "the first shot cut")
    desk.press("c", (Keys.SHIFT, "c"), (Keys.SHIFT, "c"))
    equal((desk.playhead(), desk.said()), (1040, "No shot cut before"))
    first = desk.js("desk.timeline.warnings[0]")
    desk.press(Keys.HOME, "n")
    equal(desk.selection(), [first["start"], first["end"], [first["cell"]] if first["cell"] >= 0 else None], "the first warning")
    equal(desk.said().startswith(first["text"]), True, desk.said())
    desk.press((Keys.SHIFT, "n"))
    equal(desk.said(), "No warning before")
    desk.press("l")
    equal(desk.js("[desk.timeline.loop, desk.told.at(-1)]"), [{"from": first["start"], "to": first["end"]},
          ["loop", {"loop": {"from": first["start"], "to": first["end"]}}]], "a loop")
    desk.press("l")
    equal(desk.js("desk.timeline.loop"), None)
    whole = desk.js("desk.timeline.view.scale")
    desk.press(Keys.HOME, Keys.END)
    equal(desk.playhead(), 60000, "the end")
    desk.press("z", "z")
    equal(round(whole / desk.js("desk.timeline.view.scale"), 6), 2.25, "closer, twice")
    desk.press(Keys.PAGE_UP)
    equal(desk.playhead(), 36000, "nine tenths of 60 s / 2.25 back")
    equal(desk.js("desk.timeline.view.from <= desk.timeline.playhead && desk.timeline.playhead < desk.timeline.view.to"), True, "in view")
    desk.press((Keys.SHIFT, "z"), "w")
    equal(desk.js("desk.timeline.view.scale"), whole, "the whole film")
    desk.driver.execute_script("addEventListener('keydown', (event) => { (window.left ??= []).push(event.key); })")
    desk.press(" ", "5", "?", Keys.LEFT, "s", (Keys.CONTROL, "s"))
    equal([key for key in desk.js("window.left") if key not in ("Shift", "Control")], [" ", "5", "?", "s"], "what is not ours is the page's")
    desk.driver.execute_script("desk.timeline.readOnly = true; desk.history.do(desk.strokes.erase(desk.history.track, { from: 0, to: 999 }))")
    before = desk.felt()
    desk.press((Keys.CONTROL, "a"), Keys.DELETE, (Keys.ALT, Keys.RIGHT))
    equal((desk.felt(), desk.said()), (before, "Read only: another page writes"))
    desk.press((Keys.CONTROL, "z"))
    equal(desk.felt(), before, "nor undone")


def mouse(desk):
    desk.open()
    desk.driver.execute_script("desk.timeline.show(0, 12000)")
    scale = desk.js("desk.timeline.view.scale")
    def near(got, expected, what):  # to the pixel
        same = len(got) == len(expected) and all(a[0] == b[0] and abs(a[1] - b[1]) <= scale and abs(a[2] - b[2]) <= scale and a[3] == b[3]
                                                 for a, b in zip(got, expected))
        equal(same, True, f"{what}: expected {expected}, got {got}")
    desk.drag((desk.x(2000), desk.y(4)), (desk.x(3000), desk.y(4)), (desk.x(4000), desk.y(5)))
    near(desk.felt(), [(4, 2000, 4000, "75")], "drawn in the row where it began")
    equal(desk.js("desk.history.undoLabel"), "Draw")
    desk.drag((desk.x(3000), desk.y(4)), (desk.x(4000), desk.y(4)), (desk.x(5000), desk.y(7)))
    near(desk.felt(), [(7, 4000, 6000, "75")], "moved in time and to another row")
    desk.drag((desk.x(6000) - 2, desk.y(7)), (desk.x(7000) - 2, desk.y(7)))
    near(desk.felt(), [(7, 4000, 7000, "75")], "its end")
    desk.drag((desk.x(4000) + 2, desk.y(7)), (desk.x(3000) + 2, desk.y(7)))
    near(desk.felt(), [(7, 3000, 7000, "75")], "its begin")
    desk.drag((desk.x(5000), desk.y(7, 75)), (desk.x(5000), desk.y(7, 75) + 4))
    level = 75 - round(4 / desk.js("desk.timeline.view.barRoom") * 100)
    near(desk.felt(), [(7, 3000, 7000, f"{level}")], "its level")
    equal(desk.js("[desk.timeline.level, desk.told.some(([name, { level }]) => name === 'level' && level === arguments[0])]", level), [level, True])
    before = desk.felt()
    desk.drag((desk.x(5000), desk.y(7)), (desk.x(9000), desk.y(2)), then=Keys.ESCAPE)
    equal(desk.felt(), before, "Escape ends a drag without an edit")
    desk.drag((desk.x(1000), desk.y(0)), (desk.x(1000) + 1, desk.y(0)))
    equal(desk.felt(), before, "a click draws nothing")
    equal(abs(desk.playhead() - 1000) <= scale, True, "but seeks")
    desk.drag((desk.x(5000), desk.y(7)), (desk.x(5000), desk.y(7)))
    equal(desk.selection(), [before[0][1], before[0][2], [7]], "a click selects an event")
    desk.drag((desk.x(2000), desk.y(3)), (desk.x(4000), desk.y(5)), key=Keys.SHIFT)
    equal((desk.selection()[2], desk.felt()), ([3, 4, 5], before), "with Shift, a drag selects")
    desk.drag((10, desk.y(8)), (10, desk.y(8)))
    equal(desk.selection()[2], [8], "a label selects its row")
    desk.drag((10, desk.y(5)), (10, desk.y(5)), key=Keys.SHIFT)
    equal(desk.selection()[2], [5, 6, 7, 8], "with Shift, all rows up to there")
    desk.drag((10, desk.y(1)), (10, desk.y(1)), key=Keys.CONTROL)
    desk.drag((10, desk.y(7)), (10, desk.y(7)), key=Keys.CONTROL)
    equal(desk.selection()[2], [1, 5, 6, 8], "with Ctrl, one more and one less")
    desk.press(Keys.UP, Keys.UP, Keys.UP, Keys.UP, (Keys.CONTROL, Keys.ENTER))
    equal(desk.selection()[2], [1, 3, 5, 6, 8], "by keys, too")
    desk.drag((10, desk.y(2)), (10, desk.y(4)))
    equal(desk.selection()[2], [2, 3, 4], "a drag over labels selects their rows")
    desk.driver.execute_script("desk.told.length = 0")
    desk.drag((desk.x(2000), 12), (desk.x(8000), 12))
    seeks = [detail["scrubbing"] for name, detail in desk.js("desk.told") if name == "seek"]
    equal((seeks[0], seeks[-1], abs(desk.playhead() - 8000) <= scale), (True, False, True), "the ruler scrubs")
    desk.drag((desk.x(9000), desk.y(0)), (desk.x(8000) + 4, desk.y(0)))
    equal((desk.felt()[0][1] == desk.playhead(), len(desk.felt())), (True, 2), "an edge snaps to the playhead")
    desk.driver.execute_script("desk.timeline.readOnly = true")
    before = desk.felt()
    desk.drag((desk.x(5000), desk.y(7)), (desk.x(9000), desk.y(7)))
    equal((desk.felt(), desk.selection()[2], abs(desk.selection()[1] - 9000) <= scale), (before, [7], True), "read only, a drag selects")


def tools(desk):
    desk.open()
    desk.driver.execute_script("desk.timeline.show(0, 10000); desk.history.do(desk.strokes.draw(desk.history.track, { from: 1000, to: 3000, cells: [4] }, 75))")
    scale = desk.js("desk.timeline.view.scale")
    desk.js("desk.timeline.focus()")
    desk.press("q")
    before = desk.felt()
    desk.drag((desk.x(5000), desk.y(1)), (desk.x(7000), desk.y(3)))
    equal((desk.felt(), desk.selection()[2]), (before, [1, 2, 3]), "the tool that selects draws nothing")
    desk.drag((desk.x(2000), desk.y(4)), (desk.x(4000), desk.y(4)))
    equal(abs(desk.felt()[0][1] - 3000) <= 2 * scale, True, "but moves events")
    desk.press((Keys.CONTROL, "z"), "x")
    desk.drag((desk.x(2000), desk.y(4)), (desk.x(2000), desk.y(4)))
    parts = desk.felt()
    equal((len(parts), abs(parts[0][2] - 2000) <= 2 * scale, parts[1]), (2, True, (4, parts[0][2] + 100, 3000, "75")), "a click cuts")
    desk.press("b")
    top, bottom = desk.y(0, 100), desk.y(0, 1)
    desk.drag((desk.x(5000), bottom), (desk.x(7000), top - 4))
    (cell, start, end, levels), = [one for one in desk.felt() if one[0] == 0]
    levels = [int(level) for level in levels.split()]
    equal((abs(start - 5000) < 40 + scale, abs(end - 7000) < 40 + scale), (True, True), f"painted from {start} to {end}")
    equal((levels == sorted(levels), levels[0] <= 10, levels[-1], len(levels) > 30), (True, True, 100, True), f"the level follows the pointer: {levels}")
    equal(desk.js("desk.history.undo()"), "Paint", "in one step")
    desk.press("h")
    desk.drag((desk.x(1500), desk.y(4)), (desk.x(1500), desk.y(4, 30)))
    (_, _, end, levels), = [one for one in desk.felt() if one[:2] == (4, 1000)]
    levels = [int(level) for level in levels.split()]
    low = levels.index(min(levels))
    equal((abs(min(levels) - 30) <= 4, levels[:low + 1] == sorted(levels[:low + 1], reverse=True), levels[low:] == sorted(levels[low:]), end),
          (True, True, True, parts[0][2]), f"a point in the middle of an event bends it: {levels}")
    equal(desk.js("desk.history.undo()"), "Curve", "in one step")
    desk.press("d", (Keys.SHIFT, "s"))
    desk.driver.execute_script("desk.timeline.seek(8000)")
    near = desk.x(8000) + 4
    desk.drag((desk.x(9000), desk.y(0)), (near, desk.y(0)))
    equal((desk.felt()[0][0], desk.felt()[0][1] > 8000), (0, True), "without snap, an edge stays where it is put")


def edges_snap_to_events(desk):
    desk.open()
    desk.driver.execute_script("desk.timeline.show(0, 10000); desk.history.do(desk.strokes.draw(desk.history.track, { from: 2345, to: 4567, cells: [4] }, 75))")
    desk.js("desk.timeline.focus()")
    felt = lambda cell: [one[1:3] for one in desk.felt() if one[0] == cell]
    desk.drag((desk.x(4567) + 4, desk.y(1)), (desk.x(7000), desk.y(1)))
    (start, end), = felt(1)
    equal((start, abs(end - 7000) < 20), (4567, True), "an edge snaps to the end of another event")
    desk.drag((desk.x(5500), desk.y(1)), (desk.x(5500 + 2345 - start) - 4, desk.y(1)))
    equal(felt(1), [(2345, 2345 + end - start)], "a whole event snaps to a begin")
    desk.press((Keys.CONTROL, "z"), (Keys.CONTROL, "z"))
    desk.drag((desk.x(3500), desk.y(4)), (desk.x(3500) + 4, desk.y(4)))
    equal(felt(4)[0][0] > 2345, True, "not to its own, where it was")
    desk.press((Keys.CONTROL, "z"), (Keys.SHIFT, "s"))
    desk.drag((desk.x(4567) + 4, desk.y(7)), (desk.x(7000), desk.y(7)))
    equal(felt(7)[0][0] > 4567, True, "without snap, to none")


def wheel_and_fingers(desk):
    desk.open("?cues=3000")
    view = lambda: desk.js("[desk.timeline.view.from, desk.timeline.view.scale, desk.timeline.view.scroll]")
    desk.driver.execute_script("desk.timeline.show(100000, 200000)")
    at = lambda x: view()[0] + (x - 76) * view()[1]
    before, under = view(), at(600)
    desk.wheel((600, 200), 0, -120, key=Keys.CONTROL)
    equal((round(before[1] / view()[1], 3), abs(at(600) - under) < 1), (1.284, True), "Ctrl and a notch of the wheel zoom by e^0.25, around the pointer")
    desk.wheel((600, 200), 0, 300, key=Keys.CONTROL)
    equal([round(one) for one in view()], [round(one) for one in before], "and back")
    desk.wheel((600, 200), 0, 120)
    equal((view()[1], abs(view()[0] - before[0] - 120 * before[1]) < 1), (before[1], True), "the wheel alone pans where all rows are in view")
    desk.wheel((600, 200), 0, -120)
    desk.wheel((600, 200), 0, 120, key=Keys.SHIFT)
    equal(abs(view()[0] - before[0] - 120 * before[1]) < 1, True, "with Shift it pans")
    desk.wheel((600, 200), -120, 0)
    equal(abs(view()[0] - before[0]) < 1, True, "as does a wheel sideways")
    desk.touch([(500, 200), (700, 200)], [(450, 200), (750, 200)], [(400, 200), (800, 200)])
    equal((round(before[1] / view()[1], 2), abs(at(600) - under) < 2 * before[1]), (2, True), "two fingers zoom around their middle")
    before = view()
    desk.touch([(500, 200), (700, 200)], [(600, 200), (800, 200)])
    equal((view()[1], abs(view()[0] - before[0] + 100 * before[1]) < 1), (before[1], True), "and pan")
    desk.driver.execute_script("desk.history.do(desk.strokes.erase(desk.history.track, { from: 0, to: 1e6 }))")
    before = view()
    desk.touch([(500, 200)], [(450, 200)], [(400, 200)])
    equal((round((view()[0] - before[0]) / before[1]), desk.felt()), (100, []), "one finger pans where nothing is")
    desk.driver.execute_script("desk.timeline.show(0, 1e9)")
    equal(view()[0], 0, "not before the begin")
    for _ in range(3):
        desk.wheel((600, 200), 0, 3000, key=Keys.CONTROL)
    equal(abs(desk.js("desk.timeline.view.to - desk.timeline.length")) < 1, True, "no further than all")


def what_is_drawn(desk):
    desk.open("?cues=300")
    colors = {name: desk.js("getComputedStyle(arguments[0]).getPropertyValue('--tl-' + arguments[1])", desk.canvas, name)
              for name in ("background", "row", "event", "draft", "playhead", "warning")}
    desk.driver.execute_script("desk.timeline.show(2000, 5000); desk.timeline.cuts = []; desk.timeline.playhead = 4999")
    desk.drawn()
    compared = 0
    for cell in range(9):
        for ms in range(2050, 4950, 100):
            level, shadow, alike = desk.js("""[desk.history.track, desk.timeline.draft].map((track) => track.level(...arguments)).concat(
                [-5, 5].every((by) => desk.history.track.level(arguments[0], arguments[1] + by) === desk.history.track.level(...arguments)))""", cell, ms)
            if not alike:
                continue
            bottom = desk.js("desk.timeline.view.bar(arguments[0], 1).reduce((y, height) => y + height)", cell)
            equal(desk.pixel(desk.x(ms), bottom - 1), colors["event" if level else "draft" if shadow else "row"], f"cell {cell} at {ms} ms")
            if level:
                top = desk.y(cell, level)
                equal(desk.pixel(desk.x(ms), top + 0.5), colors["event"], f"cell {cell} at {ms} ms is as high as its level")
                equal(desk.pixel(desk.x(ms), top - 1.5), colors["draft" if shadow > level + 10 else "row"], f"cell {cell} at {ms} ms, no higher") \
                    if abs(shadow - level) > 10 else None
                compared += 1
    equal(compared > 40, True, f"{compared} places")
    warning = desk.js("desk.timeline.warnings.find(({ cell, end, start }) => cell >= 0 && end - start > 300)")
    desk.driver.execute_script("desk.timeline.show(arguments[0] - 1000, arguments[0] + 2000); desk.timeline.playhead = 0", warning["start"])
    desk.driver.execute_script("desk.timeline.show(arguments[0] - 1000, arguments[0] + 2000)", warning["start"])
    desk.drawn()
    row = desk.js("Math.round(desk.timeline.view.top(arguments[0]) + desk.timeline.view.rowHeight)", warning["cell"])
    equal(desk.pixel(desk.x(warning["start"] + 100), row - 4), colors["warning"], "a warning")
    desk.driver.execute_script("desk.timeline.playhead = arguments[0] + 700", warning["start"])
    desk.drawn()
    equal(desk.pixel(desk.x(desk.playhead()), 20), colors["playhead"], "the playhead")
    first = desk.js("Math.ceil(desk.timeline.view.from / 2000) * 2000")
    equal(desk.pixel(desk.x(first) + 10, 45), "#446688", "a thumbnail where its time is")
    with desk.media(prefers_color_scheme="dark"):
        equal(desk.pixel(20, 5), "#1a1d22", "dark")
    with desk.media(forced_colors="active"):
        equal(desk.js("[desk.timeline.painter.colors.event, desk.timeline.painter.colors.background]"), ["CanvasText", "Canvas"], "forced colors")
    desk.drawn()
    equal(desk.pixel(20, 5), colors["background"], "light again")


def large_and_many(desk):
    """Twice as large, on a screen of twice as many pixels, and a grid of 64 cells."""
    try:
        desk.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 640, "height": 400, "deviceScaleFactor": 2, "mobile": False})
        desk.open("?cues=300")
        desk.drawn()
        equal(desk.js("[arguments[0].width, arguments[0].height]", desk.canvas),
              desk.js("[arguments[0].clientWidth * 2, arguments[0].clientHeight * 2]", desk.canvas), "sharp")
        equal(desk.js("document.documentElement.scrollWidth <= innerWidth"), True, "nothing to scroll sideways")
        equal(desk.js("arguments[0].clientWidth < 640", desk.canvas), True)
        desk.driver.execute_script("desk.timeline.show(2000, 9000); document.getElementById('timeline').hidden = true")
        desk.drawn()
        desk.driver.execute_script("document.getElementById('timeline').hidden = false")
        desk.drawn()
        equal(desk.js("[desk.timeline.view.from, Math.round(desk.timeline.view.to)]"), [2000, 9000], "shown again as it was")
        desk.open("?cues=300&side=8")
        desk.js("desk.timeline.focus()")
        equal(desk.js("desk.timeline.view.visibleCells[1] < 64"), True, "more cells than fit")
        desk.press(*[Keys.DOWN] * 63)
        equal(desk.said().startswith("Cell 8.8, "), True, desk.said())
        equal(desk.js("desk.timeline.view.visibleCells[1]"), 64, "the last row is in view")
        desk.press((Keys.SHIFT, Keys.RIGHT), Keys.ENTER)
        desk.drawn()
        equal(desk.felt()[-1][0:1] == (63,) or desk.js("desk.history.track.level(63, 10)") > 0, True, "drawn there")
        desk.wheel((300, 200), 0, -5000)
        equal(desk.js("desk.timeline.view.visibleCells[0]"), 0, "the wheel scrolls the rows")
    finally:
        desk.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def screen_readers(desk):
    desk.open("?cues=300")
    desk.driver.execute_script("desk.timeline.seek(20100)")
    nodes = desk.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    value = lambda node, name: (node.get(name) or {}).get("value", "")
    of = lambda role: [node for node in nodes if value(node, "role") == role and not node.get("ignored")]
    timeline = of("application")
    equal([(value(one, "name"), "Enter draws" in value(one, "description")) for one in timeline], [("Timeline", True)], "the timeline")
    equal(len(of("status")), 1, "what is said")
    equal([value(one, "name") for one in of("table")], ["Cues near the playhead"], "a table")
    equal([value(one, "name") for one in of("columnheader")], ["From", "To", "Felt", "Notes"])
    buttons = [value(one, "name") for one in of("button")]
    equal((len(buttons), buttons[7]), (15, "Go to the cue at 0:20.000"), "a button a cue, the current in the middle")
    current = desk.driver.find_element(By.CSS_SELECTOR, "tr[aria-current=true]")
    levels = desk.js("desk.history.track.at(20100)")
    felt = ", ".join(f"cell {cell + 1}: {level} %" for cell, level in enumerate(levels) if level) or "silent"
    equal([one.text for one in current.find_elements(By.TAG_NAME, "td")][:3], ["0:20.000", "0:20.200", felt])
    equal("softer?" in desk.driver.find_element(By.ID, "cues").text, False)
    desk.driver.execute_script("desk.timeline.seek(9500)")
    equal("softer?" in desk.driver.find_element(By.ID, "cues").text, True, "notes")
    button = desk.driver.find_elements(By.CSS_SELECTOR, "#cues button")[9]
    button.click()
    equal((desk.playhead(), desk.selection()), (9800, [9800, 10000, None]), "a button goes there and selects the cue")
    equal(desk.js("document.activeElement === arguments[0]", button), True, "and keeps the focus")
    equal(len(desk.driver.find_elements(By.CSS_SELECTOR, "tr[aria-current]")), 1, "one is current")
    desk.driver.execute_script("desk.history.do(desk.strokes.erase(desk.history.track, { from: 9800, to: 10000 }))")
    equal("0:09.800" in [one.text for one in desk.driver.find_elements(By.CSS_SELECTOR, "#cues button")], False, "the table follows edits")
    desk.driver.execute_script("desk.history.reset(new desk.Track(3, 3))")
    equal(len(desk.driver.find_elements(By.CSS_SELECTOR, "#cues button")), 0, "an empty track")


TESTS = [keyboard_alone, a_move_covers_nothing_on_its_way, keys_that_move_and_select, mouse, tools, edges_snap_to_events, wheel_and_fingers, what_is_drawn, large_and_many, screen_readers]


def main():
    names = sys.argv[1:] or [test.__name__ for test in TESTS]
    failed = 0
    with files(pathlib.Path(__file__).resolve().parents[2]) as address, chromium() as driver:
        for name in names:
            test = next(one for one in TESTS if one.__name__ == name)
            try:
                test(Desk(driver, address))
                errors = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE" and "favicon" not in entry["message"]]
                equal(errors, [], "the browser's console")
                print(f"ok {name}", flush=True)
            except Exception:  # also of the driver
                traceback.print_exc(file=sys.stdout)
                print(f"not ok {name}", flush=True)
                failed += 1
    sys.exit(f"timeline.py: {failed} of {len(names)} tests failed" if failed else 0)


main()
