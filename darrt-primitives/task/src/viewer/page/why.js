// ---------------------------------------------------------------- why there is no plan
const element = (tag, more, ...inside) => {
  const made = Object.assign(document.createElement(tag), more);
  made.append(...inside);
  return made;
};
/** The names with the largest sums, and how many there are besides. */
function leading(blocks, side, most) {
  const sums = new Map();
  for (const block of blocks) sums.set(block[side], (sums.get(block[side]) ?? 0) + block.count);
  return [...sums].sort((a, b) => b[1] - a[1]).slice(0, most).map(([name]) => name);
}
const short = count => count < 1000 ? `${count}` : count < 1e6 ? `${(count / 1000).toFixed(count < 1e4 ? 1 : 0)}k` : `${(count / 1e6).toFixed(1)}M`;
/** Who was in whose way how often: a table whose cells are the darker the more often. */
function heatTable(blocks, others) {
  const [rows, columns] = [leading(blocks, 'first', 12), leading(blocks, 'second', 6)];
  const most = Math.max(1, ...blocks.map(({ count }) => count)), table = element('table', { className: 'heat' });
  const head = name => element('th', { scope: 'col' }, markButton(name, [name]));
  table.append(element('tr', {}, element('th', { textContent: '' }), ...columns.map(head)));
  let told = 0;
  for (const row of rows) {
    const cells = columns.map(column => {
      const block = blocks.find(({ first, second }) => first === row && second === column);
      if (!block) return element('td');
      told += block.count;
      const button = markButton(short(block.count), [row, column]);
      button.title = `${row} and ${column}: ${block.count} times`;
      const cell = element('td', {}, button);
      cell.style.setProperty('--share', `${Math.round(100 * Math.sqrt(block.count / most))}%`);
      return cell;
    });
    table.append(element('tr', {}, element('th', { scope: 'row' }, markButton(row, [row])), ...cells));
  }
  const left = blocks.reduce((all, { count }) => all + count, others) - told;
  return [table, element('p', { className: 'quiet', textContent: left ? `and ${short(left)} times others` : '' })];
}
function showWhy() {
  const { why } = data;
  if (!why) return;
  $('why').hidden = false;
  $('headline').textContent = why.headline;
  const reasons = why.causes.map(({ text, bodies, at }) => element('li', {}, markButton(text, bodies ?? [], at)));
  $('causes').append(...reasons.length ? reasons : [element('li', { textContent: 'nothing was found that keeps a plan away' })]);
  $('advice').append(...why.advice.map(text => element('li', { textContent: text })));
  $('advice-title').hidden = !why.advice.length;
  const met = why.blocks ?? [];
  $('heat-title').hidden = !met.length;
  if (met.length) $('heat').append(...heatTable(met, why.other_blocks));
  $('closest').textContent = why.nearest ? `Nearest to the goal: ${why.nearest.to_go_m.toFixed(2)} m still to move, by the planner's distance: “nearest state” below shows where it is` : '';
  $('played').textContent = steps.length ? `The beginning of a plan is played: ${steps.length} ${steps.length === 1 ? 'step' : 'steps'}.` : why.nearest ? 'No way to move an object was found.' : '';
}
