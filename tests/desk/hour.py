#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""An hour of editing without its pauses, in Chromium at 1366 x 768: edits by keys and by a pointer that trembles, undo, reloads, saves, a restart.

After each edit the desk's track is compared with a model. An edit that is not as it was meant is undone and tried again: the table has how
often the first try did it, and what happened instead.

Usage: hour.py [EDITS [SEED]]    the environment of desk_page.py; 400 edits by default
"""
import collections
import random
import sys
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from chromium import chromium
from desk_page import Desk, Page, cue, desk_with, validate

FRAME = 40  # ms
SECONDS = 60
FRAMES = SECONDS * 1000 // FRAME
CELLS = 9
TREMOR = 1.5  # pixels, of the pointer around its target
MOST_TRIES = 4
SMALL = {"width": 1366, "height": 768, "deviceScaleFactor": 1, "mobile": False}


class Hour:
    def __init__(self, page, seed):
        self.page, self.pick = page, random.Random(seed)
        self.levels = [[0] * FRAMES for _ in range(CELLS)]  # the model
        self.level = 75  # that is drawn
        self.row = 0
        self.tries = collections.defaultdict(list)  # by kind of edit
        self.instead = collections.Counter()

    def got(self):
        levels = [[0] * FRAMES for _ in range(CELLS)]
        for start, end, each, _ in self.page.track():
            for cell, level in each.items():
                for frame in range(round(start / FRAME), min(round(end / FRAME), FRAMES)):
                    levels[cell][frame] = level
        return levels

    def events(self):
        """(cell, first frame, last frame + 1) of what is felt without a gap."""
        found = []
        for cell, levels in enumerate(self.levels):
            begin = None
            for frame, level in enumerate([*levels, 0]):
                if level and begin is None:
                    begin = frame
                elif not level and begin is not None:
                    found.append((cell, begin, frame))
                    begin = None
        return found

    def free(self, length):
        """A place in a row where nothing is felt before, during and after."""
        while True:
            cell, frame = self.pick.randrange(CELLS), self.pick.randrange(10, FRAMES - length - 40)
            if not any(self.levels[cell][frame - 3:frame + length + 3]):
                return cell, frame

    def go(self, cell, frame):
        self.page.keys("t", f"{frame * FRAME / 1000:.3f}", Keys.ENTER)
        self.page.wait("the time", lambda: abs(self.page.position() - frame * FRAME) <= 1)
        self.page.keys(*[Keys.ARROW_DOWN if cell > self.row else Keys.ARROW_UP] * abs(cell - self.row))
        self.row = cell

    def fill(self, cell, begin, end, level):
        levels = [list(row) for row in self.levels]
        for frame in range(begin, end):
            levels[cell][frame] = level(levels[cell][frame]) if callable(level) else level
        return levels

    def edit(self, kind, act, meant, near=0):
        """`act` is done until the desk has what is `meant`; levels may be off by `near` percent."""
        for number in range(1, MOST_TRIES + 1):
            act()
            got = self.got()
            wrong = [(cell, frame) for cell in range(CELLS) for frame in range(FRAMES) if abs(got[cell][frame] - meant[cell][frame]) > near
                     or (got[cell][frame] > 0) != (meant[cell][frame] > 0)]
            if not wrong:
                break
            label = self.page.js("return document.getElementById('undo').title") or "nothing"
            self.instead[f"{kind}: {label.removeprefix('Undo: ')}"] += 1
            if got != self.levels:
                self.page.keys("j", (Keys.CONTROL, "z"))
                assert self.got() == self.levels, f"{kind} cannot be undone"
        else:
            raise AssertionError(f"{kind}: {MOST_TRIES} tries in vain, {dict(self.instead)}; wrong at {wrong[:5]}")
        self.tries[kind].append(number)
        self.levels = got if near else meant

    # By keys.

    def draw(self):
        cell, frame = self.free(5)
        self.edit("draw, keys", lambda: (self.page.keys("j", Keys.ESCAPE), self.go(cell, frame), self.page.keys(Keys.ENTER)), self.fill(cell, frame, frame + 5, self.level))

    def change(self, kind, keys, meant):
        """What the event that is selected by keys becomes."""
        cell, begin, end = self.pick.choice(self.events())
        if end + 20 < FRAMES and not any(self.levels[cell][end:end + 12]):
            self.edit(kind, lambda: (self.page.keys("j", Keys.ESCAPE), self.go(cell, begin), self.page.keys(Keys.ENTER, *keys)), meant(cell, begin, end))

    def louder(self):
        by = self.pick.choice([-5, 5])
        self.level = min(max(self.level + by, 1), 100)
        cell, begin, end = self.pick.choice(self.events())
        self.edit("level, keys", lambda: (self.page.keys("j", Keys.ESCAPE), self.go(cell, begin), self.page.keys(Keys.ENTER, "+" if by > 0 else "-")),
                  self.fill(cell, begin, end, lambda level: min(max(level + by, 1), 100)))

    def move(self):
        def meant(cell, begin, end):
            levels = self.fill(cell, begin, end, 0)
            levels[cell][begin + 6:end + 6] = self.levels[cell][begin:end]
            return levels

        self.change("move, keys", [(Keys.ALT, Keys.ARROW_RIGHT)] * 6, meant)

    def delete(self):
        self.change("delete, keys", [Keys.DELETE], lambda cell, begin, end: self.fill(cell, begin, end, 0))

    def paste(self):
        cell, begin, end = self.pick.choice(self.events())
        to, frame = self.free(end - begin)
        levels = [list(row) for row in self.levels]
        levels[to][frame:frame + end - begin] = self.levels[cell][begin:end]
        self.edit("copy and paste, keys", lambda: (self.page.keys("j", Keys.ESCAPE), self.go(cell, begin), self.page.keys(Keys.ENTER, (Keys.CONTROL, "c")), self.go(to, frame),
                                                   self.page.keys((Keys.CONTROL, "v"))), levels)

    def point(self):
        """A point in the middle of an event goes up or down by 20 %, the lines beside it follow."""
        cell, begin, end = self.pick.choice(self.events())
        levels = self.levels[cell][begin:end]
        if len(set(levels)) > 1 or end - begin < 5:
            return
        middle, key = begin + (end - begin) // 2, "+" if levels[0] < 60 else "-"
        by = 20 if key == "+" else -20
        meant = self.fill(cell, begin, end, 0)
        for frame in range(begin, end):
            off = (frame + 0.5 - begin) / (middle - begin) if frame < middle else (end - frame - 0.5) / (end - middle)
            meant[cell][frame] = min(max(levels[0] + by * min(off, 1), 1), 100)
        self.edit("point of a curve, keys", lambda: (self.page.keys("j", Keys.ESCAPE, "h"), self.go(cell, middle), self.page.keys(Keys.ENTER, *[key] * 4, Keys.ESCAPE, "d")), meant, near=2)

    # By a pointer that trembles, with 12 s in view; undone, as its times are no frames.

    def exact(self, cell):
        """[begin, end] in ms of what is felt in a row."""
        found = []
        for start, end, each, _ in self.page.track():
            if not each.get(cell):
                continue
            if found and found[-1][1] == start:
                found[-1][1] = end
            else:
                found.append([start, end])
        return found

    def pointed(self, kind):
        room = [one for one in self.events() if 50 < one[1] < FRAMES - 250 and not any(self.levels[one[0]][one[2]:one[2] + 20])]
        if not room:
            return
        cell, begin, end = self.pick.choice(room)
        first = (begin - 25) * FRAME
        self.page.keys("j", Keys.ESCAPE)
        self.go(cell, begin - 25)
        self.page.keys("i")
        self.go(cell, begin + 225)
        self.page.keys("o", (Keys.SHIFT, "w"), Keys.ESCAPE)
        left, top, width, height = self.page.js("const { left, top, width, height } = document.querySelector('#timeline canvas').getBoundingClientRect(); return [left, top, width, height]")
        scale = 12000 / (width - 76)  # ms a pixel
        x = lambda ms: left + 76 + (ms - first + 1000) / scale  # a tenth more on both sides
        above = 26 + 48 + 36  # ruler, thumbnails, sound
        row = max((height - above) / CELLS, 18)
        bottom = top + above + row * (cell + 1) - 6
        middle = bottom - max(self.levels[cell][begin:end]) / 100 * (row - 9) / 2
        target = (x((begin + end) / 2 * FRAME) if kind.startswith("move") else x(end * FRAME) - 1, middle)
        by = round(400 / scale)
        for number in range(1, MOST_TRIES + 1):
            before = self.page.track()
            chain = ActionChains(self.page.driver, duration=10)
            pointer = chain.w3c_actions.pointer_action
            at = [round(place + self.pick.gauss(0, TREMOR)) for place in target]
            pointer.move_to_location(*at)
            pointer.pointer_down()
            pointer.move_to_location(at[0] + by // 2, at[1])
            pointer.move_to_location(at[0] + by, at[1])
            pointer.pointer_up()
            chain.perform()
            after = self.exact(cell)
            moved = [begin * FRAME + (400 if kind.startswith("move") else 0), end * FRAME + 400]
            done = any(all(abs(a - b) <= 3 * scale for a, b in zip(one, moved)) for one in after)
            if not done:
                self.instead[f"{kind}: {(self.page.js('return document.getElementById(arguments[0]).title', 'undo') or 'nothing').removeprefix('Undo: ')}"] += 1
            if self.page.track() != before:
                self.page.keys("j", (Keys.CONTROL, "z"))
                assert self.page.track() == before, f"{kind} cannot be undone"
            self.level = int(self.page.js("return document.getElementById('level-value').textContent").split()[0])  # a drag may have set it
            if done:
                self.tries[kind].append(number)
                return
        self.tries[kind].append(MOST_TRIES + 1)

    def undo_and_redo(self):
        steps = self.pick.randrange(1, 6)
        before = self.got()
        self.page.keys("j", *[(Keys.CONTROL, "z")] * steps, *[(Keys.CONTROL, Keys.SHIFT, "z")] * steps)
        assert self.got() == before == self.levels, "undo and redo"


def main():
    count, seed = (int(word) for word in [*sys.argv[1:], *["400", "1"][len(sys.argv) - 1:]])
    begin = time.monotonic()
    with chromium() as driver, desk_with(driver, seconds=SECONDS) as (desk, folder):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", SMALL)
        page = Page(driver, desk)
        hour = Hour(page, seed)
        page.keys("j", (Keys.SHIFT, "s"))
        kinds = [hour.draw] * 4 + [hour.louder, hour.move, hour.delete, hour.paste, hour.point, hour.undo_and_redo] + [lambda: hour.pointed("move, pointer"), lambda: hour.pointed("end, pointer")]
        for _ in range(10):
            hour.draw()
        for number in range(1, count - 9):
            hour.pick.choice(kinds)()
            if number % 60 == 0:
                page.save()
                validate(folder / "film.vtt")
            if number % 100 == 0:
                page.load()
                page.may_write()
                hour.level, hour.row = 75, 0
                page.keys("j", (Keys.SHIFT, "s"))
                assert hour.got() == hour.levels, "a reload"
        # The desk is started again: what was not saved is there, and all of it is undone.
        desk.end()
        with Desk(folder / "film.webm", "--no-browser") as again:
            page.wait("the desk", lambda: page.errors() == [])
            page.may_write()
            page.desk = again
            assert hour.got() == hour.levels, "a restart"
            page.save()
            validate(folder / "film.vtt")
            page.keys("j")
            while page.find("#undo").is_enabled():
                page.keys((Keys.CONTROL, "z"))
            assert page.track() == [(SECONDS * 1000 - 200, SECONDS * 1000, {}, [])], page.track()[:5]
            page.save()
            assert (folder / "film.vtt").read_bytes() == (folder / "before.vtt").read_bytes()
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    print(f"{sum(map(len, hour.tries.values()))} edits, {sum(map(sum, hour.tries.values()))} tries, {time.monotonic() - begin:.0f} s; all undone, the file is as it was\n")
    print("| edit | times | at the first try | instead |\n|---|---|---|---|")
    for kind, tries in sorted(hour.tries.items()):
        instead = ", ".join(f"{what.split(': ')[1]} {times}" for what, times in hour.instead.items() if what.startswith(kind))
        print(f"| {kind} | {len(tries)} | {100 * tries.count(1) / len(tries):.0f} % | {instead} |")


main()
