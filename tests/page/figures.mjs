// The figures of a page as a reader works with them: points, drags, hides lines, saves.
//
//     node figures.mjs PAGE.html     prints what was read, as JSON
import assert from 'node:assert/strict';
import { open } from './page.mjs';

const { window, errors, saved, drawn } = open(process.argv[2]);
const { document } = window;
assert.deepEqual(errors, []);
const figures = [...document.querySelectorAll('figure')].filter((figure) => figure.querySelector(':scope > svg[data-x]'));
assert.ok(figures.length > 5);
const drawing = (figure) => figure.querySelector(':scope > svg');
const range = (figure) => drawing(figure).dataset.x.split(' ').map(Number);
const lines = (figure) => [...drawing(figure).querySelectorAll('.data polyline, .data path')];
const numbers = (line) => (line.getAttribute('points') ?? line.getAttribute('d')).match(/-?[\d.]+/g).map(Number);
const button = (figure, words) => [...figure.querySelectorAll('.tools button')].find((one) => one.textContent == words);
const point = (figure, type, x, y, more = {}) => {
  const event = new window.MouseEvent(type, { bubbles: true, clientX: x, clientY: y, ...more });
  drawing(figure).dispatchEvent(event);
};
const tip = () => [...document.querySelectorAll('.tip > div')].map((line) => line.textContent);
const label = (figure) => drawing(figure).getAttribute('aria-label');

// ---- values at a place, in all figures over the same time
const [first] = figures, [start, end, low, high] = range(first);
const middle = Math.round(start + 0.25 * (end - start)), height = 100;
point(first, 'pointermove', middle, height);
assert.equal(document.querySelector('.tip').hidden, false);
const read = { x: low + (middle - start) / (end - start) * (high - low), lines: tip() };
const isOver = (other) => range(other).slice(2, 4).every((edge, i) => edge == [low, high][i]) && label(other).includes('over time');
const alike = figures.filter(isOver), others = figures.filter((other) => !isOver(other));
assert.ok(alike.length > 3 && others.length > 1);
const cursors = (all) => all.filter((figure) => drawing(figure).querySelector('.cursor, line[stroke="#1c2329"][stroke-width="2"]'));
assert.deepEqual(cursors(alike), alike);
assert.deepEqual(cursors(others), []);
point(first, 'pointerleave', 0, 0);
assert.ok(document.querySelector('.tip').hidden);
assert.deepEqual(cursors(figures), []);

// ---- a part of the time, in all of them, and back
const before = figures.map((figure) => lines(figure).map(numbers));
const [from, to] = [0.25, 0.5].map((share) => Math.round(start + share * (end - start)));
point(first, 'pointerdown', from, height, { button: 0 });
point(first, 'pointermove', to, height);
point(first, 'pointerup', to, height);
const labels = (figure) => [...drawing(figure).querySelectorAll(':scope > g:not(.data) text[text-anchor="middle"]')].map((text) => Number(text.textContent.replace('−', '-')));
for (const figure of alike) {
  const shown = labels(figure);
  assert.ok(shown.length > 1, label(figure));
  for (const time of shown) assert.ok(time >= low + 0.249 * (high - low) && time <= low + 0.501 * (high - low), `${label(figure)}: ${shown}`);
}
for (const figure of others) assert.deepEqual(labels(figure), [], label(figure));
// what was at the edges of the part is at the edges of the figure
const stretched = numbers(lines(first)[0]).filter((_, i) => i % 2 == 0);
const expected = before[0][0];
assert.ok(Math.min(...stretched) < start - 0.9 * (end - start) && Math.max(...stretched) > end + 1.9 * (end - start), `${stretched.slice(0, 4)} ${expected.slice(0, 4)}`);
point(first, 'pointermove', start, height);
read.edge = tip()[0];
button(first, 'whole').click();
figures.forEach((figure, k) => {
  assert.deepEqual(labels(figure), [], label(figure));
  lines(figure).forEach((line, n) => {
    // relative steps have become places
    const places = numbers(line), [x0, y0] = before[k][n];
    assert.ok(Math.abs(places[0] - x0) < 0.06 && Math.abs(places[1] - y0) < 0.06, label(figure));
  });
});

// ---- a hidden line is not read, nor saved
const keys = [...first.querySelectorAll('.key')];
keys[0].click();
assert.equal(drawing(first).querySelector('[data-key="0"]').style.display, 'none');
point(first, 'pointermove', middle, height);
assert.deepEqual(tip(), read.lines.filter((_, i) => i != 1));
point(first, 'pointerleave', 0, 0);
button(first, 'svg').click();
button(first, 'png').click();
assert.equal(saved.length, 2);
const text = await new Promise((resolve) => {
  const reader = new window.FileReader();
  reader.onload = () => resolve(reader.result);
  reader.readAsText(saved[0].blob);
});
const file = new window.DOMParser().parseFromString(text, 'image/svg+xml');
assert.equal(file.querySelector('parsererror'), null);
const words = [...file.querySelectorAll('text')].map((one) => one.textContent.trim());
assert.ok(!words.includes(keys[0].textContent) && words.includes(keys[1].textContent), words.join());
assert.equal(file.querySelector('.cursor'), null);
assert.ok(saved[0].name.endsWith('.svg') && saved[1].name.endsWith('.png') && saved[1].href.startsWith('data:image/png'));
assert.ok(drawn[0][0] >= drawn[0][2] && drawn[0][1] >= drawn[0][3], `${drawn[0]}`);
keys[0].dispatchEvent(new window.KeyboardEvent('keydown', { key: 'Enter' }));
assert.equal(drawing(first).querySelector('[data-key="0"]').style.display, '');
assert.deepEqual(errors, []);
console.log(JSON.stringify({ ...read, keys: keys.map((key) => key.textContent), figures: figures.length }));
