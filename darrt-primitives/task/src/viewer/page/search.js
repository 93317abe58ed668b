// ---------------------------------------------------------------- how the search went
const { search } = data;
const growth = { attempt: null, iteration: 0, isGrowing: false, places: [], crosses: [] };
/** By node: where each object stands; nodes share what does not change. */
function placesOfNodes({ nodes }) {
  const places = [];
  nodes.forEach(([parent, , , , moves], i) => {
    const before = parent === null ? data.start.objects.map(pose => pose) : places[parent];
    places[i] = moves.length ? before.map((pose, object) => moves.find(move => move[0] === object)?.[1] ?? pose) : before;
  });
  return places;
}
function chooseAttempt(index) {
  growth.attempt = search.attempts[index];
  growth.places = placesOfNodes(growth.attempt);
  $('iteration').max = growth.attempt.iterations;
  growTo(growth.attempt.iterations);
}
/** Shows the tree as it was behind an iteration. */
function growTo(iteration) {
  const { attempt, places } = growth, { nodes } = attempt, at = growth.iteration = clamp(Math.round(iteration), 0, attempt.iterations);
  const gone = new Set(attempt.removed.filter(([, when]) => when <= at).map(([node]) => node)), lines = [];
  const line = (a, b, colour, alpha, width) => {
    if (Math.hypot(...minus(a, b)) > 1e-4) lines.push(...a, ...b, ...colour, alpha, width * devicePixelRatio);
  };
  const onFloor = ([x, y]) => [x, y, 0.008];
  let count = 0;
  nodes.forEach(([parent, when, , base], i) => {
    if (when > at) return;
    count++;
    if (parent === null) return;
    const alpha = gone.has(i) ? 0.25 : 0.9;
    line(onFloor(nodes[parent][3]), onFloor(base), colours.text, 0.6 * alpha, 1.2);
    places[i].forEach((pose, object) => line(places[parent][object].slice(0, 3), pose.slice(0, 3), colours.objects[object % colours.objects.length], alpha, 1.8));
  });
  // Blocked extensions that ended at one place are one mark.
  const crosses = new Map(), sums = new Map();
  const put = (place, pair) => {
    const key = place.map(x => Math.round(x * 50)).join();
    if (!crosses.has(key)) crosses.set(key, { place, count: 0, pairs: new Map() });
    const cross = crosses.get(key);
    cross.count++;
    cross.pairs.set(pair, (cross.pairs.get(pair) ?? 0) + 1);
  };
  let blocked = 0;
  for (const [when, node, first, second] of attempt.blocked) {
    if (when > at) break;
    blocked++;
    const pair = `${first},${second}`;
    sums.set(pair, (sums.get(pair) ?? 0) + 1);
    put(onFloor(nodes[node][3]), pair);
    places[node].forEach(pose => put(pose.slice(0, 3), pair));
  }
  growth.crosses = [...crosses.values()];
  for (const { place: [x, y, z], count } of growth.crosses) {
    const r = 0.012 + 0.006 * Math.log2(count + 1);
    for (const [dx, dy] of [[r, r], [r, -r]]) lines.push(x - dx, y - dy, z + 0.004, x + dx, y + dy, z + 0.004, ...colours.goal, 0.95, 1.8 * devicePixelRatio);
  }
  if (renderer) {
    renderer.setLines(renderer.tree, lines);
    renderer.tree.all = renderer.tree.count;
    if (!options.tree) renderer.tree.count = 0;
  }
  if (Number($('iteration').value) !== at) $('iteration').value = at;
  $('iteration').setAttribute('aria-valuetext', `iteration ${at} of ${attempt.iterations}`);
  $('grown').textContent = `iteration ${at} of ${attempt.iterations}: ${count} nodes${gone.size ? `, ${gone.size} of them taken back` : ''}, ${blocked} extensions blocked`;
  const most = [...sums].sort((a, b) => b[1] - a[1]).slice(0, 6).map(([pair, times]) => element('li', {}, markButton(`${times} × ${pairWords(pair)}`, namesOf(pair))));
  $('obstructions').replaceChildren(...most);
  isStale = true;
}
const namesOf = pair => pair.split(',').map(index => search.bodies[index]);
const pairWords = pair => namesOf(pair).join(' and ');
/** What blocked at the mark that is under the pointer, if there is one. */
function blockedUnder(x, y) {
  if (!search || !options.tree || !growth.attempt) return '';
  const canvas = $('scene'), eye = eyeOf(camera), forward = unit(minus(camera.target, eye)), right = unit(cross(forward, [0, 0, 1])), up = cross(right, forward);
  const focal = canvas.clientHeight / 2 / Math.tan(ANGLE / 2);
  let best = { far: 9, cross: null };
  for (const mark of growth.crosses) {
    const to = minus(mark.place, eye), deep = dot(to, forward);
    if (deep < 0.05) continue;
    const far = Math.hypot(canvas.clientWidth / 2 + dot(to, right) / deep * focal - x, canvas.clientHeight / 2 - dot(to, up) / deep * focal - y);
    if (far < best.far) best = { far, cross: mark };
  }
  if (!best.cross) return '';
  const pairs = [...best.cross.pairs].sort((a, b) => b[1] - a[1]);
  return `blocked ${best.cross.count} times: ${pairs.slice(0, 3).map(([pair, times]) => `${pairWords(pair)} (${times})`).join(', ')}${pairs.length > 3 ? ', …' : ''}`;
}
function setGrowing(on) {
  growth.isGrowing = on;
  if (on && growth.iteration >= growth.attempt.iterations) growTo(0);
  $('grow').textContent = on ? '❚❚' : '▶';
  $('grow').setAttribute('aria-label', on ? 'Pause the search' : 'Replay the search');
}
/** Goes on with the replay, which takes about ten seconds. */
function grow(milliseconds) {
  growth.exact = Math.max(growth.exact ?? 0, growth.iteration) + Math.max(growth.attempt.iterations, 1) * milliseconds / 10000;
  if (Math.round(growth.exact) !== growth.iteration) growTo(growth.exact);
  if (growth.iteration >= growth.attempt.iterations) setGrowing(false);
  if (!growth.isGrowing) growth.exact = 0;
}
function showSearch() {
  if (!search || !search.attempts.length) return;
  $('search').hidden = false;
  search.attempts.forEach(({ attempt }, i) => $('attempt').append(element('option', { value: i, textContent: `attempt ${attempt}${attempt === search.solved ? ', with the plan' : ''}` })));
  $('attempt').value = search.attempts.length - 1;
  $('attempt').addEventListener('change', event => chooseAttempt(Number(event.target.value)));
  $('iteration').addEventListener('input', event => { setGrowing(false); growTo(Number(event.target.value)); });
  $('grow').addEventListener('click', () => setGrowing(!growth.isGrowing));
  $('search-note').textContent = search.left_out ? `${search.left_out} nodes and blocked extensions are not in this page: the recording has them.` : '';
  chooseAttempt(search.attempts.length - 1);
}
