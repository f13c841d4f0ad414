// Test of a report page by its own data and by events; returns the failures as sentences, and some numbers.
(report) => {
  // Pixels of the plot that are clearly coloured: the frame, the grid and the words are grey, the shades of
  // intervals are faint.
  function colouredPixels(panel, sharpness) {
    const {canvas, drawn: {plot: {x, y, width, height}}} = panel;
    const copy = Object.assign(document.createElement('canvas'), {width: canvas.width, height: canvas.height})
      .getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const {data} = copy.getImageData(x * sharpness, y * sharpness, width * sharpness, height * sharpness);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const least = Math.min(data[i], data[i + 1], data[i + 2]), greatest = Math.max(data[i], data[i + 1], data[i + 2]);
      if (greatest - least > 40) ++count;
    }
    return count;
  }

  // Drags over the middle half of a time panel and clears the selection by a key; also zooms and moves by keys, and clears by a
  // double click, if `all`: each of these draws all pictures.
  function tryTimePanel(panel, report, expect, all) {
    const {picture, canvas, drawn: {plot}, item: {title}} = panel;
    const left = canvas.getBoundingClientRect().left + plot.x;
    const pointer = (type, part) => picture.dispatchEvent(
      new PointerEvent(type, {clientX: left + part * plot.width, button: 0, pointerId: 1, bubbles: true}));
    const press = (key) => canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    const {length} = report.samples;
    const lasts = () => (report.samples.view[1] - report.samples.view[0]) / length;
    pointer('pointerdown', 0.25);
    pointer('pointermove', 0.75);
    expect(panel.section.querySelector('.readout').textContent.includes('UTC'),
      `'${title}' shows no values under the pointer`);
    pointer('pointerup', 0.75);
    expect(Math.abs(lasts() - 0.5) < 0.01, `dragging over half of '${title}' selects ${lasts()} of it`);
    if (all) {
      press('+');
      expect(Math.abs(lasts() - 0.25) < 0.01, `the plus key on '${title}' selects ${lasts()}`);
      press('ArrowRight');
      expect(report.samples.range[0] > 0.375 * length, `the right arrow on '${title}' does not move`);
    }
    press('Escape');
    expect(!report.samples.isFiltered, `Escape on '${title}' does not show all`);
    if (!all) return;
    pointer('pointerdown', 0.1);
    pointer('pointermove', 0.3);
    pointer('pointerup', 0.3);
    picture.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}));
    expect(!report.samples.isFiltered, `a double click on '${title}' does not show all`);
  }

  const few = 20;  // minimum number of points; halves of fewer points may have any size
  const wrong = [];
  const expect = (holds, sentence) => { if (!holds) wrong.push(sentence); };
  const {panels, samples} = report;
  const errors = [];
  window.addEventListener('error', ({message}) => errors.push(message));
  const pixels = () => panels.map((panel) => colouredPixels(panel, report.sharpness));

  const before = report.points, pixelsBefore = pixels();
  panels.forEach((panel, i) => {
    const {title, kind} = panel.item;
    expect(before[i] > 0, `'${title}' has no points`);
    expect(pixelsBefore[i] > Math.min(before[i], 20), `'${title}' is blank: ${pixelsBefore[i]} coloured pixels`);
    expect(panel.canvas.getAttribute('aria-label').length > title.length + 10, `'${title}' has no alternative text`);
    expect(panel.numbers.tBodies[0]?.rows.length > 0, `'${title}' has no numbers`);
    expect(panel.section.querySelector('.caption')?.textContent, `'${title}' has no caption`);
    const svg = new DOMParser().parseFromString(panel.svg(), 'image/svg+xml');
    expect(!svg.querySelector('parsererror'), `the SVG of '${title}' is not XML`);
    expect(svg.querySelectorAll('g path, rect').length > 1 && svg.querySelectorAll('text').length > 3,
      `the SVG of '${title}' is empty`);
    const drawn = kind === 'time' ? 'path' : 'path:not([fill="none"])';
    const isPlot = ['time', 'binned', 'plane', 'pair', 'curves', 'quantiles'].includes(kind);
    expect(!isPlot || [...svg.querySelectorAll('g[clip-path]')].every((group) => group.querySelector(drawn)),
      `a plot of '${title}' has no points`);
    expect(panel.png().length > 5000, `the PNG of '${title}' is empty`);
  });
  for (const {table} of report.tables)
    expect(table.tBodies[0].rows.length === samples.regimes.size + 1, 'a regime table lacks rows');

  report.choose(samples.count ? [samples.position[0], samples.position[samples.count >> 1]] : null);
  const half = report.points, pixelsHalf = pixels();
  expect(!samples.count || report.selection.count === (samples.count >> 1) + 1, 'half of the samples are not selected');
  panels.forEach((panel, i) => {
    const {title, kind} = panel.item;
    const part = half[i] / before[i];
    if (['bars', 'curves', 'dots'].includes(kind)) {
      expect(part === 1, `'${title}' follows a selection of samples that it does not show`);
      expect(panel.whole.checkVisibility(), `'${title}' does not state that it shows all samples`);
    }
    else if (before[i] > Math.max(few, 0.9 * samples.count))
      expect(part > 0.2 && part < 0.8, `selecting half leaves '${title}' ${half[i]} of ${before[i]} points`);
    expect(!half[i] || pixelsHalf[i] > Math.min(half[i], 20), `'${title}' is blank with half of the samples`);
  });

  report.clear();
  expect(!report.selection.from && report.selection.count === samples.count, 'not all is selected after clear');
  expect(String(report.points) === String(before) && String(pixels()) === String(pixelsBefore),
    'clear does not restore the pictures');

  panels.filter(({item}) => item.kind === 'time').forEach((panel, i) => tryTimePanel(panel, report, expect, i === 0));
  const {chips} = report.bar;
  for (const chip of new Set([chips[0], chips[chips.length >> 1], chips[chips.length - 1]].filter(Boolean))) {
    chip.click();
    const inside = samples.regimes.get(chip.textContent).reduce((count, one) => count + one, 0);
    expect(report.selection.count === inside,
      `'${chip.textContent}' selects ${report.selection.count} of its ${inside} samples`);
    chip.click();
  }
  expect(String(report.points) === String(before), 'the names of intervals do not let go of the samples');

  for (const select of document.querySelectorAll('select')) {
    select.value = select.options[select.options.length - 1].value;
    select.dispatchEvent(new Event('change'));
    expect(report.points.every((points) => points > 0), `'${select.value}' is empty on a horizontal axis`);
    select.value = select.options[0].value;
    select.dispatchEvent(new Event('change'));
  }
  const unnamed = [...document.querySelectorAll('button')].filter((button) => !button.textContent.trim());
  expect(unnamed.length === 0, `${unnamed.length} buttons have no words`);
  expect(document.documentElement.scrollWidth <= window.innerWidth, 'the page is wider than its window');
  for (const message of errors) wrong.push(`error: ${message}`);
  return {wrong, panels: panels.length, points: before, dark: report.isDark};
}
