// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The experimenter's page: who is in a session, what the chair does, and what to do when a film fails.

const find = (id) => document.getElementById(id);
let overview = null;

async function post(path, message) {
  const answer = await fetch(path, { method: 'POST', body: JSON.stringify(message) });
  const body = await answer.json();
  find('trouble').textContent = body.error ?? '';
  find('trouble').hidden = answer.ok;
  if (answer.ok && body.participants)
    show(body);
}
const act = (name, participant) => post('act', { act: name, participant: participant ?? overview.active ?? '' });

function row(cells) {
  const line = document.createElement('tr');
  for (const cell of cells) {
    const field = document.createElement('td');
    field.append(cell);
    line.append(field);
  }
  return line;
}

const levels = (condition) => Object.values(condition).join(', ') || 'practice';

function timing(session, step) {
  if (session.plays === 0)
    return ['', '', '', '', ''];
  const outcome = step.phase === 'playing' && step.session === session.session ? 'playing' : session.outcome;
  const times = session.plays > 1 ? `${outcome}, play ${session.plays}` : outcome;
  return [times, session.commands, session.commands ? `${session.p99.toFixed(2)}, ${session.max.toFixed(2)}` : '', session.dropped,
    [...session.marks, session.text].filter(Boolean).join(', ')];
}

function show(next) {
  overview = next;
  const { step } = next;
  const running = step && step.kind !== 'done' && next.participants.some((one) => one.name === next.active && one.state === 'running');
  document.body.dataset.ready = true;
  find('title').textContent = next.title;
  find('count').textContent = `${next.participants.filter((one) => one.state === 'done').length} of ${next.people} have finished`;
  find('who').textContent = next.active ? [next.active, ...Object.values(next.group)].join(', ') : 'Nobody is in a session';
  find('step').textContent = step ? `${step.name}, step ${step.done + 1} of ${step.count + 1}${step.kind === 'film' ? `: ${step.phase}` : ''}` : '';
  find('start').disabled = Boolean(running);
  find('stop').disabled = step?.phase !== 'playing';
  find('go-on').disabled = !running || step.phase !== 'failed';
  find('again').disabled = !running || step.phase !== 'failed';
  find('drop').disabled = !running || step.phase === 'playing';
  find('sessions').tBodies[0].replaceChildren(...(next.sessions ?? []).map((one) => row([one.session || 'practice', levels(one.condition), ...timing(one, step)])));
  find('participants').tBodies[0].replaceChildren(...next.participants.map((one) => {
    const resume = document.createElement('button');
    resume.textContent = 'Resume';
    resume.addEventListener('click', () => act('resume', one.name));
    return row([one.name, one.state, `${one.done} of ${one.count}`, one.state === 'running' && one.name !== next.active ? resume : '']);
  }));
}

function showChair({ rows, columns, levels: values, position }) {
  const chair = find('chair');
  chair.style.gridTemplateColumns = `repeat(${columns || 1}, 3rem)`;
  chair.replaceChildren(...values.map((level) => {
    const tactor = document.createElement('div');
    tactor.style.backgroundColor = `rgb(39 80 125 / ${0.06 + 0.94 * level})`;
    tactor.textContent = Math.round(level * 100);
    tactor.classList.toggle('strong', level > 0.5);
    return tactor;
  }));
  find('position').textContent = rows ? `${position.toFixed(1)} s of the film; the map is shown up to 0.4 s before it is felt` : 'No film plays.';
}

for (const name of ['start', 'stop', 'go-on'])
  find(name).addEventListener('click', () => act(name));
find('again').addEventListener('click', () => post('play', { step: overview.step.name }));
find('drop').addEventListener('click', () => {
  if (confirm(`Drop ${overview.active}? The place is given to the next participant.`))
    act('drop');
});
const source = new EventSource('events');
source.addEventListener('overview', (event) => show(JSON.parse(event.data)));
source.addEventListener('chair', (event) => showChair(JSON.parse(event.data)));
source.addEventListener('trouble', (event) => {
  find('trouble').textContent = JSON.parse(event.data);
  find('trouble').hidden = false;
});
source.addEventListener('error', () => { find('step').textContent = 'The study’s server is gone; start visuotactile-study run again.'; });
