// ---------------------------------------------------------------- what is marked
/** Names of the bodies, objects and links that somebody wants to see, and where the mark of a place is. */
const marks = { names: new Set(), at: null, button: null };
/** By name: how often it was in the way of the search, as a share of what was most often. */
const heat = new Map();
for (const { first, second, count } of data.why?.blocks ?? []) for (const name of [first, second]) heat.set(name, (heat.get(name) ?? 0) + count);
const hottest = Math.max(1, ...heat.values());
for (const [name, count] of heat) heat.set(name, Math.sqrt(count / hottest));

/** The colour of something, as it is marked. */
function painted(name, colour) {
  if (marks.names.has(name)) return colours.near;
  const share = options.heat ? heat.get(name) ?? 0 : 0;
  return share ? colour.map((c, i) => c + (colours.hot[i] - c) * 0.75 * share) : colour;
}
/** Where the pieces of this name are drawn: the middle and the top of each. */
function placesOf(name) {
  return drawn.filter(piece => piece.name === name).map(({ mesh, world, size }) => {
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(i => moved(world, [0, 1, 2].map(axis => (i >> axis & 1 ? mesh.high : mesh.low)[axis] * size[axis])));
    return { middle: times(corners.reduce(sum), 1 / 8), top: Math.max(...corners.map(c => c[2])) };
  });
}
/** Marks what has these names, and looks at it; what is marked already is marked no more. */
function mark(names, at, button) {
  const isSame = marks.button === button;
  if (marks.button) marks.button.setAttribute('aria-pressed', false);
  Object.assign(marks, { names: new Set(isSame ? [] : names), at: isSame ? null : at, button: isSame ? null : button });
  if (marks.button) marks.button.setAttribute('aria-pressed', true);
  isStale = true;
  if (!renderer) return;
  drawScene();
  const places = [...marks.names].flatMap(placesOf), points = [...places.map(place => place.middle), ...at && !isSame ? [at] : []];
  const pole = ([x, y, z]) => [x, y, z + 0.02, x, y, z + 0.35, ...colours.near, 1, 4 * devicePixelRatio];
  renderer.setLines(renderer.marks, isSame ? [] : [...places.map(({ middle, top }) => [middle[0], middle[1], top]), ...at ? [at] : []].flatMap(pole));
  if (!points.length) return;
  const [low, high] = [Math.min, Math.max].map(pick => [0, 1, 2].map(i => points.reduce((m, p) => pick(m, p[i]), points[0][i])));
  Object.assign(camera, { target: times(sum(low, high), 0.5), distance: clamp(1.6 * Math.hypot(...minus(high, low)) + 1.8, 1.8, Math.max(camera.distance, 1.8)) });
}
/** A button that marks. */
function markButton(text, names, at) {
  const button = Object.assign(document.createElement('button'), { textContent: text, title: `Show ${names.join(', ') || 'the place'}`, className: 'mark' });
  button.setAttribute('aria-pressed', false);
  button.addEventListener('click', () => mark(names, at, button));
  return button;
}
