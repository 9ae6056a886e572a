#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the tests that a JavaScript module of this folder exports, in Chromium.

Usage: modules.py MODULE [TEST ...]
"""
import pathlib
import sys

from chromium import chromium, files

RUN = """
const [module, names, done] = arguments;
(async () => {
  const tests = Object.entries(await import(module)).filter(([name]) => names.length === 0 || names.includes(name));
  const results = [];
  for (const [name, test] of tests) {
    try {
      await test();
      results.push([name, null]);
    } catch (error) {
      results.push([name, error.stack]);
    }
  }
  return results;
})().then(done, (error) => done([[module, String(error.stack)]]));
"""


def main():
    module, names = sys.argv[1], sys.argv[2:]
    root = pathlib.Path(__file__).resolve().parents[2]
    with files(root) as address, chromium() as driver:
        driver.get(f"{address}/tests/desk/empty.html")
        results = driver.execute_async_script(RUN, f"/tests/desk/{module}", names)
    for name, error in results:
        print(f"{'not ok' if error else 'ok'} {name}", *(["\n", error] if error else []))
    if len(results) < max(len(names), 1) or any(error for _, error in results):
        sys.exit(f"modules.py: {sum(1 for _, error in results if error)} of {len(results)} tests of {module} failed")


main()
