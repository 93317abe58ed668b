// ---------------------------------------------------------------- hands on it
/** The camera's place for a name. */
function look(name) {
  const { k, state, links } = moment, tool = links[toolOf(steps[k])].slice(0, 3);
  const points = [...starts.map(s => [s.base[0], s.base[1], 0.9]), ...starts.flatMap(s => s.objects), ...data.objects.flatMap(o => o.goals ?? [])];
  const [low, high] = [Math.min, Math.max].map(pick => [0, 1, 2].map(i => points.reduce((m, p) => pick(m, p[i]), points[0][i])));
  const size = Math.hypot(...minus(high, low)) + 1.6, middle = times(sum(low, high), 0.5);
  // A narrow window sees less from side to side.
  const distance = 0.43 * size / Math.tan(ANGLE / 2) / Math.min(1, $('scene').clientWidth / $('scene').clientHeight);
  const [yaw, pitch] = { all: [-2.2, 0.62], top: [-Math.PI / 2, Math.PI / 2 - 1e-3], side: [-Math.PI / 2, 0.06], hand: [state.base[2] - 2.2, 0.5] }[name];
  Object.assign(camera, { yaw, pitch }, name === 'hand' ? { distance: 1.5, target: tool } : { distance, target: [middle[0], middle[1], 0.7] });
  isStale = true;
}
function turnView(dx, dy) {
  Object.assign(camera, { yaw: camera.yaw - dx, pitch: clamp(camera.pitch + dy, -0.2, Math.PI / 2 - 1e-3) });
  isStale = true;
}
function zoom(factor) { Object.assign(camera, { distance: clamp(camera.distance * factor, 0.15, 200) }); isStale = true; }
/** Moves the view sideways and up by parts of the window's height. */
function shift(dx, dy) {
  const forward = unit(minus(camera.target, eyeOf(camera))), right = unit(cross(forward, [0, 0, 1])), up = cross(right, forward);
  const scale = 2 * camera.distance * Math.tan(ANGLE / 2);
  camera.target = sum(camera.target, sum(times(right, -dx * scale), times(up, dy * scale)));
  isStale = true;
}
/** What is under the pointer, and how far along the ray it is. */
function pick(event) {
  const box = $('scene').getBoundingClientRect(), eye = eyeOf(camera), forward = unit(minus(camera.target, eye));
  const right = unit(cross(forward, [0, 0, 1])), up = cross(right, forward), half = Math.tan(ANGLE / 2);
  const [px, py] = [2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height];
  const way = sum(forward, sum(times(right, px * half * box.width / box.height), times(up, py * half)));
  const floor = way[2] < 0 ? -eye[2] / way[2] : Infinity;
  let best = { name: '', at: floor };
  for (const piece of drawn) {
    const at = hit(piece, eye, way);
    if (at !== null && at > 0 && at < best.at) best = { name: piece.name, at };
  }
  return { ...best, place: sum(eye, times(way, best.at)) };
}
const pointers = new Map();
function listen() {
  const scene = $('scene'), height = () => scene.clientHeight;
  scene.addEventListener('pointerdown', event => {
    scene.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    $('tip').hidden = true;
  });
  scene.addEventListener('pointermove', event => {
    const before = pointers.get(event.pointerId);
    if (!before) {
      const box = scene.getBoundingClientRect(), name = blockedUnder(event.clientX - box.left, event.clientY - box.top) || pick(event).name;
      $('tip').hidden = !name;
      $('tip').textContent = name;
      Object.assign($('tip').style, { left: `${event.clientX - box.left}px`, top: `${event.clientY - box.top}px` });
      return;
    }
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    if (pointers.size === 2) {
      const [other] = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      const far = at => Math.hypot(at[0] - other[0], at[1] - other[1]) || 1;
      zoom(far(before) / far([event.clientX, event.clientY]));
      shift(dx / 2 / height(), dy / 2 / height());
    } else if (event.buttons & 6 || event.shiftKey) shift(dx / height(), dy / height());
    else turnView(dx * 0.006, dy * 0.006);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  for (const name of ['pointerup', 'pointercancel']) scene.addEventListener(name, event => pointers.delete(event.pointerId));
  scene.addEventListener('pointerleave', () => { $('tip').hidden = true; });
  scene.addEventListener('contextmenu', event => event.preventDefault());
  scene.addEventListener('dblclick', event => {
    const { at, place } = pick(event);
    if (at < Infinity) camera.target = place;
    isStale = true;
  });
  scene.addEventListener('wheel', event => {
    event.preventDefault();
    zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0015));
  }, { passive: false });

  const line = $('line'), go = event => {
    const box = line.getBoundingClientRect();
    // Whoever points at the curve wants to see the pair.
    if (event.clientY - box.top > 22 && event.type === 'pointerdown') setOption('pair', true);
    play(false);
    seek((event.clientX - box.left) / box.width * duration);
  };
  line.addEventListener('pointerdown', event => { line.setPointerCapture(event.pointerId); go(event); });
  line.addEventListener('pointermove', event => { if (event.buttons) go(event); });
  $('time').addEventListener('input', event => { play(false); seek(Number(event.target.value)); });
  const press = { previous: () => jump(-1, true), back: () => jump(-1), play: () => play(!isPlaying), forth: () => jump(1), next: () => jump(1, true),
    theme: () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'), picture: savePicture,
    details: () => setPage(false, !isOn('details', 'pressed')), 'tab-scene': () => setPage(false, isOn('details', 'pressed')),
    'tab-figure': () => setPage(true, isOn('details', 'pressed')) };
  for (const [id, act] of Object.entries(press)) $(id).addEventListener('click', act);
  for (const button of document.querySelectorAll('[data-view]')) button.addEventListener('click', () => look(button.dataset.view));

  const keys = { ' ': press.play, ',': press.back, '.': press.forth, '[': press.previous, ']': press.next, t: press.theme, d: press.details,
    Home: () => seek(0), End: () => seek(duration), '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1.18),
    0: () => look('all'), 1: () => look('top'), 2: () => look('side'), 3: () => look('hand') };
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches('select, summary, #iteration')) return;
    const arrow = arrows[event.key];
    if (arrow && event.target === scene) (event.shiftKey ? () => shift(-arrow[0] * 0.05, -arrow[1] * 0.05) : () => turnView(-arrow[0] * 0.08, -arrow[1] * 0.08))();
    // Elsewhere arrows go from waypoint to waypoint, also on the slider, whose own steps are of no use.
    else if (arrow && arrow[0]) jump(arrow[0]);
    else if (keys[event.key] && !(event.key === ' ' && event.target.matches('button, input[type=checkbox]'))) keys[event.key]();
    else return;
    event.preventDefault();
  });
  new ResizeObserver(() => { isStale = true; if (duration) drawLine(); }).observe(document.body);
  new ResizeObserver(() => { isStale = true; }).observe($('stage'));
  scene.addEventListener('webglcontextlost', () => fail('The graphics driver has given up; load the page again.'));
}
function setOption(name, value) {
  options[name] = value;
  $('show-' + name).checked = value;
  showMoment();
  if (renderer) for (const layer of ['paths', 'tree']) renderer[layer].count = options[layer] ? renderer[layer].all ?? 0 : 0;
  isStale = true;
}
/** What of the page is there: the scene or the figure, with the scene perhaps the panel. */
function setPage(isFigure, isOpen) {
  if (isFigure && !$('figure').firstChild) $('figure').append($('static-figure').content);
  const hidden = { figure: !isFigure, stage: isFigure, panel: (isFigure && !data.why) || !isOpen, footer: isFigure || !duration };
  for (const [id, is] of Object.entries(hidden)) $(id).hidden = is;
  $('tab-scene').setAttribute('aria-selected', !isFigure);
  $('tab-figure').setAttribute('aria-selected', isFigure);
  $('details').setAttribute('aria-pressed', isOpen);
  isStale = true;
}
const isOn = (id, state) => $(id).getAttribute('aria-' + state) === 'true';
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  readColours();
  if (renderer) buildLines();
  if (growth.attempt) growTo(growth.iteration);
  setOption('paths', options.paths);
  if (duration) drawLine();
}
function savePicture() {
  drawScene();
  Object.assign(document.createElement('a'), { href: $('scene').toDataURL(), download: `${data.title || 'scene'}.png` }).click();
}
function fail(text) {
  renderer = null;
  Object.assign($('failure'), { textContent: text, hidden: false });
}

