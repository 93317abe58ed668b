const jointRows = robot.variables.map(({ name, limits }, i) => {
  const make = (tag, more) => Object.assign(document.createElement(tag), more);
  const value = make('span'), mark = make('b'), row = make('div', { className: 'joint' });
  // Where no plan moves the robot, a person does.
  const slider = steps.length ? null : make('input', { type: 'range', min: limits?.[0] ?? -Math.PI, max: limits?.[1] ?? Math.PI, step: 'any' });
  slider?.setAttribute('aria-label', name);
  slider?.addEventListener('input', () => pose(i, Number(slider.value)));
  const bar = make('div', { title: limits ? `${limits[0].toFixed(2)} to ${limits[1].toFixed(2)}` : 'turns without end' });
  bar.append(mark);
  row.append(make('span', { textContent: name }), value, slider ?? bar);
  (driven.has(i) || !steps.length ? $('joints') : $('resting')).append(row);
  return { row, value, mark, slider, shown: null };
});
const metres = m => m < 0.1 ? `${(1000 * m).toFixed(1)} mm` : `${m.toFixed(2)} m`;
const shown = {};
function show(id, text) { if (shown[id] !== text) $(id).textContent = shown[id] = text; }
let shownStep = -1;
/** What is done, and by which hand where there are several. */
const called = step => robot.tools ? `${step.name}, ${robot.links[toolOf(step)].name}` : step.name;
/** Everything but the scene itself. */
function showMoment() {
  const { k, u, time, state } = moment, step = steps[k];
  state.joints.forEach((value, i) => {
    const { row, value: text, mark, slider, shown } = jointRows[i];
    if (shown === value) return;
    const { kind, limits } = robot.variables[i];
    const [low, high] = limits ?? [-Math.PI, Math.PI], at = limits ? value : shortWay(value), part = clamp((at - low) / (high - low), 0, 1);
    text.textContent = kind === 'turning' ? `${(at * 180 / Math.PI).toFixed(1)}°` : metres(at);
    mark.style.left = `${100 * part}%`;
    if (slider && document.activeElement !== slider) slider.value = at;
    row.classList.toggle('tight', Boolean(limits) && Math.min(part, 1 - part) < 0.03);
    jointRows[i].shown = value;
  });
  const pair = nearestAt(k, u);
  show('nearest', pair ? `${metres(Math.max(pair.distance, 0))}: ${pair.bodies.join(' – ')}` : 'not measured');
  if (renderer) {
    const [a, b] = pair?.points ?? [];
    // The line would be a lie where the pair has moved since it was measured.
    const isHere = pair && options.pair && Math.abs(pair.at - u) < 1.6;
    renderer.setLines(renderer.pair, isHere ? [...a, ...b, ...colours.near, 1, 5 * devicePixelRatio] : []);
  }
  if (!step) return;
  if (shownStep !== k) {
    shownStep = k;
    const chip = document.createElement('i');
    chip.style.background = step.colour;
    $('now').replaceChildren(chip, `${k + 1}/${steps.length} ${called(step)}`);
    const name = i => data.objects[i].name;
    show('what', [step.holds && `holds ${name(step.holds.object)}`, step.pushes !== undefined && `pushes ${name(step.pushes)}`,
      !step.holds && step.pushes === undefined && step.object !== undefined && `about ${name(step.object)}`].filter(Boolean).join(', ') || 'hand empty');
    const items = (step.contacts ?? []).map(([a, b, why]) => Object.assign(document.createElement('li'), { textContent: `${a} – ${b} (${why})` }));
    $('contacts').replaceChildren(...items.length ? items : ['nothing but what rests on what carries it']);
  }
  $('head').style.left = `${100 * time / duration}%`;
  if (document.activeElement !== $('time') || Number($('time').value) !== time) $('time').value = time;
  $('time').setAttribute('aria-valuetext', `step ${k + 1} of ${steps.length}, ${called(step)}, waypoint ${Math.floor(u) + 1} of ${step.times.length}`);
  show('status', `waypoint ${Math.floor(u + 1e-6) + 1}/${step.times.length} · ${time.toFixed(1)} / ${duration.toFixed(1)} s`);
}

/** Bands of the steps, and the clearance below them. */
function drawLine() {
  const canvas = $('bands'), context = canvas.getContext('2d'), ratio = devicePixelRatio;
  const [w, h] = [canvas.clientWidth, canvas.clientHeight];
  Object.assign(canvas, { width: w * ratio, height: h * ratio });
  context.scale(ratio, ratio);
  context.font = '11px system-ui, sans-serif';
  const x = t => t / duration * w, top = 24;
  // Near zero matters most, so distances are drawn by their square roots.
  const y = m => h - 2 - Math.sqrt(clamp(m, 0, 0.4) / 0.4) * (h - top - 10);
  steps.forEach(({ name, colour }, k) => {
    const [from, to] = [x(clock[k]), x(clock[k + 1])];
    context.fillStyle = colour;
    context.fillRect(from, 0, Math.max(to - from - 1, 1), 20);
    const [r, g, b] = colours.number(colour);
    context.fillStyle = 0.3 * r + 0.59 * g + 0.11 * b > 0.6 ? '#000' : '#fff';
    const label = [`${k + 1} ${name}`, `${k + 1} ${name.split('-').map(word => word[0]).join('')}`, `${k + 1}`].find(text => context.measureText(text).width < to - from - 6);
    if (label) context.fillText(label, from + 3, 14);
  });
  context.strokeStyle = colours.frame.css;
  context.fillStyle = colours.quiet.css;
  for (const [m, text] of [[0.01, '1 cm'], [0.1, '10 cm'], [0.4, '40 cm']]) {
    context.strokeRect(0, y(m), w, 0.5);
    context.fillText(text, 2, y(m) - 2);
  }
  context.strokeStyle = colours.near.css;
  context.lineWidth = 1.5;
  context.beginPath();
  steps.forEach((step, k) => (step.clearance ?? []).forEach(({ at, distance }, i) =>
    context[i ? 'lineTo' : 'moveTo'](x(timeOf(k, at)), y(distance))));
  context.stroke();
}

