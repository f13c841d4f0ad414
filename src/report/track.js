// Ground track, in a separate projection: distances from the middle of the track are true.

const earthRadius = 6371;  // km

const radians = (degrees) => degrees * Math.PI / 180;

// Kilometres to the east and the north of a position, along great circles through it.
function projectionAbout(latitude, longitude) {
  const [sin, cos] = [Math.sin(radians(latitude)), Math.cos(radians(latitude))];
  return (lat, lon) => {
    const turn = radians(lon - longitude), s = Math.sin(radians(lat)), c = Math.cos(radians(lat));
    const angle = Math.acos(Math.min(Math.max(sin * s + cos * c * Math.cos(turn), -1), 1));
    const factor = earthRadius * (angle > 1e-9 ? angle / Math.sin(angle) : 1);
    return [factor * c * Math.sin(turn), factor * (cos * s - sin * c * Math.cos(turn))];
  };
}

// Middle of positions on the globe, for any jump of the longitude.
function middleOf(indices, latitudes, longitudes) {
  const sum = [0, 0, 0];
  for (const i of indices) {
    const c = Math.cos(radians(latitudes[i]));
    sum[0] += c * Math.cos(radians(longitudes[i]));
    sum[1] += c * Math.sin(radians(longitudes[i]));
    sum[2] += Math.sin(radians(latitudes[i]));
  }
  const longitude = Math.atan2(sum[1], sum[0]) * 180 / Math.PI;
  return [Math.atan2(sum[2], Math.hypot(sum[0], sum[1])) * 180 / Math.PI, longitude];
}

const degreesText = (degrees, step, [positive, negative]) => {
  const turned = (degrees + 540) % 360 - 180;
  const side = Math.abs(turned) === 180 || turned === 0 ? '' : ` ${turned < 0 ? negative : positive}`;
  return `${number(Math.abs(turned), step)}°${side}`;
};

// Positions of the samples of a track, in kilometres from its middle, and their extent; computed once.
function placesOf(item, samples) {
  return item.places ??= (() => {
    const [lat, lon] = columnsOf(samples, [item.latitude, item.longitude]);
    const places = samples.indices([lat, lon], samples.every);
    const middle = middleOf(places, lat.values, lon.values);
    const project = projectionAbout(...middle);
    const at = new Map(places.map((i) => [i, project(lat.values[i], lon.values[i])]));
    const ends = (axis) => [...at.values()].reduce(([least, greatest], place) =>
      [Math.min(least, place[axis]), Math.max(greatest, place[axis])], [Infinity, -Infinity]);
    return {middle, project, at, east: ends(0), north: ends(1)};
  })();
}

const trackMargins = {left: 58, right: 84, top: 12, bottom: 44};

const trackRoom = 18;  // margin around the track, pixels

