// Signals over time: one plot an output, its residual below, cursors and windows shared.
//
// Colours and dashes are those of the reports: measured in the colour of text, the model in blue,
// the other model dashed in orange, the residual in vermilion. Spans in which the model fails are
// shaded and hatched.

const BAND = 1.96;

function styleOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function inks() {
  return {
    text: styleOf("--text"), muted: styleOf("--muted"), rule: styleOf("--rule"), paper: styleOf("--paper"),
    blue: styleOf("--blue"), orange: styleOf("--orange"), vermilion: styleOf("--vermilion"), faintVermilion: styleOf("--faint-vermilion"), alarm: styleOf("--alarm"),
  };
}

// The answer of the server: a head of JSON, then columns of floats.
export function unpacked(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const time = new Float64Array(head.count);
  head.segments.forEach(([first, start], place) => {
    const end = head.segments[place + 1]?.[0] ?? head.count;
    for (let k = first; k < end; k++) time[k] = start + (k - first) * head.step;
  });
  head.columns.forEach((column, place) => {
    column.values = new Float32Array(buffer, 4 + length + 4 * place * head.count, head.count);
  });
  return { ...head, time };
}

// The first point that is not before a time.
function notBefore(time, t) {
  let from = 0, to = time.length;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (time[middle] < t) from = middle + 1; else to = middle;
  }
  return from;
}

// Drawn behind a plot's lines: spans in which the model fails, and the band of the noise.
function behind(plots, isResidual) {
  return (u) => {
    const { ctx, bbox } = u;
    const ink = inks();
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    if (isResidual) {
      const top = u.valToPos(BAND, "y", true), bottom = u.valToPos(-BAND, "y", true);
      ctx.fillStyle = ink.blue;
      ctx.globalAlpha = 0.16;
      ctx.fillRect(bbox.left, top, bbox.width, bottom - top);
      ctx.globalAlpha = 1;
    }
    for (const span of plots.spans) {
      const from = u.valToPos(span.from, "x", true), to = u.valToPos(span.to, "x", true);
      const width = Math.max(to - from, 2);
      if (from > bbox.left + bbox.width || to < bbox.left) continue;
      ctx.fillStyle = ink.alarm;
      ctx.globalAlpha = 0.13;
      ctx.fillRect(from, bbox.top, width, bbox.height);
      ctx.globalAlpha = 0.8;
      ctx.fillRect(from, bbox.top, width, 3 * devicePixelRatio);
      ctx.globalAlpha = 1;
    }
    ctx.restore();
  };
}

const short = (value) => value == null || Number.isNaN(value) ? "\u2013" : Number(value.toPrecision(4)).toString().replace("-", "\u2212");

