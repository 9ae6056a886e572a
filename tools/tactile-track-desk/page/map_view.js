// SPDX-License-Identifier: LGPL-2.1-or-later

const drawn = new WeakMap(); // canvas: what it shows

/**
 * Draws a tactile map over a picture: a ring for each cell that is felt, larger and denser the
 * stronger it is.
 * @param {HTMLCanvasElement} canvas fills the picture
 * @param {number} rows
 * @param {number} columns
 * @param {number[]} levels percent, row by row
 */
export function drawMap(canvas, rows, columns, levels) {
  const { clientWidth, clientHeight } = canvas;
  const width = Math.round(clientWidth * devicePixelRatio);
  const height = Math.round(clientHeight * devicePixelRatio);
  const map = [width, height, rows, columns, ...levels].join();
  if (drawn.get(canvas) === map)
    return;
  drawn.set(canvas, map);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, width, height);
  const most = Math.min(width / columns, height / rows) * 0.4;
  for (let cell = 0; cell < rows * columns; cell++) {
    const level = levels[cell] / 100;
    if (!level)
      continue;
    const x = ((cell % columns) + 0.5) * (width / columns);
    const y = (Math.floor(cell / columns) + 0.5) * (height / rows);
    context.beginPath();
    context.arc(x, y, most * (0.35 + 0.65 * level), 0, 2 * Math.PI);
    context.fillStyle = `rgba(240, 110, 40, ${0.2 + 0.5 * level})`;
    context.fill();
    context.lineWidth = Math.max(2, most * 0.06);
    context.strokeStyle = 'rgba(255, 255, 255, 0.9)';
    context.stroke();
  }
}