function drawTrack(pen, width, height, item, samples, theme) {
  const [lat, lon, shade] = columnsOf(samples, [item.latitude, item.longitude, item.colour]);
  const places = samples.indices([lat, lon], samples.every);
  const found = samples.indices([lat, lon, shade]);
  const box = plotBox(width, height, trackMargins);
  const {middle: [middleLat, middleLon], project, at, east, north} = placesOf(item, samples);
  const centre = [(east[0] + east[1]) / 2, (north[0] + north[1]) / 2];
  const perPixel = Math.max((east[1] - east[0]) / (box.width - 2 * trackRoom), (north[1] - north[0]) / (box.height - 2 * trackRoom), 1e-3);
  const x = (place) => box.x + box.width / 2 + (place[0] - centre[0]) / perPixel;
  const y = (place) => box.y + box.height / 2 - (place[1] - centre[1]) / perPixel;

  // Parallels and meridians, each with its name at the left side or the bottom.
  const span = [box.width * perPixel / 111 / Math.max(Math.cos(radians(middleLat)), 0.05), box.height * perPixel / 111];
  const grid = (isMeridian) => {
    const middle = isMeridian ? middleLon : middleLat, wide = isMeridian ? Math.min(span[0], 359) : span[1];
    const {step, all} = ticks(middle - wide, middle + wide, 2 * wide / (isMeridian ? span[0] : span[1]) * (isMeridian ? box.width / 95 : box.height / 60));
    for (const value of all) {
      if (!isMeridian && Math.abs(value) > 90) continue;
      const path = [];
      for (let part = 0; part <= 40; ++part) {
        const other = isMeridian ? Math.min(Math.max(middleLat - span[1] + part / 20 * span[1], -90), 90)
          : middleLon - Math.min(span[0], 180) + part / 20 * Math.min(span[0], 180);
        const place = isMeridian ? project(other, value) : project(value, other);
        path.push(x(place), y(place));
      }
      pen.clip(box, () => pen.lines([path], theme.grid));
      nameOfLine(path, isMeridian, degreesText(value, step, isMeridian ? ['E', 'W'] : ['N', 'S']));
    }
  };
  const nameOfLine = (path, isMeridian, words) => {
    const side = isMeridian ? box.y + box.height : box.x, other = isMeridian ? 0 : 1;
    for (let n = 2; n < path.length; n += 2) {
      const [from, to] = [path[n - 1 - other], path[n + 1 - other]];
      if ((from - side) * (to - side) > 0 || from === to) continue;
      const part = (side - from) / (to - from);
      const along = path[n - 2 + other] + part * (path[n + other] - path[n - 2 + other]);
      if (isMeridian && along > box.x && along < box.x + box.width) pen.text(along, side + 17, words, small(theme, 'middle'));
      if (!isMeridian && along > box.y && along < box.y + box.height) pen.text(side - 6, along + 4, words, small(theme, 'end'));
      return;
    }
  };
  grid(true);
  grid(false);
  frame(pen, box, theme, NaN);

  const placeOf = (i) => [x(at.get(i)), y(at.get(i))];
  const {range, colours, paint} = shading(item.diverging, shade, samples.indices([lat, lon, shade], samples.every), theme);
  const longest = box.width * perPixel / 4, power = 10 ** Math.floor(Math.log10(longest));
  const bar = power * [5, 2, 1].find((factor) => factor * power <= longest);  // km
  pen.clip(box, () => {
    pen.dots(places.flatMap(placeOf), 1.5, theme.frame, 0.6);
    paint(pen, found, placeOf, 3.5);
    const along = places.filter((_, n) => n % Math.ceil(places.length / 1000) === 0).map(placeOf);
    const taken = [];  // left, right and line of each name
    for (const flight of samples.flights) {
      const first = places.find((i) => i >= flight.first && i < flight.end);
      if (first === undefined) continue;
      const [px, py] = placeOf(first);
      pen.lines([[px - 5, py - 5, px + 5, py - 5, px + 5, py + 5, px - 5, py + 5, px - 5, py - 5]], theme.ink, 1.5);
      const name = samples.flights.length > 1 ? flight.name : 'start';
      const words = `${name} ${clock(samples.time[first], false)}`.trim();
      // A place near the mark that covers the fewest samples of the track and no other name.
      const width = textWidth(words, fontSize), end = box.x + box.width - 2;
      const lefts = [px + 9, px - 9 - width, px - width / 2].map((x) => Math.max(Math.min(x, end - width), box.x + 2));
      const cost = ([left, line]) =>
        along.filter(([x, y]) => x > left - 3 && x < left + width + 3 && y > line - 13 && y < line + 5).length +
        (line < box.y + 12 || line > box.y + box.height - 4 ? along.length : 0) +
        (taken.some(([from, to, at]) => from < left + width && to > left && Math.abs(at - line) < 13) ? along.length : 0);
      const [left, line] = [4, 20, -13, 34, -27, 48, -41, 62, -55].flatMap((down) => lefts.map((left) => [left, py + down]))
        .reduce((best, each) => cost(each) < cost(best) ? each : best);
      if (cost([left, line]) > 0) continue;  // no free place
      taken.push([left, left + width, line]);
      pen.text(left, line, words, {...small(theme), fill: theme.ink, halo: theme.paper});
    }
  });
  // Scale, below the plot and so off the track.
  const base = box.y + box.height + 36, tip = box.x + bar / perPixel;
  pen.lines([[box.x, base - 4, box.x, base, tip, base, tip, base - 4]], theme.ink, 1.25);
  pen.text(tip + 6, base + 2, `${number(bar, bar)} km`, {...small(theme), fill: theme.ink});
  colourBar(pen, box, colours, range, shade, theme);
  return {
    points: found.length,
    plot: box,
    place: (i) => at.has(i) ? {x: x(at.get(i)), y: y(at.get(i))} : {x: NaN, y: NaN},
    alternative: `Track over the ground, ${brief((east[1] - east[0]))} km from west to east and ` +
      `${brief(north[1] - north[0])} km from south to north about ${degreesText(middleLat, 0.01, ['N', 'S'])}, ` +
      `${degreesText(middleLon, 0.01, ['E', 'W'])}, by colour the ${shade.label}`,
    table: statisticsTable(samples, [lat, lon, shade]),
  };
}

pictures.track = drawTrack;
// Height required by the track at this width.
heights.track = (item, samples, width) => {
  const {left, right, top, bottom} = trackMargins;
  const {east, north} = placesOf(item, samples);
  const shape = (north[1] - north[0]) / Math.max(east[1] - east[0], 1e-3);
  const wanted = shape * (width - left - right - 2 * trackRoom) + top + bottom + 2 * trackRoom;
  return Math.round(Math.min(Math.max(wanted, 220), Math.max(430, 0.5 * width)));
};
