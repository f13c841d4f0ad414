// Faults of the text on a report page, as sentences: text outside its window, clipped by an ancestor, or over
// other text, for the page and for every picture; shortened text in a picture, and text on the track of a map.
(is_narrow) => {
  const tolerance = 2;  // pixels, by which boxes of characters exceed their marks
  const faults = [];

  // Reports pairs of boxes {left, right, top, bottom, words} that overlap.
  const expectApart = (boxes, where) => {
    boxes.sort((a, b) => a.top - b.top);
    boxes.forEach((a, i) => {
      for (let j = i + 1; j < boxes.length && boxes[j].top < a.bottom - tolerance; ++j) {
        const b = boxes[j];
        const height = Math.min(a.bottom, b.bottom) - b.top;
        const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        if (height > tolerance && width > tolerance) faults.push(`${where}: '${a.words}' and '${b.words}' overlap`);
      }
    });
  };

  const expectInside = ({left, right, top, bottom, words}, width, height, where) => {
    if (left < -tolerance || top < -tolerance || right > width + tolerance || bottom > height + tolerance)
      faults.push(`${where}: '${words}' is clipped`);
  };

  for (const fold of document.querySelectorAll('.fold')) fold.open = true;
  const boxes = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, parent = node.parentElement;
    const unseen = parent.closest('script, style, .spoken, option') || (is_narrow && parent.closest('.list-if-narrow thead'));
    if (!node.data.trim() || !parent.checkVisibility() || unseen) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const {left, right, top, bottom} of range.getClientRects()) {
      const words = node.data.trim().slice(0, 40);
      boxes.push({left, right, top, bottom, words});
      for (let clip = parent; clip !== document.documentElement; clip = clip.parentElement) {
        if (getComputedStyle(clip).overflowX === 'visible') continue;
        const box = clip.getBoundingClientRect();
        if (left < box.left - tolerance || right > box.right + tolerance) faults.push(`page: '${words}' is clipped`);
      }
    }
  }
  expectApart(boxes, 'page');
  if (document.documentElement.scrollWidth > window.innerWidth) faults.push('the page is wider than its window');

  const {text, dots} = CanvasPen.prototype;
  for (const panel of pcorReport.panels) {
    const drawn = [], track = [];
    CanvasPen.prototype.dots = function (xy, size, ...more) {
      const here = this.context.getTransform();
      for (let i = 0; i < xy.length; i += 2) track.push(here.transformPoint({x: xy[i], y: xy[i + 1]}));
      dots.call(this, xy, size, ...more);
    };
    CanvasPen.prototype.text = function (x, y, words, style) {
      const {size = 12, align = 'start', weight = 400, turn = 0} = style;
      const width = textWidth(words, size, weight);
      const begin = {start: 0, middle: -width / 2, end: -width}[align];
      const turned = this.context.getTransform().translate(x, y).rotate(turn);
      const corners = [[begin, -0.75 * size], [begin + width, 0.2 * size]].map(([u, v]) => turned.transformPoint({x: u, y: v}));
      const [xs, ys] = [corners.map((corner) => corner.x), corners.map((corner) => corner.y)];
      drawn.push({left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys), words});
      text.call(this, x, y, words, style);
    };
    panel.draw();
    Object.assign(CanvasPen.prototype, {text, dots});
    const where = `picture '${panel.item.title}'`;
    for (const box of drawn) {
      const {left, right, top, bottom, words} = box;
      expectInside(box, panel.canvas.width, panel.canvas.height, where);
      if (words.includes('…')) faults.push(`${where}: '${words}' is shortened`);
      if (panel.item.kind === 'track' && track.some(({x, y}) => x > left && x < right && y > top && y < bottom))
        faults.push(`${where}: '${words}' is on the track`);
    }
    expectApart(drawn, where);
  }
  return faults;
}
