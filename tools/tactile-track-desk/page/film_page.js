// SPDX-License-Identifier: LGPL-2.1-or-later
import { drawMap } from './map_view.js';
import { Pad } from './pad.js';

const { film, track } = JSON.parse(document.getElementById('data').textContent);
const [rows, columns] = track.grid;
const silence = Array(rows * columns).fill(0);
const $ = (id) => document.getElementById(id);
const video = $('video');
const pad = new Pad();

/** Levels in percent at a time in ms; cues are in order. */
function levelsAt(ms) {
  let [low, high] = [0, track.cues.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (track.cues[middle].start <= ms)
      low = middle + 1;
    else
      high = middle;
  }
  const cue = track.cues[low - 1];
  return cue && ms < cue.end ? cue.levels : silence;
}

function show() {
  const levels = levelsAt(video.currentTime * 1000);
  $('overlay').hidden = !$('shown').checked;
  drawMap($('overlay'), rows, columns, levels);
  return levels;
}

function play() {
  if (video.paused || video.ended)
    return;
  const levels = show();
  if (video.seeking || video.readyState < 3)
    pad.stop();
  else
    pad.play(levels.map((level) => level * $('strength').value / 100), columns);
  requestAnimationFrame(play);
}

function showPad() {
  const { gamepad } = pad;
  $('pad').textContent = gamepad ? `Felt on ${gamepad.id}`
    : 'Press a button on a gamepad to feel the film. This browser shows none with motors yet.';
}

video.addEventListener('play', play);
for (const name of ['pause', 'ended', 'seeking', 'waiting', 'emptied', 'error'])
  video.addEventListener(name, () => pad.stop());
for (const name of ['seeked', 'loadeddata', 'pause'])
  video.addEventListener(name, show);
video.addEventListener('error', () => { $('problem').hidden = false; });
video.addEventListener('loadeddata', () => { $('problem').hidden = true; });
for (const name of ['gamepadconnected', 'gamepaddisconnected'])
  window.addEventListener(name, showPad);
window.addEventListener('resize', show);
$('shown').addEventListener('change', show);
$('file').addEventListener('change', () => {
  const [file] = $('file').files;
  if (file)
    video.src = URL.createObjectURL(file);
});
document.title = $('title').textContent = film.name;
video.src = film.href;
showPad();
