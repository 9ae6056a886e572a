// SPDX-License-Identifier: LGPL-2.1-or-later

/** @typedef {{name: string, label: string, unit?: string, value: number|string, min?: number,
 *   max?: number, step?: number, choices?: [string, string][]}} Option */

/** What was asked for is not possible yet: the text says what to do first. It is no error. */
export class Hint extends Error {}

let made = 0;

export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function field({ name, label, unit, value, min, max, step, choices }) {
  const id = `option-${++made}`;
  const control = choices
    ? element('select', { id, name }, ...choices.map(([key, text]) => element('option', { value: key }, text)))
    : element('input', { id, name, type: 'number', min, max, step: 'any', required: true });
  control.value = value;
  if (step)
    control.dataset.step = step;
  return element('p', {}, element('label', { htmlFor: id }, unit ? `${label} (${unit})` : label), ' ', control);
}

/**
 * A form that asks which of several things to do, and for its options.
 * @param {HTMLFormElement} form empty
 * @param {string} label of the choice
 * @param {{name: string, label: string, options: Option[], hint?: string}[]} kinds
 * The event 'applied' follows a success.
 * @param {function(object, object)} apply gets the kind and the values by name; what it throws is
 *   said in the form
 */
export function choiceForm(form, label, kinds, apply) {
  const id = `choice-${++made}`;
  const choice = element('select', { id }, ...kinds.map(({ name, label }) => element('option', { value: name }, label)));
  const fields = element('div');
  const hint = element('p', { className: 'hint' });
  const error = element('p', { className: 'error', role: 'alert' });
  const kind = () => kinds.find(({ name }) => name === choice.value);
  const show = () => {
    fields.replaceChildren(...kind().options.map(field));
    hint.textContent = kind().hint ?? '';
    error.textContent = '';
  };
  choice.addEventListener('change', show);
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    error.textContent = '';
    const values = {};
    for (const { name, choices } of kind().options) {
      const text = fields.querySelector(`[name="${name}"]`).value;
      values[name] = choices ? text : Number(text);
    }
    try {
      await apply(kind(), values);
      form.dispatchEvent(new Event('applied', { bubbles: true }));
    } catch (thrown) {
      error.className = thrown instanceof Hint ? 'hint' : 'error';
      error.textContent = thrown.message;
    }
  });
  form.append(element('p', {}, element('label', { htmlFor: id }, label), ' ', choice), fields, hint,
    element('button', { type: 'submit' }, 'Apply'), error);
  show();
}
