{
  // Figures to work with: point to read values, drag over a part to see it alone, click a legend's entry to hide what it shows, save.
  const NS = document.querySelector('svg').namespaceURI;
  const node = (parent, name, attributes, text = '') => {
    const made = parent.appendChild(document.createElementNS(NS, name));
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
  };
  const axis = (text) => {
    const [start, end, low, high, exponent] = text.split(' ').map(Number);
    return { start, end, home: [low, high], shown: [low, high], exponent };
  };
  const place = ({ start, end, shown: [low, high] }, value) => start + (value - low) / (high - low) * (end - start);
  const value = ({ start, end, shown: [low, high] }, place) => low + (place - start) / (end - start) * (high - low);
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const written = (x, step, exponent = 0) => {
    const digits = clamp(Math.ceil(-Math.log10(step / 10 ** exponent) - 1e-9), 0, 15);
    return (x / 10 ** exponent).toFixed(digits).replace(/^-(?=[0.]*$)/, '').replace('-', '−');
  };

  // at most `count` labels, a round step apart
  const ticks = ([low, high], count) => {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((m) => m * power >= 0.999 * raw);
    const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    return { step, values: Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step) };
  };

  // the places of a drawn shape, as values
  const points = (shape, x, y) => {
    if (shape.tagName == 'circle') return [[value(x, +shape.getAttribute('cx')), value(y, +shape.getAttribute('cy'))]];
    const found = (shape.getAttribute('points') ?? shape.getAttribute('d')).match(/-?\d+/g).map(Number);
    const steps = shape.tagName == 'path';
    const all = [];
    for (let i = 0; i + 1 < found.length; i += 2) {
      const before = steps && i ? all[all.length - 1] : [0, 0];
      all.push([before[0] + found[i], before[1] + found[i + 1]]);
    }
    return all.map(([a, b]) => [value(x, a), value(y, b)]);
  };

  const figures = [...document.querySelectorAll('figure > svg[data-x]')].map((svg) => {
    const figure = svg.parentElement, data = svg.querySelector('.data');
    const [x, y] = [axis(svg.dataset.x), axis(svg.dataset.y)];
    const texts = [...svg.querySelectorAll(':scope > text')], titles = texts.filter((t) => t.textContent.includes('['));
    return {
      svg, figure, data, x, y,
      keys: [...figure.querySelectorAll('figcaption .key')],
      // the player of a film has the pointer
      isFree: !svg.closest('.scene'),
      over: titles[titles.length - 1]?.textContent.trim(),
      fixed: [...texts.filter((t) => !titles.includes(t)), ...svg.querySelectorAll(':scope > line, :scope > polyline')],
    };
  });

  // read from the drawing when they are needed first
  const shapes = (f) => f.shapes ??= [...f.data.querySelectorAll('polyline, path, polygon, circle')].map((shape) => ({
    shape,
    key: shape.closest('[data-key]')?.dataset.key,
    points: points(shape, { ...f.x, shown: f.x.home }, { ...f.y, shown: f.y.home }),
  }));
  const isCourse = (f) => f.course ??= shapes(f).every(({ shape, points: all }) =>
    shape.tagName == 'polygon' || shape.tagName == 'circle' || all.every(([x], i) => !i || x >= all[i - 1][0]));
  const seen = (f) => shapes(f).filter(({ key }) => key === undefined || !f.keys[key]?.classList.contains('off'));
  const isSame = (a, b) => a.isFree && b.isFree && isCourse(a) && isCourse(b) && a.over == b.over
    && a.x.home.every((end, i) => end == b.x.home[i]);
  const linked = (f) => figures.filter((other) => other == f || isSame(f, other));

  function draw(f) {
    const { svg, x, y } = f;
    const [left, right, top, bottom] = [x.start, x.end, y.end, y.start];
    const isWhole = [x, y].every((a) => a.shown.every((end, i) => end == a.home[i]));
    f.drawn?.remove();
    f.fixed.forEach((part) => { part.style.display = isWhole ? '' : 'none'; });
    for (const { shape, points: all } of shapes(f)) {
      const at = all.map(([a, b]) => [place(x, a).toFixed(1), place(y, b).toFixed(1)]);
      if (shape.tagName == 'circle') ['cx', 'cy'].forEach((name, i) => shape.setAttribute(name, at[0][i]));
      else if (shape.tagName == 'path') shape.setAttribute('d', 'M' + at.map((p) => p.join(' ')).join('L'));
      else shape.setAttribute('points', at.map((p) => p.join(',')).join(' '));
    }
    svg.append(f.data);
    f.view?.remove();
    if (isWhole) return;
    f.drawn = node(svg, 'g', {});
    // a drawing of its own cuts off what is beyond the axes
    const [wide, high] = [right - left, bottom - top];
    f.view = node(svg, 'svg', { x: left, y: top, width: wide, height: high, viewBox: `${left} ${top} ${wide} ${high}` });
    f.view.append(f.data);
    const size = +svg.querySelector('text').getAttribute('font-size'), { width } = svg.viewBox.baseVal;
    const text = { 'font-family': 'sans-serif', 'font-size': size, fill: '#465058' };
    const across = ticks(x.shown, Math.round((right - left) / size / 9)), up = ticks(y.shown, Math.round((bottom - top) / size / 4));
    for (const at of across.values) {
      const px = place(x, at);
      node(f.drawn, 'line', { x1: px, x2: px, y1: top, y2: bottom, stroke: '#E4E8EB', 'stroke-width': 2 });
      node(f.drawn, 'text', { x: px, y: bottom + 0.6 * size, dy: '0.76em', 'text-anchor': 'middle', ...text }, written(at, across.step, x.exponent));
    }
    for (const at of up.values) {
      const py = place(y, at);
      node(f.drawn, 'line', { x1: left, x2: right, y1: py, y2: py, stroke: '#E4E8EB', 'stroke-width': 2 });
      node(f.drawn, 'text', { x: left - 0.6 * size, y: py, dy: '0.5ex', 'text-anchor': 'end', ...text }, written(at, up.step, y.exponent));
    }
    node(f.drawn, 'path', { d: `M${left} ${top}V${bottom}H${right}`, fill: 'none', stroke: '#969EA4', 'stroke-width': 2 });
  }

  // the heights of what is seen over the part of x that is shown, to round ends
  function fit(f) {
    const [low, high] = f.x.shown;
    const all = [];
    for (const { points: own } of seen(f)) {
      own.forEach(([x, y], i) => {
        if (x >= low && x <= high) all.push(y);
        const [before, at] = i ? own[i - 1] : [x, y];
        for (const end of [low, high]) if (before < end && end < x) all.push(at + (end - before) / (x - before) * (y - at));
      });
    }
    const [least, most] = all.reduce(([a, b], y) => [Math.min(a, y), Math.max(b, y)], [Infinity, -Infinity]);
    if (!(most > least)) return;
    const { step } = ticks([least, most], 12);
    f.y.shown = [Math.floor(least / step + 1e-9) * step, Math.ceil(most / step - 1e-9) * step];
  }

  function show(f, across, up) {
    for (const other of up ? [f] : linked(f)) {
      other.x.shown = across;
      if (up) other.y.shown = up; else fit(other);
      draw(other);
    }
  }

  function whole(f) {
    for (const other of linked(f)) {
      for (const a of [other.x, other.y]) a.shown = [...a.home];
      draw(other);
    }
  }

  // where a line is at x, if it is there
  const at = (points, x) => {
    const i = points.findIndex(([end]) => end >= x);
    if (i < 0 || (i == 0 && points[0][0] > x)) return;
    const [[a, b], [c, d]] = [points[Math.max(i - 1, 0)], points[i]];
    return c > a ? b + (x - a) / (c - a) * (d - b) : d;
  };

  const tip = document.body.appendChild(document.createElement('div'));
  tip.className = 'tip';
  tip.hidden = true;

  function read(f, px, py) {
    const fine = (a) => Math.abs(a.shown[1] - a.shown[0]) / 1000;
    const words = (a, v) => written(v, fine(a), a.exponent);
    const name = (key) => f.keys[key]?.textContent ?? '';
    const lines = seen(f).filter(({ key }) => key !== undefined);
    linked(f).forEach((other) => other.cursor?.remove());
    if (isCourse(f) && lines.some(({ shape }) => shape.tagName != 'circle')) {
      const x = value(f.x, px);
      for (const other of linked(f)) {
        const mark = place(other.x, x);
        other.cursor = node(other.svg, 'line', { x1: mark, x2: mark, y1: other.y.end, y2: other.y.start, stroke: '#1c2329', 'stroke-width': 2 });
      }
      const values = new Map();
      for (const { key, points: own } of lines) {
        const found = at(own, x);
        if (found !== undefined) values.set(key, found);
      }
      return [`${f.over}: ${words(f.x, x)}`, ...[...values].map(([key, v]) => `${name(key)} ${words(f.y, v)}`)];
    }
    let best;
    for (const { key, points: own } of lines) {
      const places = own.map(([a, b]) => [place(f.x, a), place(f.y, b)]);
      places.forEach(([u, v], i) => {
        // the nearest place between this point and the next
        const [dx, dy] = [0, 1].map((k) => (places[i + 1] ?? places[i])[k] - places[i][k]), length = dx * dx + dy * dy;
        const share = length ? clamp(((px - u) * dx + (py - v) * dy) / length, 0, 1) : 0;
        const [cx, cy] = [u + share * dx, v + share * dy], far = Math.hypot(cx - px, cy - py);
        if (!best || far < best.far) best = { key, cx, cy, far };
      });
    }
    if (!best) return [];
    const { cx, cy } = best;
    f.cursor = node(f.svg, 'circle', { cx, cy, r: 12, fill: 'none', stroke: '#1c2329', 'stroke-width': 3 });
    return [name(best.key), `${f.over}: ${words(f.x, value(f.x, cx))}`, words(f.y, value(f.y, cy))];
  }

  // the figure with its title and legend, as a file's text
  function file(f) {
    const copy = f.svg.cloneNode(true), { width, height } = f.svg.viewBox.baseVal;
    const size = +f.svg.querySelector('text').getAttribute('font-size');
    const drawing = document.createElementNS(NS, 'svg');
    const text = (x, y, words, more = {}) => node(drawing, 'text', { x, y, 'font-family': 'sans-serif', 'font-size': size, fill: '#1c2329', ...more }, words);
    const title = f.figure.querySelector('figcaption b')?.textContent ?? '';
    if (title) text(size, 1.4 * size, title, { 'font-weight': 'bold' });
    let [x, y] = [size, (title ? 3 : 1.4) * size];
    f.keys.forEach((key, i) => {
      if (key.classList.contains('off')) return;
      const wide = (key.textContent.length * 0.62 + 5) * size;
      if (x > size && x + wide > width) [x, y] = [size, y + 1.5 * size];
      node(drawing, 'line', { x1: x, x2: x + 2 * size, y1: y - 0.3 * size, y2: y - 0.3 * size, stroke: key.querySelector('i').style.borderColor, 'stroke-width': 6 });
      text(x + 2.6 * size, y, key.textContent);
      x += wide;
    });
    const above = y + 0.8 * size;
    for (const [name, of] of Object.entries({ width: width / 2, height: (height + above) / 2, viewBox: `0 0 ${width} ${height + above}` })) drawing.setAttribute(name, of);
    copy.querySelectorAll('.cursor').forEach((part) => part.remove());
    for (const [name, of] of Object.entries({ x: 0, y: above, width, height })) copy.setAttribute(name, of);
    drawing.prepend(copy);
    drawing.insertBefore(document.createElementNS(NS, 'rect'), copy).setAttribute('fill', '#fff');
    for (const [name, of] of Object.entries({ width, height: height + above })) drawing.firstChild.setAttribute(name, of);
    return { text: new XMLSerializer().serializeToString(drawing), width, height: height + above };
  }

  function save(f, kind) {
    const name = `${(f.figure.querySelector('figcaption b')?.textContent || f.svg.getAttribute('aria-label')).replace(/[^\p{L}\p{N}]+/gu, '-').replace(/^-|-$/g, '')}.${kind}`;
    const drawing = file(f), link = document.createElement('a');
    const leave = (href) => { Object.assign(link, { href, download: name }).click(); };
    const address = URL.createObjectURL(new Blob([drawing.text], { type: 'image/svg+xml' }));
    if (kind == 'svg') return leave(address);
    const image = new Image();
    image.onload = () => {
      const canvas = Object.assign(document.createElement('canvas'), { width: Math.ceil(drawing.width), height: Math.ceil(drawing.height) });
      canvas.getContext('2d').drawImage(image, 0, 0, drawing.width, drawing.height);
      leave(canvas.toDataURL('image/png'));
    };
    image.src = address;
  }

  for (const f of figures) {
    const caption = f.figure.querySelector('figcaption');
    f.keys.forEach((key, i) => {
      const group = f.data.querySelector(`[data-key="${i}"]`);
      const turn = () => { group.style.display = key.classList.toggle('off') ? 'none' : ''; };
      Object.assign(key, { tabIndex: 0, title: 'hide or show', onclick: turn });
      key.setAttribute('role', 'button');
      key.onkeydown = (event) => { if (event.key == 'Enter') turn(); };
    });
    const tools = caption.appendChild(document.createElement('span'));
    tools.className = 'tools';
    const tool = (words, title, does) => Object.assign(tools.appendChild(document.createElement('button')), { type: 'button', textContent: words, title, onclick: does });
    if (f.isFree) f.all = tool('whole', 'show all of it again', () => whole(f));
    for (const kind of ['svg', 'png']) tool(kind, `save as ${kind.toUpperCase()}`, () => save(f, kind));
    if (!f.isFree) continue;
    const where = (event) => {
      const box = f.svg.getBoundingClientRect(), scale = f.svg.viewBox.baseVal.width / box.width;
      const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
      return [clamp(x, f.x.start, f.x.end), clamp(y, f.y.end, f.y.start), x == clamp(x, f.x.start, f.x.end)];
    };
    let from, frame;
    const leave = () => {
      tip.hidden = true;
      linked(f).forEach((other) => { other.cursor?.remove(); });
    };
    f.svg.addEventListener('pointerdown', (event) => {
      const [x, y, isInside] = where(event);
      if (!isInside || event.button) return;
      from = [x, y];
      frame = node(f.svg, 'rect', { fill: '#0072B2', opacity: 0.12 });
      f.svg.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    f.svg.addEventListener('pointermove', (event) => {
      const [x, y, isInside] = where(event);
      if (!isInside && !from) return leave();
      const words = read(f, x, y);
      f.cursor?.classList.add('cursor');
      tip.hidden = !words.length;
      tip.replaceChildren(...words.map((line) => Object.assign(document.createElement('div'), { textContent: line })));
      tip.style.left = `${Math.min(event.pageX + 14, document.documentElement.clientWidth - tip.offsetWidth - 8)}px`;
      tip.style.top = `${event.pageY + 14}px`;
      if (!from) return;
      const up = isCourse(f) ? [f.y.end, f.y.start] : [Math.min(from[1], y), Math.max(from[1], y)];
      for (const [name, of] of Object.entries({ x: Math.min(from[0], x), width: Math.abs(x - from[0]), y: up[0], height: up[1] - up[0] })) frame.setAttribute(name, of);
    });
    f.svg.addEventListener('pointerup', (event) => {
      if (!from) return;
      const [x, y] = where(event), [start, begin] = from;
      from = undefined;
      frame.remove();
      // less than a hand's tremble is no part
      const least = 0.01 * (f.x.end - f.x.start);
      if (Math.abs(x - start) < least) return;
      const part = (a, one, other) => [one, other].map((px) => value(a, px)).sort((p, q) => p - q);
      if (isCourse(f)) show(f, part(f.x, start, x));
      else if (Math.abs(y - begin) >= least) show(f, part(f.x, start, x), part(f.y, begin, y));
    });
    f.svg.addEventListener('pointerleave', () => { if (!from) leave(); });
    f.svg.addEventListener('dblclick', () => whole(f));
  }
}
