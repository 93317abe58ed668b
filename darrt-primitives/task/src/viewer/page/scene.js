// ---------------------------------------------------------------- what is shown
const options = { paths: true, ghosts: true, pair: true, shadows: true, edges: true, walls: true, follow: false,
  heat: Boolean(data.why), closest: Boolean(data.why?.nearest) && !steps.length, tree: Boolean(data.search) && !steps.length };
const OPTION_WORDS = { paths: 'paths', ghosts: 'start and goal', pair: 'nearest pair', shadows: 'shadows', edges: 'edges', walls: 'clear walls', follow: 'follow robot',
  ...data.why && { heat: 'heat: who blocked' }, ...data.why?.nearest && { closest: 'nearest state' }, ...data.search && { tree: 'search tree' } };
const camera = { yaw: -2.2, pitch: 0.6, distance: 5, target: [0, 0, 0.7] };
const SUN = unit([-0.35, -0.5, 1.1]), ANGLE = 0.75;
const moment = { time: 0, k: 0, u: 0, state: data.start, links: [] };
let closestLinks, renderer, colours, isPlaying = false, isStale = true, isCoarse = false, slowFrames = 0, lastTick = 0, lastDrawn = 0, drawn = [];

/** Colours of the style sheet as numbers 0 to 1. */
function readColours() {
  const style = getComputedStyle(document.documentElement), read = name => style.getPropertyValue('--' + name).trim();
  const number = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255);
  colours = { number, objects: read('objects').split(' ').map(number) };
  for (const name of ['sky', 'floor', 'grid', 'table', 'furniture', 'clutter', 'robot', 'arm', 'hand', 'edge', 'goal', 'start', 'near', 'hot', 'text', 'quiet', 'frame']) {
    colours[name] = number(read(name));
    colours[name].css = read(name);
  }
}

/** Which joints move in the plan, and what each link is: part of the hand, of the arm, or of the rest. */
const driven = new Set(steps.flatMap(step => (step.joints ?? []).map(track => track.variable)));
const linkKind = [];
// A hand is all below the last joint above its tool.
const wrists = tools.map(tool => {
  while (tool !== null && !robot.links[tool].joint) tool = robot.links[tool].parent;
  return tool;
});
robot.links.forEach(({ parent, joint }, i) => {
  const above = linkKind[parent] ?? 'robot', isArm = above === 'arm' || (joint && driven.has(joint.variable));
  linkKind[i] = above === 'hand' || wrists.includes(i) ? 'hand' : isArm ? 'arm' : 'robot';
});
let linkPieces, objectPieces, bodies;
/** Makes the meshes, and finds out what each fixed body is to a person. */
function buildScene() {
  const all = parts => (parts ?? []).flatMap(pieces);
  linkPieces = robot.links.map(link => all(link.parts));
  objectPieces = data.objects.map(object => all(object.parts));
  bodies = data.bodies.map(({ name, pose, parts, carries }) => {
    const placed = all(parts).map(piece => ({ ...piece, world: product(pose, piece.pose) }));
    const corners = placed.flatMap(({ mesh, world, size }) => [0, 1, 2, 3, 4, 5, 6, 7].map(i =>
      moved(world, [0, 1, 2].map(axis => (i >> axis & 1 ? mesh.high : mesh.low)[axis] * size[axis]))));
    const low = Math.min(...corners.map(c => c[2])), high = Math.max(...corners.map(c => c[2]));
    const wide = Math.max(...[0, 1].map(axis => Math.max(...corners.map(c => c[axis])) - Math.min(...corners.map(c => c[axis]))));
    const role = carries ? 'table' : high - low > 1 && wide > 1.2 ? 'wall' : low < 0.02 ? 'furniture' : 'clutter';
    return { name, pose, role, placed, colour: role === 'wall' ? 'furniture' : role };
  });
}
/** The ways of hand, base and objects as lines, and the edges of the surfaces. */
function buildLines() {
  renderer.setLines(renderer.rims, data.surfaces.flatMap(({ z, corners }) => corners.flatMap((corner, i) =>
    [...corner, z + 1e-3, ...corners[(i + 1) % corners.length], z + 1e-3, ...colours.edge, 0.8, 1.5 * devicePixelRatio])));
  const lines = [];
  const line = (a, b, colour, alpha, width) => {
    if (Math.hypot(...minus(a, b)) > 1e-4) lines.push(...a, ...b, ...colour, alpha, width * devicePixelRatio);
  };
  steps.forEach((step, k) => {
    const colour = colours.number(step.colour);
    let before = null;
    for (let u = 0; u < step.times.length; u++) {
      const state = stateAt(k, u), tool = linkPoses(state.base, state.joints, toTool)[toolOf(step)].slice(0, 3);
      const base = [state.base[0], state.base[1], 0.004];
      if (before) {
        line(before.tool, tool, colour, 0.9, 2);
        line(before.base, base, colour, 0.9, 3);
        state.objects.forEach((pose, i) => line(before.objects[i].slice(0, 3), pose.slice(0, 3), colours.objects[i % colours.objects.length], 1, 3.5));
      }
      before = { tool, base, objects: state.objects };
    }
  });
  renderer.setLines(renderer.paths, lines);
  renderer.paths.all = renderer.paths.count;
}