export class Plots {
  // `onWindow(from, to)` is told what was brushed; nothing for all.
  constructor(place, onWindow) {
    this.place = place;
    this.onWindow = onWindow;
    this.all = [];
    this.spans = [];
    this.data = null;
    this.sync = uPlot.sync("signals");
    new ResizeObserver(() => this.resize()).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.data && this.show(this.data, this.spans, this.limits));
  }

  // Draws the signals; `limits` is the window, nothing for all.
  show(data, spans, limits) {
    const shape = JSON.stringify(data.columns.map((it) => [it.output, it.role, it.unit]));
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    Object.assign(this, { data, spans, limits });
    if (this.shape === shape + dark && this.all.length) {
      for (const plot of this.all) plot.u.setData([data.time, ...plot.places.map((place) => data.columns[place].values)], false);
    } else {
      this.shape = shape + dark;
      this.build();
    }
    this.zoom(limits);
  }

  zoom(limits) {
    const end = this.data.time[this.data.time.length - 1];
    const [min, max] = limits ?? [this.data.time[0], end];
    for (const { u } of this.all) u.batch(() => { u.setScale("x", { min, max }); });
  }

  build() {
    this.all.forEach(({ u }) => u.destroy());
    this.place.replaceChildren();
    this.all = [];
    const names = [...new Set(this.data.columns.map((it) => it.output))];
    const outputs = [...names.filter((name) => name !== "u"), ...names.filter((name) => name === "u")];
    outputs.forEach((output, number) => {
      const of = (roles) => this.data.columns.map((it, place) => ({ ...it, place })).filter((it) => it.output === output && roles.includes(it.role));
      const last = number === outputs.length - 1;
      if (output === "u") {
        this.plot("u, the input", of(["measured"]), 84, false, last);
      } else {
        this.plot(output, of(["measured", "model", "ghost model"]), 170, false, false);
        this.plot(`residual of ${output}`, of(["residual", "mean residual", "ghost mean residual"]), 120, true, false);
      }
    });
  }

  plot(title, columns, height, isResidual, isLast) {
    const ink = inks();
    const looks = {
      measured: { label: "measured", stroke: ink.text, width: 1 },
      model: { label: "model", stroke: ink.blue, width: 1.4 },
      "ghost model": { label: "other step", stroke: ink.orange, width: 1.4, dash: [7, 4] },
      residual: { label: "residual", stroke: ink.faintVermilion, width: 1 },
      "mean residual": { label: "its mean over 50 ms", stroke: ink.vermilion, width: 2 },
      "ghost mean residual": { label: "mean of the other step", stroke: ink.orange, width: 1.5, dash: [7, 4] },
    };
    // What is compared with lies below.
    const order = ["measured", "ghost model", "model", "residual", "ghost mean residual", "mean residual"];
    columns.sort((a, b) => order.indexOf(a.role) - order.indexOf(b.role));
    const unit = isResidual ? "noise sd" : columns[0].unit;
    const holder = document.createElement("figure");
    holder.className = "signal";
    const caption = document.createElement("figcaption");
    caption.textContent = `${title}${unit ? ` [${unit}]` : ""}`;
    holder.append(caption);
    this.place.append(holder);
    const axis = { stroke: ink.muted, grid: { stroke: ink.rule, width: 1 }, ticks: { stroke: ink.rule, width: 1, size: 4 }, font: "12px system-ui", labelFont: "12px system-ui" };
    const narrow = this.place.clientWidth < 500;
    const u = new uPlot({
      width: Math.max(this.place.clientWidth, 200),
      height: height + (isLast ? 22 : 0),
      pxAlign: 0,
      padding: [6, 10, 0, 0],
      cursor: { sync: { key: "signals", setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
      select: { show: true },
      legend: { show: true, live: true },
      scales: { x: { time: false }, y: { range: (_, min, max) => isResidual ? padded(Math.min(min, -3), Math.max(max, 3)) : padded(min, max) } },
      axes: [
        { ...axis, size: isLast ? 42 : 6, label: isLast ? "time [s]" : undefined, labelSize: 16, values: isLast ? undefined : (_, ticks) => ticks.map(() => "") },
        { ...axis, size: narrow ? 44 : 58, space: 24, values: (_, ticks) => ticks.map(short) },
      ],
      series: [
        { label: "time [s]", value: (_, value) => short(value) },
        ...columns.map((column) => ({ ...looks[column.role], points: { show: false }, value: (_, value) => short(value) })),
      ],
      hooks: {
        drawClear: [behind(this, isResidual)],
        setSelect: [(u) => this.brushed(u)],
        ready: [(u) => u.over.addEventListener("dblclick", () => this.onWindow(null))],
      },
    }, [this.data.time, ...columns.map((it) => this.data.columns[it.place].values)], holder);
    this.sync.sub(u);
    u.root.setAttribute("role", "img");
    u.root.setAttribute("aria-label", `${title} over time; as numbers below the plots`);
    this.all.push({ u, places: columns.map((it) => it.place), height: height + (isLast ? 22 : 0) });
  }

  brushed(u) {
    // Every plot of the group hears of one drag: the first tells the window, and nothing is zoomed
    // before the last has heard of it, or each would cut its pixels out of the window of the one before.
    const { left, width } = u.select;
    if (width < 4 || this.dragged) return;
    this.dragged = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
    setTimeout(() => {
      const window = this.dragged;
      for (const plot of this.all) plot.u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      this.dragged = null;
      this.onWindow(window);
    });
  }

  resize() {
    const width = this.place.clientWidth;
    if (width > 0) this.all.forEach(({ u, height }) => u.width !== width && u.setSize({ width, height }));
  }

  // The view as rows of numbers: least and greatest value of equal parts of the window.
  rows(parts) {
    const { time, columns } = this.data;
    const [from, to] = this.limits ?? [time[0], time[time.length - 1]];
    const shown = columns.filter((it) => !it.role.startsWith("ghost"));
    const head = ["from [s]", ...shown.map((it) => `${it.output} ${it.role} [${it.role === "residual" ? "noise sd" : it.unit}]`)];
    const rows = [];
    for (let part = 0; part < parts; part++) {
      const begin = from + (to - from) * part / parts, end = from + (to - from) * (part + 1) / parts;
      const first = notBefore(time, begin), after = notBefore(time, end);
      if (first >= after) continue;
      const ends = shown.map(({ values }) => {
        let least = Infinity, most = -Infinity;
        for (let k = first; k < after; k++) { if (values[k] < least) least = values[k]; if (values[k] > most) most = values[k]; }
        return least > most ? "\u2013" : `${short(least)} to ${short(most)}`;
      });
      rows.push([short(begin), ...ends]);
    }
    return { head, rows };
  }
}

function padded(min, max) {
  if (min == null || max == null) return [-1, 1];
  const room = (max - min || Math.abs(max) || 1) * 0.05;
  return [min - room, max + room];
}
