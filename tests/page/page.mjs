// A page in a document that runs its scripts, without layout: each drawing is as wide as its own units, so that what a pointer is at is a
// place in the drawing.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const { JSDOM, VirtualConsole } = createRequire(join(process.cwd(), 'here.js'))('jsdom');

// The window, errors of its scripts, files that it saved, and pictures that it drew.
export function open(path) {
  const errors = [], saved = [], drawn = [];
  const virtualConsole = new VirtualConsole();
  virtualConsole.on('jsdomError', (error) => errors.push(String(error)));
  const { window } = new JSDOM(readFileSync(path, 'utf8'), {
    runScripts: 'dangerously',
    pretendToBeVisual: true,
    url: 'https://page.invalid/',
    virtualConsole,
    beforeParse(window) {
      // what a browser has and this does not
      Object.defineProperty(window.SVGElement.prototype, 'viewBox', {
        get() {
          const [x, y, width, height] = this.getAttribute('viewBox').split(' ').map(Number);
          return { baseVal: { x, y, width, height } };
        },
      });
      window.Element.prototype.getBoundingClientRect = function () {
        return { left: 0, top: 0, width: this.viewBox?.baseVal.width ?? 0, height: this.viewBox?.baseVal.height ?? 0 };
      };
      window.Element.prototype.setPointerCapture = () => {};
      window.URL.createObjectURL = (blob) => { saved.push({ blob }); return 'blob:drawing'; };
      window.HTMLAnchorElement.prototype.click = function () { Object.assign(saved[saved.length - 1], { name: this.download, href: this.href }); };
      window.HTMLCanvasElement.prototype.getContext = function () { return { drawImage: (_, x, y, width, height) => drawn.push([this.width, this.height, width, height]) }; };
      window.HTMLCanvasElement.prototype.toDataURL = () => 'data:image/png;base64,';
      window.Image = class { set src(_) { this.onload(); } };
    },
  });
  return { window, errors, saved, drawn };
}
