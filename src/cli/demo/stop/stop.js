{
  const read = (element, name) => JSON.parse(element.querySelector(`script.${name}`).textContent);
  const film = read(document, 'film');
  const digit = Object.fromEntries([...film.digits].map((c, i) => [c, i]));
  const scenes = [...document.querySelectorAll('.scene')].map((element) => ({
    element,
    section: element.closest('section'),
    ...read(element, 'data'),
    stages: [...element.querySelectorAll('.stage')],
    cursors: [],
    drawn: [],
  }));
  const player = document.querySelector('.player');
  const [button, which, slider, clock, pace] = ['button', 'select', 'input', 'output', '.pace'].map((s) => player.querySelector(s));
  let scene, time = 0, playing = false, last;

  // a value between two samples; a run that is over stays as it ended
  const at = (run, name, t) => {
    const values = run[name], place = Math.min(Math.max((t - scene.start) / scene.step, 0), values.length - 1);
    const k = Math.min(Math.floor(place), values.length - 2), share = place - k;
    return values[k] * (1 - share) + values[k + 1] * share;
  };
  const fixed = (value, digits) => value.toFixed(digits).replace(/^-(0(?:\.0*)?)$/, '$1').replace('-', '−');
  const path = (points) => 'M' + points.map((p) => p.map((v) => v.toFixed(1)).join(' ')).join('L');

  function cells(code) {
    const { scale, cell, origin, colors, stripes } = film;
    const found = [];
    for (let i = 0; i < code.length;) {
      const x = ((64 * digit[code[i++]] + digit[code[i++]]) / 4095 * 2 - 1) * film.half;
      for (const y of stripes) {
        const mark = digit[code[i++]];
        if (!mark) continue;
        const pulls = mark < film.firstLevel, level = (mark - film.firstLevel) >> 1;
        const deflection = [digit[code[i++]], digit[code[i++]]].map((v) => (v - 31) / 31);
        const slides = pulls ? mark == 2 : (mark - film.firstLevel) % 2 == 1;
        found.push({ x, y, slides, deflection, color: pulls ? film.pulling : colors[level] });
      }
    }
    const [w, h] = cell.map((v) => v * scale);
    let fills = '', slides = '', arrows = '';
    for (const c of found) {
      const middle = [origin[0] + c.x * scale, origin[1] - c.y * scale];
      const [x, y] = [middle[0] - w / 2, middle[1] - h / 2].map((v) => v.toFixed(1));
      fills += `<path d="M${x} ${y}h${w}v${h}h-${w}z" fill="${c.color}"/>`;
      if (c.slides) slides += `M${+x + 1.6} ${+y + 1.6}h${w - 3.2}v${h - 3.2}h-${w - 3.2}zm0 ${h - 3.2}l${w - 3.2} -${h - 3.2}`;
      const size = Math.hypot(...c.deflection), length = size * film.arrow;
      if (length <= 1.5) continue;
      const [ux, uy] = [c.deflection[0] / size, -c.deflection[1] / size];
      const head = Math.min(0.45 * length, 7), neck = length / 2 - head;
      arrows += path([[-length / 2, 0.6], [neck, 0.6], [neck, 0.42 * head], [length / 2, 0], [neck, -0.42 * head], [neck, -0.6], [-length / 2, -0.6]]
        .map(([along, across]) => [middle[0] + along * ux - across * uy, middle[1] + along * uy + across * ux])) + 'z';
    }
    const sliding = found.filter((c) => c.slides).length;
    return {
      svg: `${fills}<path d="${slides}" fill="none" stroke="${film.sliding}" stroke-width="1.6"/>
        <path d="${arrows}" fill="#111" stroke="#fff" stroke-width="1.6" paint-order="stroke"/>`,
      words: found.length ? `${sliding} of ${found.length} bristles slide` : 'no contact',
    };
  }

  // the wheel seen from its right: to scale, but for heights and the wheel's give
  function side(run, t) {
    const { road: profile, radius, height, exaggeration: e } = scene.side;
    const px = 260, base = 292, middle = 280;
    const s = at(run, 's', t), up = (z) => base - e * z * px;
    const road = profile.filter((p, i, all) => (all[i + 1] ?? p)[0] > s - 1.2 && (all[i - 1] ?? p)[0] < s + 1.2);
    const line = road.map(([x, z]) => [middle + (x - s) * px, up(z)]);
    const x = middle + e * px * at(run, 'foreAft', t);
    const y = up(at(run, 'wheelHeight', t)) - height * px;
    const body = up(at(run, 'bodyHeight', t)) - 2 * radius * px - 26;
    const r = radius * px, turn = at(run, 'angle', t) * 180 / Math.PI;
    const spokes = [0, 72, 144, 216, 288].map((a) => `<path d="M0 0V${-0.62 * r}" transform="rotate(${a})"/>`).join('');
    const contact = up(at(run, 'road', t)), force = (name) => at(run, name, t) * 0.014;
    const arrow = (dx, dy) => {
      const length = Math.hypot(dx, dy);
      if (length < 5) return '';
      const [ux, uy] = [dx / length, dy / length], [tx, ty] = [x + dx, contact + dy];
      return `M${x} ${contact}L${tx} ${ty}M${tx - 8 * ux - 5 * uy} ${ty - 8 * uy + 5 * ux}L${tx} ${ty}L${tx - 8 * ux + 5 * uy} ${ty - 8 * uy - 5 * ux}`;
    };
    return `<rect x="${middle - 150}" y="${body - 20}" width="300" height="20" rx="5" fill="#8a949c"/>
      <path d="M${x} ${y}L${middle} ${body}" stroke="#8a949c" stroke-width="5"/>
      <g transform="translate(${x} ${y})"><circle r="${r}" fill="#3b444b"/>
      <g transform="rotate(${turn})"><circle r="${0.66 * r}" fill="#dde2e6"/><g stroke="#5b6770" stroke-width="7">${spokes}</g>
      <circle cy="${-0.82 * r}" r="5" fill="#f4f6f8"/><circle r="11" fill="#5b6770"/></g></g>
      <path d="${path(line)}L560 360L0 360z" fill="#c9cfc6" stroke="#69725f" stroke-width="2"/>
      <path d="${arrow(force('fx'), 0)}${arrow(0, -force('fz'))}" fill="none" stroke="${film.sliding}" stroke-width="3"/>`;
  }

  function show(t) {
    time = Math.min(Math.max(t, scene.start), scene.stop);
    slider.value = time;
    clock.textContent = `${time.toFixed(3)} s`;
    scene.runs.forEach((run, i) => {
      const stage = scene.stages[i];
      const frame = Math.min(Math.round((time - scene.start) / scene.step), run.frames.length - 1);
      if (scene.side) stage.querySelector('.side').innerHTML = side(run, time);
      if (frame != scene.drawn[i]) {
        const picture = cells(run.frames[frame]);
        stage.querySelector('.cells').innerHTML = picture.svg;
        run.words = picture.words;
        scene.drawn[i] = frame;
      }
      const values = scene.readouts.map(([label, key, digits, unit]) => `${label} ${fixed(at(run, key, time), digits)} ${unit}`.trim());
      stage.querySelector('output').textContent = [...values, run.words].join(' · ');
    });
    for (const { line, low, high, left, right } of scene.cursors) {
      const x = left + (time - low) / (high - low) * (right - left);
      line.setAttribute('x1', x);
      line.setAttribute('x2', x);
    }
  }

  function select(index, t) {
    scene = scenes[index];
    scenes.forEach((other) => other.section.classList.toggle('off', other != scene));
    which.value = index;
    [slider.min, slider.max, slider.step] = [scene.start, scene.stop, scene.step];
    show(t ?? scene.first);
  }

  function play(on) {
    playing = on;
    button.textContent = on ? 'Pause' : 'Play';
    last = undefined;
    if (!on) return remember();
    if (time >= scene.stop) show(scene.start);
    requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    if (last !== undefined) show(time + (now - last) / 1000 * pace.value);
    last = now;
    if (time >= scene.stop) play(false); else requestAnimationFrame(tick);
  }

  // the address leads back to this moment
  const remember = () => history.replaceState(null, '', `#${scene.element.id}/${time.toFixed(3)}`);

  function recall() {
    const [name, t] = location.hash.slice(1).split('/');
    const index = scenes.findIndex((s) => s.element.id == name);
    select(Math.max(index, 0), t && Number.isFinite(+t) ? +t : undefined);
  }

  for (const s of scenes) {
    for (const svg of s.element.querySelectorAll('[data-x]')) {
      const [left, right, low, high] = svg.dataset.x.split(' ').map(Number);
      const { width, height } = svg.viewBox.baseVal;
      svg.insertAdjacentHTML('beforeend', `<line class="cursor" y1="0" y2="${height}" stroke="#1c2329" stroke-width="4"/>`);
      s.cursors.push({ line: svg.lastElementChild, left, right, low, high });
      const go = (event) => {
        const box = svg.getBoundingClientRect();
        const x = (event.clientX - box.left) / box.width * width;
        play(false);
        show(low + (x - left) / (right - left) * (high - low));
        remember();
      };
      svg.addEventListener('pointerdown', go);
      svg.addEventListener('pointermove', (event) => { if (event.buttons) go(event); });
    }
  }
  which.innerHTML = scenes.map((s, i) => `<option value="${i}"></option>`).join('');
  scenes.forEach((s, i) => { which.options[i].textContent = s.section.querySelector('h2').textContent; });
  for (const link of document.querySelectorAll('nav a')) {
    const index = scenes.findIndex((s) => `#${s.section.id}` == link.getAttribute('href'));
    if (index < 0) continue;
    link.addEventListener('click', (event) => {
      event.preventDefault();
      select(index, time);
      remember();
      scene.section.scrollIntoView();
    });
  }
  button.onclick = () => play(!playing);
  which.onchange = () => { select(+which.value, time); remember(); };
  slider.oninput = () => { play(false); show(+slider.value); remember(); };
  addEventListener('hashchange', recall);
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest('input, select, button, a')) return;
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key == ' ') play(!playing);
    else if (step) { play(false); show(time + step * scene.step); remember(); }
    else return;
    event.preventDefault();
  });
  player.hidden = false;
  recall();
}
