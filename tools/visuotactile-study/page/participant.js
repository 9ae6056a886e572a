// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The participant's page. The server says which step it is; each step is one trial of jsPsych, and its answer is on the server's disk before
// the next one. A page that is loaded again begins at the same step.

const stage = document.getElementById('stage');
const trouble = document.getElementById('trouble');
const kRetry = 1000; // ms
const kLongest = 10000; // characters of a text, which the server has room for

const wait = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

/** Text as HTML, with paragraphs at empty lines. */
function html(text) {
  const element = document.createElement('span');
  return text.split(/\n\s*\n/).map((paragraph) => {
    element.textContent = paragraph.trim();
    return `<p>${element.innerHTML}</p>`;
  }).join('');
}

/** HTML of one line. */
function line(text) {
  const element = document.createElement('span');
  element.textContent = text;
  return element.innerHTML;
}

function say(text) {
  trouble.textContent = text;
  trouble.hidden = !text;
}

/** Sends until the server has answered, and resolves with the next state: this one, with the reason said, if it refuses the message. */
async function send(path, message, state) {
  for (;;) {
    try {
      const answer = await fetch(path, { method: 'POST', body: JSON.stringify(message) });
      const body = await answer.json();
      if (answer.ok) {
        say('');
        return body;
      }
      const isNext = body.state && keyOf(body.state) !== keyOf(state); // it was stored before
      say(isNext ? '' : `Your answer is not stored: ${body.error}. Please call the experimenter.`);
      if (body.state || answer.status === 400 || answer.status === 413)
        return body.state ?? state;
    } catch {
      say('The study’s computer does not answer. Please call the experimenter; your answer is kept in this page.');
    }
    await wait(kRetry);
  }
}

/** Runs one trial, and resolves with its data. */
async function run(trial) {
  stage.replaceChildren();
  const jsPsych = initJsPsych({ display_element: stage });
  await jsPsych.run([trial]);
  return jsPsych.data.get().last(1).values()[0];
}

const button = (text, choice) => ({ type: jsPsychHtmlButtonResponse, stimulus: text, choices: [choice] });

/** What a trial's data are as an answer. */
const kQuestions = {
  slider: {
    trial: (question) => ({
      type: jsPsychHtmlSliderResponse, stimulus: `<p class="question">${line(question.text)}</p>`, labels: question.labels.map(line),
      min: question.low, max: question.high, step: question.step, slider_start: (question.low + question.high) / 2, require_movement: true,
    }),
    answer: (data) => String(data.response),
  },
  likert: {
    trial: (question) => ({
      type: jsPsychSurveyLikert, questions: [{ prompt: line(question.text), name: 'answer', labels: question.labels.map(line), required: true }],
    }),
    answer: (data) => String(data.response.answer + 1),
  },
  text: {
    trial: (question, given = '') => ({
      type: jsPsychSurveyText, questions: [{ prompt: line(question.text), name: 'answer', rows: 8, columns: 60 }],
      on_load: () => {
        const field = stage.querySelector('textarea');
        field.maxLength = kLongest;
        field.value = given;
      },
    }),
    answer: (data) => data.response.answer,
  },
};

const clock = (ms) => {
  const seconds = Math.ceil(ms / 1000);
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, '0')}`;
};

/** Resolves when the state is another than this one. */
let news = () => {};
const changed = (key) => new Promise((resolve) => {
  news = (state) => { if (keyOf(state) !== key) resolve(state); };
  // It may have changed before.
  fetch('state').then((answer) => answer.json()).then(news, () => {});
});
const keyOf = (state) => `${state.participant} ${state.step?.name} ${state.step?.phase}`;

async function rest(state) {
  const end = performance.now() + state.step.restLeft;
  stage.innerHTML = '<h1>Break</h1><p>Please stay seated or stretch. The next film can begin in</p><p id="clock"></p>';
  const face = document.getElementById('clock');
  for (let left = state.step.restLeft; left > 0; left = end - performance.now()) {
    face.textContent = clock(left);
    await wait(Math.min(left, 200));
  }
  await run(button('<h1>Break</h1><p>Go on when you are ready.</p>', 'Go on'));
  return send('step', { step: state.step.name, answer: '', response: 0 }, state);
}

async function film(state) {
  const { step } = state;
  const title = step.session === 0 ? 'Practice' : `Film ${step.session} of ${state.sessions}`;
  if (step.phase === 'ready') {
    await run(button(`<h1>${title}</h1><p>Lean back and put on the headset. The film begins when you press the button.</p>`, 'Begin'));
    return send('play', { step: step.name }, state);
  }
  stage.innerHTML = step.phase === 'playing' ? '<p class="playing">The film plays.</p>'
    : '<h1>The film ended early</h1><p>Please call the experimenter.</p>';
  return changed(keyOf(state));
}

async function show(state) {
  const { step } = state;
  if (!state.participant) {
    stage.innerHTML = '<h1>Welcome</h1><p>Please wait until the experimenter begins.</p>';
    return changed(keyOf(state));
  }
  const reply = (answer, data) => send('step', { step: step.name, answer, response: Math.round(data.rt ?? 0) }, state);
  switch (step.kind) {
    case 'consent':
      return reply(state.version, await run(button(`<h1>Consent</h1>${html(state.text)}<p class="small">Version ${line(state.version)}</p>`, 'I agree')));
    case 'instructions':
      return reply('', await run(button(`<h1>Instructions</h1>${html(state.text)}`, 'Continue')));
    case 'film':
      return film(state);
    case 'question': {
      const kind = kQuestions[step.question.kind];
      for (let given; ;) {
        const data = await run(kind.trial(step.question, given));
        given = kind.answer(data);
        const next = await reply(given, data);
        if (keyOf(next) !== keyOf(state)) // else the answer, which was refused, is in the page again
          return next;
      }
    }
    case 'rest':
      return rest(state);
    default:
      stage.innerHTML = html(state.text);
      return changed(keyOf(state));
  }
}

new EventSource('events').addEventListener('state', (event) => {
  const latest = JSON.parse(event.data);
  news(latest);
  const shown = document.body.dataset.participant;
  if (shown && shown !== 'null' && shown !== String(latest.participant)) // who was dropped
    location.reload();
});

let state = await (await fetch('state')).json();
for (;;) {
  document.title = state.title;
  document.getElementById('title').textContent = state.title;
  document.getElementById('progress').value = state.step ? state.step.done / state.step.count : 0;
  document.body.dataset.participant = String(state.participant);
  const shown = show(state);
  document.body.dataset.key = keyOf(state);
  state = await shown;
}
