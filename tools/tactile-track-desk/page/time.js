// SPDX-License-Identifier: LGPL-2.1-or-later

/**
 * A time as people read it.
 * @param {number} ms
 * @returns {string} '0:01.040', '1:02:03.004'
 */
export function formatTime(ms) {
  const whole = Math.max(0, Math.round(ms));
  const two = (n) => String(n).padStart(2, '0');
  const hours = Math.floor(whole / 3600000);
  const minutes = Math.floor(whole / 60000) % 60;
  const seconds = two(Math.floor(whole / 1000) % 60);
  const rest = String(whole % 1000).padStart(3, '0');
  return (hours ? `${hours}:${two(minutes)}` : `${minutes}`) + `:${seconds}.${rest}`;
}

/**
 * A time as people write it: '83', '1:23', '1:23.4', '0:01:23,400'; seconds come last.
 * @param {string} text
 * @returns {number} ms
 * @throws {RangeError} if it is none
 */
export function parseTime(text) {
  const match = /^\s*(?:(?:(\d{1,3}):)?(\d{1,3}):)?(\d{1,6})(?:[.,](\d{1,3})\d*)?\s*$/.exec(text);
  if (!match)
    throw new RangeError(`A time is like 1:23.400 or 83.4; got '${text}'.`);
  const [, hours = 0, minutes = 0, seconds, rest = ''] = match;
  return ((hours * 60 + +minutes) * 60 + +seconds) * 1000 + +rest.padEnd(3, '0');
}

/**
 * Where a frame begins, so many frames from the one that is shown.
 * @param {number} ms a time in the frame that is shown, of its begin the first whole one
 * @param {number} frame its duration in ms, more than 0, to fifteen digits
 * @param {number} frames negative: back
 * @returns {number} ms, the first whole one in that frame
 */
export function frameFrom(ms, frame, frames) {
  const off = 1e-6; // by rounding
  return Math.ceil((Math.floor(ms / frame + off) + frames) * frame - off);
}

/** The index of the first of some times, which are in order, that is not before `ms`. */
export function firstAfter(times, ms) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < ms) low = middle + 1;
    else high = middle;
  }
  return low;
}
