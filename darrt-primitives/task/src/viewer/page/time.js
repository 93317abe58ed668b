// ---------------------------------------------------------------- time
let ghostLinks = [];
/** Goes to a time and shows what is then. */
function seek(time) {
  const base = moment.state.base;
  moment.time = clamp(time, 0, duration);
  [moment.k, moment.u] = locate(moment.time);
  moment.state = stateAt(moment.k, moment.u);
  moment.links = linkPoses(moment.state.base, moment.state.joints);
  if (options.follow) camera.target = sum(camera.target, [moment.state.base[0] - base[0], moment.state.base[1] - base[1], 0]);
  showMoment();
  isStale = true;
}
/** Puts one joint of a robot that no plan moves elsewhere. */
function pose(variable, value) {
  const joints = [...moment.state.joints];
  joints[variable] = value;
  moment.state = { ...moment.state, joints };
  moment.links = linkPoses(moment.state.base, joints);
  showMoment();
  isStale = true;
}
/** Goes to the waypoint or the step before or after. */
function jump(direction, isStep) {
  play(false);
  const { k, u } = moment;
  if (!steps.length) return;
  if (isStep) return seek(direction > 0 ? clock[k + 1] : u > 0.5 || k === 0 ? clock[k] : clock[k - 1]);
  const near = Math.round(u), next = Math.abs(near - u) < 1e-3 ? near + direction : direction > 0 ? Math.ceil(u) : Math.floor(u);
  if (next < 0) return seek(k ? timeOf(k - 1, steps[k - 1].times.length - 2) : 0);
  seek(next >= steps[k].times.length ? clock[k + 1] : timeOf(k, next));
}
function play(on) {
  isPlaying = on && duration > 0;
  if (isPlaying && moment.time >= duration) seek(0);
  $('play').textContent = isPlaying ? '❚❚' : '▶';
  $('play').setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
  isStale = true;
}
function tick(now) {
  if (isPlaying) {
    seek(moment.time + Math.min(now - lastTick, 100) / 1000 * Number($('speed').value));
    if (moment.time >= duration) play(false);
  }
  if (growth.isGrowing) grow(Math.min(now - lastTick, 100));
  // Where drawing is slow, as without a graphics card, what moves is drawn coarsely, and finely once it rests.
  if (isStale) slowFrames = clamp(slowFrames + (now - lastTick > 80 ? 1 : -1), 0, 8);
  lastTick = now;
  // Nothing is drawn while nothing changes: a battery lasts longer.
  if (renderer && !$('stage').hidden && (isStale || (isCoarse && now - lastDrawn > 400))) {
    isCoarse = isStale && slowFrames > 4;
    [isStale, lastDrawn] = [false, now];
    drawScene(isCoarse);
  }
  requestAnimationFrame(tick);
}

