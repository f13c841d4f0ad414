// One drawing interface for two outputs: a canvas for the screen and PNG, text for SVG.
//
//   rect(x, y, width, height, fill, opacity)
//   lines(paths, stroke, width, dash, opacity)  each path is x, y, x, y, ... in one array
//   dots(xy, size, fill, opacity)          squares around x, y, x, y, ...; one per pixel
//   text(x, y, words, {fill, size, align: start | middle | end, weight, turn: degrees, halo: colour around it})
//   clip(box, draw)                        limits drawing to the box {x, y, width, height}
//   below(height, draw)                    draws `height` further down

const fontFamily = 'system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

const haloWidth = 4;

const measurer = document.createElement('canvas').getContext('2d');

function textWidth(words, size = 12, weight = 400) {
  measurer.font = `${weight} ${size}px ${fontFamily}`;
  return measurer.measureText(words).width;
}

// Dots that fall on one pixel, once.
function distinctDots(xy) {
  const seen = new Set(), distinct = [];
  for (let i = 0; i < xy.length; i += 2) {
    const x = Math.round(xy[i]), y = Math.round(xy[i + 1]);
    const key = x * 65536 + y;
    if (seen.has(key)) continue;
    seen.add(key);
    distinct.push(x, y);
  }
  return distinct;
}

class CanvasPen {
  constructor(context) { this.context = context; }

  rect(x, y, width, height, fill, opacity = 1) {
    this.context.globalAlpha = opacity;
    this.context.fillStyle = fill;
    this.context.fillRect(x, y, width, height);
    this.context.globalAlpha = 1;
  }

  lines(paths, stroke, width = 1, dash = [], opacity = 1) {
    const {context} = this;
    context.globalAlpha = opacity;
    context.beginPath();
    for (const path of paths) {
      context.moveTo(path[0], path[1]);
      for (let i = 2; i < path.length; i += 2) context.lineTo(path[i], path[i + 1]);
    }
    context.strokeStyle = stroke;
    context.lineWidth = width;
    context.lineJoin = 'round';
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  dots(xy, size, fill, opacity = 1) {
    const {context} = this;
    context.globalAlpha = opacity;
    context.fillStyle = fill;
    const points = distinctDots(xy);
    for (let i = 0; i < points.length; i += 2)
      context.fillRect(points[i] - size / 2, points[i + 1] - size / 2, size, size);
    context.globalAlpha = 1;
  }

  text(x, y, words, {fill, size = 12, align = 'start', weight = 400, turn = 0, halo = ''}) {
    const {context} = this;
    context.save();
    context.translate(x, y);
    context.rotate(turn * Math.PI / 180);
    context.font = `${weight} ${size}px ${fontFamily}`;
    context.fillStyle = fill;
    context.textAlign = align === 'middle' ? 'center' : align;
    if (halo) {
      Object.assign(context, {strokeStyle: halo, lineWidth: haloWidth, lineJoin: 'round'});
      context.strokeText(words, 0, 0);
    }
    context.fillText(words, 0, 0);
    context.restore();
  }

  clip({x, y, width, height}, draw) {
    const {context} = this;
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    draw();
    context.restore();
  }

  below(height, draw) {
    this.context.save();
    this.context.translate(0, height);
    draw();
    this.context.restore();
  }
}

function escapeXml(words) {
  return words.replace(/[&<>"']/g, (character) => `&#${character.charCodeAt(0)};`)
      .replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f]/g, '\ufffd');
}

const short = (number) => String(Math.round(number * 100) / 100);

class SvgPen {
  // Drawn in units of `width` x `height`, and shown `shown` pixels wide.
  constructor(width, height, title, shown = width, description = '') {
    this.head = `<svg xmlns="http://www.w3.org/2000/svg" width="${shown}" height="${short(height * shown / width)}" ` +
        `viewBox="0 0 ${width} ${height}" font-family="${escapeXml(fontFamily)}" role="img">\n` +
        `<title>${escapeXml(title)}</title>\n<desc>${escapeXml(description)}</desc>\n`;
    this.parts = [];
    this.clips = 0;
  }

  rect(x, y, width, height, fill, opacity = 1) {
    this.parts.push(`<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" ` +
        `fill="${fill}"${opacity < 1 ? ` fill-opacity="${opacity}"` : ''}/>`);
  }

  lines(paths, stroke, width = 1, dash = [], opacity = 1) {
    const d = paths.map((path) => {
      let words = '';
      for (let i = 0; i < path.length; i += 2) words += `${i ? 'L' : 'M'}${short(path[i])} ${short(path[i + 1])}`;
      return words;
    }).join('');
    if (!d) return;
    this.parts.push(`<path d="${d}" fill="none" stroke="${stroke}" stroke-width="${short(width)}" stroke-linejoin="round"` +
        `${opacity < 1 ? ` stroke-opacity="${opacity}"` : ''}` +
        `${dash.length ? ` stroke-dasharray="${dash.join(' ')}"` : ''}/>`);
  }

  dots(xy, size, fill, opacity = 1) {
    const points = distinctDots(xy);
    let d = '';
    for (let i = 0; i < points.length; i += 2)
      d += `M${short(points[i] - size / 2)} ${short(points[i + 1] - size / 2)}h${size}v${size}h-${size}z`;
    if (!d) return;
    this.parts.push(`<path d="${d}" fill="${fill}"${opacity < 1 ? ` fill-opacity="${opacity}"` : ''}/>`);
  }

  text(x, y, words, {fill, size = 12, align = 'start', weight = 400, turn = 0, halo = ''}) {
    const add = (colours) => this.parts.push(`<text x="${short(x)}" y="${short(y)}" ${colours} font-size="${size}" ` +
        `text-anchor="${align}"${weight === 400 ? '' : ` font-weight="${weight}"`}` +
        `${turn ? ` transform="rotate(${turn} ${short(x)} ${short(y)})"` : ''}>${escapeXml(words)}</text>`);
    // Separate elements: some programs ignore paint-order.
    if (halo) add(`fill="${halo}" stroke="${halo}" stroke-width="${haloWidth}" stroke-linejoin="round" aria-hidden="true"`);
    add(`fill="${fill}"`);
  }

  clip({x, y, width, height}, draw) {
    const id = `inside-${++this.clips}`;
    this.parts.push(`<clipPath id="${id}"><rect x="${short(x)}" y="${short(y)}" width="${short(width)}" ` +
        `height="${short(height)}"/></clipPath>`, `<g clip-path="url(#${id})">`);
    draw();
    this.parts.push('</g>');
  }

  below(height, draw) {
    this.parts.push(`<g transform="translate(0 ${short(height)})">`);
    draw();
    this.parts.push('</g>');
  }

  get svg() { return `${this.head}${this.parts.join('\n')}\n</svg>\n`; }
}
