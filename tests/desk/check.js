// SPDX-License-Identifier: LGPL-2.1-or-later
/** What tests of the desk's modules expect, and their random numbers. */

export function equal(got, expected, what = '') {
  const [a, b] = [JSON.stringify(got), JSON.stringify(expected)];
  if (a === b) return;
  let i = 0;
  while (a?.[i] === b?.[i]) i++;
  const near = (text) => String(text).slice(Math.max(i - 100, 0), i + 200);
  throw new Error(`${what}: expected …${near(b)}…, got …${near(a)}…`);
}

export function holds(value, what) {
  if (!value) throw new Error(`expected: ${what}`);
}

export function fails(act, pattern) {
  try {
    act();
  } catch (error) {
    holds(error instanceof RangeError && pattern.test(error.message), `${pattern}, got ${error}`);
    return;
  }
  throw new Error(`expected an error like ${pattern}`);
}

/** Whole numbers from..to - 1, the same ones each time. */
export function random(seed) {
  let state = seed >>> 0;
  return (from, to) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return from + Math.floor(state / 2 ** 32 * (to - from));
  };
}
