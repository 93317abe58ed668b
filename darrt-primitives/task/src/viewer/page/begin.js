// ---------------------------------------------------------------- beginning
$('title').textContent = document.title = data.why ? `No plan: ${data.title}` : data.title;
$('about').textContent = [data.description, data.note].filter(Boolean).join(' ');
for (const [name, words] of Object.entries(OPTION_WORDS)) {
  const box = Object.assign(document.createElement('input'), { type: 'checkbox', id: 'show-' + name, checked: options[name] });
  const label = $('shown').appendChild(document.createElement('label'));
  label.append(box, ' ' + words);
  box.addEventListener('change', () => setOption(name, box.checked));
}
$('touching').hidden = !steps.length;
if (!$('static-figure').content.firstElementChild) $('tab-figure').hidden = true;
$('time').max = duration || 1;
readColours();
try {
  renderer = new Renderer($('scene'));
  buildScene();
} catch (error) {
  fail(error.message);
}
listen();
showWhy();
showSearch();
ghostLinks = steps.length ? [starts[0], starts.at(-1)].map(s => linkPoses(s.base, s.joints)) : [];
// An address that ends in `#12.5` opens the page at that second.
seek(Number(location.hash.slice(1)) || 0);
setTheme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
setPage(!renderer, innerWidth > 760 || Boolean(data.why));
look('all');
requestAnimationFrame(tick);
/** For scripts: go to a time, draw at once. */
window.viewer = { seek, drawScene, look, camera, duration, moment, locate };
