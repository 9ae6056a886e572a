// SPDX-License-Identifier: LGPL-2.1-or-later

/** The buttons over the timeline for its tools, snap and zoom. */
export class Toolbar {
  /** @param {import('./timeline.js').Timeline} timeline */
  constructor(timeline) {
    const click = (id, act) => document.getElementById(id).addEventListener('click', act);
    const tools = [...document.querySelectorAll('[data-tool]')];
    const show = () => {
      for (const button of tools)
        button.setAttribute('aria-pressed', button.dataset.tool === timeline.tool);
      for (const id of ['snap', 'tall'])
        document.getElementById(id).setAttribute('aria-pressed', timeline[id]);
      document.getElementById('zoom-selection').disabled = !timeline.selection;
    };
    for (const button of tools)
      button.addEventListener('click', () => { timeline.tool = button.dataset.tool; });
    for (const id of ['snap', 'tall'])
      click(id, () => { timeline[id] = !timeline[id]; });
    click('zoom-in', () => timeline.zoom(1.5));
    click('zoom-out', () => timeline.zoom(1 / 1.5));
    click('zoom-all', () => timeline.show(0, timeline.length));
    click('zoom-selection', () => timeline.showSelection());
    timeline.addEventListener('tool', show);
    timeline.addEventListener('select', show);
    show();
  }
}
