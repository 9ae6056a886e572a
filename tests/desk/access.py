#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Names and contrast of every control, light and dark, from 1280 px to 320 px, by Chromium's accessibility tree and its computed styles.

Usage: access.py [TEST ...]
"""
from chromium import chromium
from desk_page import Page, cue, desk_with, run

CUES = [cue(1000, 1400, {4: 75}, ["a comment"]), cue(2000, 6000, {0: 40, 1: 100, 2: 5, 3: 80, 5: 60})]
CONTROLS = {"button", "textbox", "checkbox", "combobox", "slider", "spinbutton", "link", "application", "DisclosureTriangle", "video", "Video", "image", "table", "dialog"}

# Contrast of text as WCAG 2.1 computes it (1.4.3); what is disabled is exempt.
CONTRAST = """
const parse = (color) => {
  const [r, g, b, a = 1] = color.match(/[\\d.]+/g).map(Number);
  return color.startsWith('color(srgb') ? [r * 255, g * 255, b * 255, a] : [r, g, b, a];
};
const over = ([r, g, b, a], [x, y, z]) => [r * a + x * (1 - a), g * a + y * (1 - a), b * a + z * (1 - a), 1];
const luminance = ([r, g, b]) => {
  const [x, y, z] = [r, g, b].map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * x + 0.7152 * y + 0.0722 * z;
};
const background = (element) => {
  const layers = [];
  for (let e = element; e; e = e.parentElement) {
    const color = parse(getComputedStyle(e).backgroundColor);
    layers.push(color);
    if (color[3] === 1) break;
  }
  return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255, 1]);
};
const bad = [];
for (const element of document.querySelectorAll('body *')) {
  const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
  const control = element.matches('input:not([type=range], [type=checkbox]), select, textarea');
  if (!(own || control) || !element.checkVisibility() || element.matches(':disabled, option') || element.closest('.map')) continue;
  const below = background(element);
  const [light, dark] = [luminance(over(parse(getComputedStyle(element).color), below)), luminance(below)].sort((a, b) => b - a);
  const ratio = (light + 0.05) / (dark + 0.05);
  if (ratio < 4.5) bad.push(`${element.tagName}#${element.id} '${(element.textContent || element.value).trim().slice(0, 30)}': ${ratio.toFixed(2)}`);
}
return bad;
"""


def everything(page):
    """All panels are open, something is selected, an error is shown."""
    page.js("for (const details of document.querySelectorAll('details')) details.open = true")
    page.js("document.getElementById('time').value = 'never'; document.getElementById('time').dispatchEvent(new Event('change'))")
    page.go_to(1100)
    page.js("document.activeElement.blur()")
    page.keys("j", "i", "o", "j")


def unnamed(driver):
    """Controls without an accessible name, by the tree that Chromium gives to screen readers."""
    nodes = driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    found = [node for node in nodes if not node.get("ignored") and node.get("role", {}).get("value") in CONTROLS]
    assert len(found) > 40, f"only {len(found)} controls"
    return [(node["role"]["value"], node["nodeId"]) for node in found if not node.get("name", {}).get("value", "").strip()]


def dark(driver, on=True):
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark" if on else "light"}]})


def every_control_has_a_name(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        everything(page)
        driver.execute_cdp_cmd("Accessibility.enable", {})
        assert unnamed(driver) == [], unnamed(driver)
        page.keys("v")
        page.wait("the review", lambda: page.all("#review tbody tr"))
        assert unnamed(driver) == [], unnamed(driver)
        page.keys("?")
        page.wait("the help", lambda: page.find("#help").is_displayed())
        ids = page.js("const ids = [...document.querySelectorAll('[id]')].map((e) => e.id); return ids.filter((id, i) => ids.indexOf(id) !== i)")
        assert ids == [], ids


def text_has_contrast(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        everything(page)
        try:
            for on in (False, True):
                dark(driver, on)
                for key in ("v", "v", "?"):
                    page.keys(key)
                    assert page.js(CONTRAST) == [], (on, key, page.js(CONTRAST))
                page.click("#help button")
        finally:
            driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def pages_of_half_and_a_quarter_width_scroll_one_way(driver):
    """1280 px at 200 % are 640, at 400 % 320 (WCAG 2.1, 1.4.10)."""
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        everything(page)
        try:
            for width, height in ((1280, 800), (640, 400), (320, 256)):
                driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1280 / width, "mobile": False})
                for key in ("v", "v"):
                    page.keys(key)
                    wide = page.js("""return [...document.querySelectorAll('button, input, select, textarea, canvas, a, summary')]
                        .filter((e) => e.checkVisibility() && !e.closest('dialog, table, .menu')).map((e) => [e.id || e.textContent, e.getBoundingClientRect()])
                        .filter(([, { left, right }]) => left < -1 || right > innerWidth + 1).map(([name]) => name)""")
                    assert wide == [], (width, wide)
                    assert page.js("return document.documentElement.scrollWidth <= innerWidth"), width
        finally:
            driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def the_table_of_cues_says_where_the_film_is(driver):
    with desk_with(driver, CUES) as (desk, _):
        page = Page(driver, desk)
        page.go_to(2500)
        page.click("#track summary")
        current = lambda: [row.text for row in page.all("#cue-table [aria-current]")]
        page.wait("the cue at 2.5 s", lambda: current() and "0:02.000" in current()[0])
        page.go_to(1100)
        page.wait("the cue at 1.1 s", lambda: current() and "0:01.000" in current()[0] and "a comment" in current()[0])


TESTS = [every_control_has_a_name, the_table_of_cues_says_where_the_film_is, text_has_contrast, pages_of_half_and_a_quarter_width_scroll_one_way]

if __name__ == "__main__":
    with chromium() as browser:
        run(TESTS, browser)
