// ---------------------------------------------------------------- solids
/** Triangles with normals that are smooth but for creases, and the creases as lines. */
function solid(points, triangles) {
  const key = new Map(), weld = points.map(p => {
    const name = p.map(x => Math.round(x * 1e5)).join();
    if (!key.has(name)) key.set(name, key.size);
    return key.get(name);
  });
  const faces = [], of = new Map(), edges = new Map(), put = (map, at, what) => map.has(at) ? map.get(at).push(what) : map.set(at, [what]);
  for (const corners of triangles) {
    const [a, b, c] = corners.map(i => weld[i]);
    if (a === b || b === c || c === a) continue;
    const normal = cross(minus(points[corners[1]], points[corners[0]]), minus(points[corners[2]], points[corners[0]]));
    const face = { corners, weld: [a, b, c], normal, unit: unit(normal) };
    faces.push(face);
    [a, b, c].forEach((v, i) => {
      put(of, v, face);
      const w = [a, b, c][(i + 1) % 3];
      put(edges, v < w ? `${v},${w}` : `${w},${v}`, { face, ends: [corners[i], corners[(i + 1) % 3]] });
    });
  }
  const crease = (f, g) => dot(f.unit, g.unit) < 0.8;
  const vertices = [], lines = [];
  for (const face of faces) {
    face.corners.forEach((corner, i) => {
      const near = of.get(face.weld[i]).filter(other => !crease(face, other));
      vertices.push(...points[corner], ...unit(near.reduce((n, other) => sum(n, other.normal), [0, 0, 0])));
    });
  }
  for (const sides of edges.values()) {
    if (sides.length !== 2 || crease(sides[0].face, sides[1].face)) sides[0].ends.forEach(i => lines.push(...points[i]));
  }
  const extent = pick => [0, 1, 2].map(i => points.reduce((m, p) => pick(m, p[i]), points[0][i]));
  return { vertices, lines, low: extent(Math.min), high: extent(Math.max) };
}
/** A profile [radius, z] turned about z. */
function lathe(profile, count) {
  const points = [], triangles = [];
  profile.forEach(([r, z]) => {
    for (let i = 0; i < count; i++) points.push([r * Math.cos(2 * Math.PI * i / count), r * Math.sin(2 * Math.PI * i / count), z]);
  });
  for (let row = 0; row + 1 < profile.length; row++) {
    for (let i = 0; i < count; i++) {
      const [a, b] = [row * count + i, row * count + (i + 1) % count];
      triangles.push([a, a + count, b + count], [a, b + count, b]);
    }
  }
  return solid(points, triangles);
}
const threes = list => Array.from({ length: list.length / 3 }, (_, i) => list.slice(3 * i, 3 * i + 3));
const mesh = (numbers, corners) => solid(threes(numbers), threes(corners));
const UNIT = {
  box: () => mesh([0, 1, 2, 3, 4, 5, 6, 7].flatMap(i => [i & 1, i >> 1 & 1, i >> 2].map(b => 2 * b - 1)),
    [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5]),
  sphere: () => lathe(Array.from({ length: 13 }, (_, i) => [Math.sin(Math.PI * i / 12), Math.cos(Math.PI * i / 12)]), 24),
  cylinder: () => lathe([[0, 1], [1, 1], [1, -1], [0, -1]], 36),
};
/** A part as pieces: a mesh, its pose in the part's owner, and a size. */
function pieces({ shape, pose }) {
  const piece = (name, make, size, z = 0) => ({ mesh: renderer.mesh(name, make), pose: product(pose, [0, 0, z, 0, 0, 0, 1]), size });
  const { radius: r, length: l } = shape;
  switch (shape.kind) {
    case 'box': return [piece('box', UNIT.box, times(shape.size, 0.5))];
    case 'sphere': return [piece('sphere', UNIT.sphere, [r, r, r])];
    case 'cylinder': return [piece('cylinder', UNIT.cylinder, [r, r, l / 2])];
    case 'capsule': return [piece('cylinder', UNIT.cylinder, [r, r, l / 2]), ...[-l / 2, l / 2].map(z => piece('sphere', UNIT.sphere, [r, r, r], z))];
    case 'lathe': return [piece(JSON.stringify(shape), () => lathe(shape.profile, 48), [1, 1, 1])];
    case 'mesh': return [piece(JSON.stringify(shape), () => mesh(shape.vertices, shape.triangles), [1, 1, 1])];
    default: throw new Error(`shape of unknown kind: ${shape.kind}`);
  }
}

