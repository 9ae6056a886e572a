// SPDX-License-Identifier: LGPL-2.1-or-later

/** What the desk refused, with what to do. `status` 0: the desk could not be reached. */
export class DeskError extends Error {
  constructor(status, body) {
    super(body.error ?? `The desk answered ${status}.`);
    this.status = status;
    this.body = body;
  }
}

const UNREACHABLE =
  'The desk cannot be reached. Look at the terminal where "tactile-track desk" runs, and start it ' +
  'again if it has ended. Edits are kept in this page.';

/** The page's name: one page at a time may write. */
export const page = Array.from(crypto.getRandomValues(new Uint8Array(8)),
  (byte) => byte.toString(16).padStart(2, '0')).join('');

/**
 * A request whose answer is not judged.
 * @returns {Promise<{status: number, body: object}>} rejects if the desk cannot be reached
 */
export async function send(path, body, options = {}) {
  const post = { method: 'POST', body: JSON.stringify(body), headers: { 'Content-Type': 'application/json' } };
  const answer = await fetch(path, body === undefined ? options : { ...post, ...options });
  const text = await answer.text();
  let json = {};
  try {
    json = text ? JSON.parse(text) : {};
  } catch {
    json = { error: `The desk answered ${answer.status} and no JSON.` };
  }
  return { status: answer.status, body: json };
}

async function judged(path, body) {
  let answer;
  try {
    answer = await send(path, body);
  } catch {
    throw new DeskError(0, { error: UNREACHABLE });
  }
  if (answer.status >= 400)
    throw new DeskError(answer.status, answer.body);
  return answer.body;
}

/** @throws {DeskError} */
export const get = (path) => judged(path);

/** @throws {DeskError} */
export const post = (path, body) => judged(path, { page, ...body });

/** Bytes, e.g. of `sound`. @throws {DeskError} */
export async function bytes(path) {
  const answer = await fetch(path);
  if (!answer.ok)
    throw new DeskError(answer.status, {});
  return new Uint8Array(await answer.arrayBuffer());
}

/**
 * Server-sent events.
 * @param {Object<string, function(object)>} handlers one an event; `lost` when the desk is gone,
 *   `back` when it answers again
 * @returns {Promise<void>} resolved when the desk listens to this page
 */
export function listen(handlers) {
  const source = new EventSource(`events?page=${page}`);
  for (const [name, handle] of Object.entries(handlers))
    source.addEventListener(name, (event) => event.data !== undefined && handle(JSON.parse(event.data)));
  return new Promise((resolve) => {
    let lost = false;
    source.onopen = () => {
      if (lost)
        handlers.back();
      lost = false;
      resolve();
    };
    source.onerror = () => {
      if (!lost)
        handlers.lost(UNREACHABLE);
      lost = true;
      // A browser gives up for good after an answer that is an error.
      if (source.readyState === EventSource.CLOSED)
        setTimeout(() => listen(handlers).then(handlers.back), 2000);
    };
  });
}