/** A point of the world, or with `isWay` a direction, as a piece sees it. */
function seenBy({ world, size }, v, isWay) {
  return turned([0, 0, 0, -world[3], -world[4], -world[5], world[6]], isWay ? v : minus(v, world)).map((x, i) => x / size[i]);
}
/** Do two points lie on different sides of what is thin and upright? */
function parts(piece, a, b) {
  const axis = piece.size[0] * (piece.mesh.high[0] - piece.mesh.low[0]) < piece.size[1] * (piece.mesh.high[1] - piece.mesh.low[1]) ? 0 : 1;
  return seenBy(piece, a)[axis] * seenBy(piece, b)[axis] < 0;
}
/** Where a ray from `from` along `way` enters the box around a piece, in lengths of `way`; none if it misses. */
function hit(piece, from, way) {
  const [o, d] = [seenBy(piece, from), seenBy(piece, way, true)];
  let enter = 0, leave = Infinity;
  for (let i = 0; i < 3; i++) {
    const [a, b] = [piece.mesh.low[i], piece.mesh.high[i]].map(end => (end - o[i]) / (d[i] || 1e-12));
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave ? enter : null;
}
const eyeOf = ({ yaw, pitch, distance, target }) =>
  sum(target, times([Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)], distance));

/** Draws the moment; `coarsely` with fewer dots and without shadows. */
function drawScene(coarsely) {
  const canvas = $('scene'), ratio = Math.min(devicePixelRatio, 2) * (coarsely ? 0.5 : 1);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(x => Math.max(1, Math.round(x * ratio)));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const eye = eyeOf(camera), { state, links } = moment;
  renderer.clear();
  drawn = [];
  const put = (name, pieces, pose, layer, colour, alpha) => pieces.forEach(({ mesh, size, pose: own }) => {
    const world = product(pose, own);
    renderer.add(mesh, layer, world, size, layer === 'solid' ? painted(name, colour) : colour, alpha);
    if (layer === 'solid') drawn.push({ name, mesh, world, size });
  });
  for (const { name, pose, role, placed, colour } of bodies) {
    const hides = options.walls && role === 'wall' && placed.some(piece => parts(piece, eye, camera.target));
    put(name, placed, pose, hides ? 'clear' : 'solid', colours[colour], hides ? 0.1 : 1);
  }
  linkPieces.forEach((pieces, i) => put(robot.links[i].name, pieces, links[i], 'solid', colours[linkKind[i]]));
  objectPieces.forEach((pieces, i) => put(data.objects[i].name, pieces, state.objects[i], 'solid', colours.objects[i % colours.objects.length]));
  if (options.ghosts) {
    data.objects.forEach((object, i) => {
      for (const goal of object.goals ?? []) put('', objectPieces[i], goal, 'clear', colours.goal, 0.28);
      for (const { min, max, z } of object.regions ?? []) {
        const pose = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, z + 0.001, 0, 0, 0, 1];
        renderer.add(renderer.mesh('box', UNIT.box), 'clear', pose, [(max[0] - min[0]) / 2, (max[1] - min[1]) / 2, 0.001], colours.goal, 0.28);
      }
      if (steps.length && Math.hypot(...minus(state.objects[i], data.start.objects[i])) > 0.01) put('', objectPieces[i], data.start.objects[i], 'clear', colours.start, 0.22);
    });
    for (const ghost of ghostLinks.filter(ghost => tools.some(tool => Math.hypot(...minus(ghost[tool], links[tool])) > 0.3))) linkPieces.forEach((pieces, i) => put('', pieces, ghost[i], 'wire', colours.start));
  }
  if (options.closest && !marks.button) {
    const { state: near } = data.why.nearest, poses = closestLinks ??= linkPoses(near.base, near.joints);
    linkPieces.forEach((pieces, i) => put('', pieces, poses[i], 'clear', colours.near, 0.1));
    objectPieces.forEach((pieces, i) => put('', pieces, near.objects[i], 'clear', colours.near, 0.4));
  }
  const reach = camera.distance * 3 + 12;
  renderer.add(renderer.mesh('box', UNIT.box), 'ground', [eye[0], eye[1], -0.003, 0, 0, 0, 1], [reach, reach, 0.001], colours.floor);
  const sight = perspective(ANGLE, width / height, camera.distance * 0.02, camera.distance * 4 + 40);
  const half = clamp(camera.distance * 0.8, 0.6, 8), light = lookAt(sum(camera.target, times(SUN, 12)), camera.target, [0, 1, 0]);
  renderer.frame({
    camera: matrixProduct(sight, lookAt(eye, camera.target, [0, 0, 1])),
    light: matrixProduct(parallel(half, 1, 30), light), eye, sun: SUN, reach,
    shadows: options.shadows && !coarsely ? 1 : 0, edges: options.edges, ...colours,
  }, width, height);
}

