// The film of a stop as a reader works with it: chooses a road, moves in time, plays.
//
//     node stop.mjs PAGE.html SCENE TIME     prints what is said of the runs of a scene at a time, as JSON
import assert from 'node:assert/strict';
import { open } from './page.mjs';

const [, , path, id, time] = process.argv;
const { window, errors } = open(path);
const { document } = window;
assert.deepEqual(errors, []);
const player = document.querySelector('.player');
const [button, which, slider, clock, pace] = ['button', 'select', 'input', 'output', '.pace'].map((s) => player.querySelector(s));
const scenes = [...document.querySelectorAll('.scene')];
const scene = scenes.find((one) => one.id == id);
const said = () => [...scene.querySelectorAll('.stage output')].map((output) => output.textContent);
const shown = () => scenes.filter((one) => !one.closest('section').classList.contains('off')).map((one) => one.id);
const cursors = () => [...scene.querySelectorAll('[data-x]')].map((drawing) => {
  const [left, right, low, high] = drawing.dataset.x.split(' ').map(Number);
  return low + (Number(drawing.querySelector('.cursor').getAttribute('x1')) - left) / (right - left) * (high - low);
});
const near = (t, to) => assert.ok(Math.abs(t - to) < 2e-3, `${t} for ${to}`);
const isAt = (t) => {
  near(Number(slider.value), t);
  near(Number(clock.textContent.split(' ')[0]), t);
  assert.ok(cursors().length > 3);
  cursors().forEach((place) => near(place, t));
  assert.equal(window.location.hash, `#${id}/${t.toFixed(3)}`);
};

// ---- a road and a moment
assert.equal(player.hidden, false);
assert.deepEqual(shown(), [scenes[0].id]);
which.value = scenes.indexOf(scene);
which.onchange();
assert.deepEqual(shown(), [id]);
slider.value = time;
slider.oninput();
isAt(Number(time));
const read = said();
const cells = [...scene.querySelectorAll('.cells')].map((one) => one.innerHTML);

// ---- the next moment and back, by keys, and another one by a pointer
const step = Number(slider.step);
const key = (name) => document.body.dispatchEvent(new window.KeyboardEvent('keydown', { key: name, bubbles: true }));
key('ArrowRight');
isAt(Number(time) + step);
assert.notDeepEqual(said(), read);
key('ArrowLeft');
isAt(Number(time));
assert.deepEqual(said(), read);
const drawing = scene.querySelector('[data-x]'), [left, right, low, high] = drawing.dataset.x.split(' ').map(Number);
const other = low + 0.75 * (high - low);
drawing.dispatchEvent(new window.MouseEvent('pointerdown', { clientX: left + 0.75 * (right - left), bubbles: true }));
isAt(other);

// ---- an address leads back to its moment
window.location.hash = `#${id}/${time}`;
await new Promise((resolve) => setTimeout(resolve, 0));
window.dispatchEvent(new window.Event('hashchange'));
assert.deepEqual(said(), read);
assert.deepEqual([...scene.querySelectorAll('.cells')].map((one) => one.innerHTML), cells);

// ---- it plays to the end, and begins anew
slider.value = Number(slider.max) - step;
slider.oninput();
pace.value = '1';
button.click();
assert.equal(button.textContent, 'Pause');
while (button.textContent == 'Pause') await new Promise((resolve) => setTimeout(resolve, 5));
isAt(Number(slider.max));
button.click();
near(Number(slider.value), Number(slider.min));
button.click();
assert.equal(button.textContent, 'Play');
assert.deepEqual(errors, []);
window.close();
console.log(JSON.stringify(read));
