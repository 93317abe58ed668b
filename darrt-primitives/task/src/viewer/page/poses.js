'use strict';
const $ = id => document.getElementById(id);
const data = JSON.parse($('data').textContent);
const { robot, steps } = data;

// ---------------------------------------------------------------- poses: [x, y, z, qx, qy, qz, qw]
const HERE = [0, 0, 0, 0, 0, 0, 1];
const sum = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => times(a, 1 / (Math.hypot(...a) || 1));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const shortWay = angle => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

/** `v` turned as the pose says. */
function turned(pose, v) {
  const [, , , x, y, z, w] = pose;
  const t = times(cross([x, y, z], v), 2);
  return sum(sum(v, times(t, w)), cross([x, y, z], t));
}
const moved = (pose, v) => sum(turned(pose, v), pose);
/** The product of two poses. */
function product(a, b) {
  const [ax, ay, az, aw] = a.slice(3), [bx, by, bz, bw] = b.slice(3);
  return [...moved(a, b),
    aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
}
const about = (axis, angle) => [0, 0, 0, ...times(axis, Math.sin(angle / 2)), Math.cos(angle / 2)];
/** Part of the way from one pose to another; over the short arcs between waypoints this is as good as turning evenly. */
function between(a, b, s) {
  const flip = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
  const p = a.map((x, i) => x + ((i < 3 ? b[i] : flip * b[i]) - x) * s);
  const n = Math.hypot(p[3], p[4], p[5], p[6]);
  return p.map((x, i) => i < 3 ? x : x / n);
}

// ---------------------------------------------------------------- where everything is
/** World poses of the links: of all, or only of those that `wanted` names. */
function linkPoses(base, joints, wanted) {
  const poses = [];
  robot.links.forEach((link, i) => {
    if (wanted && !wanted.has(i)) return;
    if (link.parent === null) {
      poses[i] = product([base[0], base[1], 0, 0, 0, 0, 1], about([0, 0, 1], base[2]));
      return;
    }
    let pose = product(poses[link.parent], link.pose);
    if (link.joint) {
      const { kind, axis, variable, multiplier, offset } = link.joint;
      const value = multiplier * joints[variable] + offset;
      pose = product(pose, kind === 'turning' ? about(axis, value) : [...times(axis, value), 0, 0, 0, 1]);
    }
    poses[i] = pose;
  });
  return poses;
}
/** The tool of the hand at work in a step. */
const toolOf = step => step?.tool ?? robot.tool;
/** The tools, and the links above them. */
const tools = robot.tools ?? [robot.tool], toTool = new Set();
for (const tool of tools) for (let i = tool; i !== null; i = robot.links[i].parent) toTool.add(i);

/** Base, joints and objects in step `k`, `u` waypoints from its beginning. */
function stateAt(k, u) {
  if (!steps.length) return data.start;
  const step = steps[k], i = Math.min(Math.floor(u), step.times.length - 2), s = u - i;
  const state = { base: [...starts[k].base], joints: [...starts[k].joints], objects: [...starts[k].objects] };
  if (step.base) {
    const [a, b] = [step.base[i], step.base[i + 1]];
    state.base = [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + shortWay(b[2] - a[2]) * s];
  }
  for (const { variable, values } of step.joints ?? []) {
    const way = values[i + 1] - values[i];
    const { kind, limits } = robot.variables[variable];
    state.joints[variable] = values[i] + (kind === 'turning' && !limits ? shortWay(way) : way) * s;
  }
  for (const { object, poses } of step.objects ?? []) state.objects[object] = between(poses[i], poses[i + 1], s);
  if (step.holds) {
    const tool = linkPoses(state.base, state.joints, toTool)[toolOf(step)];
    state.objects[step.holds.object] = product(tool, step.holds.tool_from_object);
  }
  return state;
}
/** Where each step begins, in space and in time; the last entry of `clock` is the end. */
const starts = [data.start], clock = [0];
steps.forEach((step, k) => {
  starts.push(stateAt(k, step.times.length - 1));
  clock.push(clock[k] + step.times.at(-1));
});
const duration = clock.at(-1);

/** Step and waypoints into it at a time. */
function locate(time) {
  if (!steps.length) return [0, 0];
  let k = 0;
  while (k < steps.length - 1 && time >= clock[k + 1]) k++;
  const at = steps[k].times, t = time - clock[k];
  let low = 0, high = at.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (at[middle] <= t) low = middle; else high = middle;
  }
  return [k, low + clamp((t - at[low]) / (at[high] - at[low] || 1), 0, 1)];
}
/** The time `u` waypoints into step `k`. */
function timeOf(k, u) {
  const at = steps[k].times, i = Math.min(Math.floor(u), at.length - 2);
  return clock[k] + at[i] + (at[i + 1] - at[i]) * (u - i);
}
/** The clearance that was measured nearest to a moment. */
function nearestAt(k, u) {
  const found = steps[k]?.clearance ?? [];
  return found.reduce((best, c) => !best || Math.abs(c.at - u) < Math.abs(best.at - u) ? c : best, null);
}

