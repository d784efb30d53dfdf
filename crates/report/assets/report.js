// Turns every <figure data-chart> below an element into a uPlot chart. All numbers come from one result.
// A report page draws the result that it carries; the panel draws what it has been sent, and removes it again.
globalThis.drawFigures = (root, result) => {
  "use strict";
  const MOST_TABLE_ROWS = 400;
  const POWERS = [-1000, -100, -10, -1, 0, 1, 10, 100, 1000];
  const charts = [];

  const keys = (path) => path.split("/").slice(1);
  const follow = (place, path) => keys(path).reduce((at, key) => (at == null ? null : at[key]), place);

  /** The value at a JSON pointer; with `*` in it, one value per row of the array before the star. */
  function column(pointer) {
    const [head, tail] = pointer.split("/*");
    const rows = follow(result, head);
    return tail === undefined ? rows : (rows || []).map((row) => follow(row, tail) ?? null);
  }

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const withUnit = (axis) => (axis.unit ? `${axis.label} (${axis.unit})` : axis.label);

  function shown(value) {
    if (value == null) return "–";
    const size = Math.abs(value);
    const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(2) : String(+value.toPrecision(4));
    return text.replace("-", "−");
  }

  /** x and y of one series, after its filter. */
  function points(chart, series) {
    let y = column(series.from);
    if (series.percent) y = y.map((value) => (value == null ? null : 100 * value));
    let x = chart.x.labels ? y.map((_, row) => row) : column(series.x || chart.x.from);
    if (series.where) {
      const chosen = column(series.where.from).map((value) => value === series.where.is);
      if (series.where.gaps) {
        y = y.map((value, row) => (chosen[row] ? value : null));
      } else {
        x = x.filter((_, row) => chosen[row]);
        y = y.filter((_, row) => chosen[row]);
      }
    }
    if (chart.y.scale === "log") y = y.map((value) => (value > 0 ? value : null));
    return chart.x.labels ? [x, y] : ascending(x, y);
  }

  /** Rows in the order of x; rows without an x are left out. */
  function ascending(x, y) {
    const rows = [...x.keys()].filter((row) => x[row] != null);
    if (rows.length === x.length && rows.every((row) => row === 0 || x[row] >= x[row - 1])) return [x, y];
    rows.sort((a, b) => x[a] - x[b]);
    return [rows.map((row) => x[row]), rows.map((row) => y[row])];
  }

  const same = (a, b) => a.length === b.length && a.every((value, row) => value === b[row]);

  function table(chart) {
    const parts = chart.series.map((series) => points(chart, series));
    const aligned = parts.every(([x]) => same(x, parts[0][0]));
    const data = aligned ? [parts[0][0], ...parts.map(([, y]) => y)] : uPlot.join(parts);
    for (const limit of chart.limits || []) {
      const level = column(limit.from);
      data.push(data[0].map(() => level));
      if (limit.both) data.push(data[0].map(() => -level));
    }
    return data;
  }

  function bars(chart, member, members) {
    const width = 0.84 / members;
    const each = (make) => ({ unit: 1, values: (u, index, from, to) => u.data[0].map(make) });
    return uPlot.paths.bars({
      disp: { x0: each((x) => x - 0.42 + member * width), size: each(() => width * 0.92) },
    });
  }

  function drawn(chart) {
    const barred = chart.series.filter((series) => series.kind === "bars");
    return chart.series.map((series) => {
      const stroke = colour(series.color);
      const made = {
        label: series.label, stroke, width: series.width || 2, dash: series.dash, auto: !series.outside_scale,
        spanGaps: !(series.where && series.where.gaps), value: (u, value) => shown(value), points: { show: false },
      };
      if (series.kind === "points") Object.assign(made, { paths: () => null, points: { show: true, size: 6, fill: stroke, width: 0 } });
      if (series.kind === "marked") made.points = { show: true, size: 8, fill: stroke };
      if (series.kind === "bars") {
        Object.assign(made, { fill: stroke, width: 0, paths: bars(chart, barred.indexOf(series), barred.length) });
      }
      return made;
    });
  }

  /** Limits as dashed lines; where a limit has both signs, the band between is filled. */
  function limited(chart, first) {
    const series = [];
    const bands = [];
    for (const limit of chart.limits || []) {
      const line = (label) => ({
        label, stroke: colour("limit"), dash: [6, 4], width: 1.25, points: { show: false }, value: (u, value) => shown(value),
      });
      const at = first + series.length;
      series.push(line(limit.label));
      if (limit.both) {
        series.push({ ...line(`− ${limit.label}`), class: "silent" });
        bands.push({ series: [at, at + 1], fill: colour("inside") });
      }
    }
    return { series, bands };
  }

  function axes(chart, font) {
    const base = {
      stroke: colour("ink-2"), font, labelFont: font, labelGap: 4,
      grid: { stroke: colour("rule"), width: 1 }, ticks: { stroke: colour("rule"), width: 1, size: 5 },
    };
    const rem = parseFloat(font);
    const ticks = (u, values, axis, space, step) => {
      const labels = values.map((value) => (value == null ? "" : shown(value)));
      const told = labels.filter((label) => label !== "");
      if (new Set(told).size === told.length || !(step > 0)) return labels;
      const digits = Math.min(9, Math.max(0, Math.ceil(-Math.log10(step))));
      return values.map((value) => (value == null ? "" : value.toFixed(digits)));
    };
    // As wide as its longest label: half an em a digit, beside the axis' own name.
    const wide = (u, values) => Math.max(4.4, 1.9 + 0.5 * Math.max(0, ...(values ?? []).map((value) => value.length))) * rem;
    const x = { ...base, label: withUnit(chart.x), labelSize: 1.9 * rem, size: 2.4 * rem, values: ticks };
    if (chart.x.labels) {
      Object.assign(x, {
        splits: () => chart.x.labels.map((_, row) => row), values: (u, rows) => rows.map((row) => chart.x.labels[row] ?? ""),
        rotate: chart.x.labels.length > 8 ? 62 : 0, grid: { show: false },
      });
      if (x.rotate) x.size = 5.6 * rem;
    }
    const y = { ...base, label: withUnit(chart.y), labelSize: 1.9 * rem, size: wide, values: ticks };
    if (chart.y.scale === "asinh") y.splits = (u, axis, from, to) => POWERS.filter((power) => power >= from && power <= to);
    return [x, y];
  }

  /** The next 1, 2 or 5 times a power of ten, down or up. */
  function snapped(x, up) {
    const power = 10 ** Math.floor(Math.log10(x));
    const steps = [1, 2, 5, 10];
    const fits = up ? steps.find((step) => step * power >= x) : steps.findLast((step) => step * power <= x);
    return (fits ?? 1) * power;
  }

  function scales(chart) {
    const y = { linear: {}, asinh: { distr: 4, asinh: chart.y.linear_below || 1 }, log: { distr: 3 } }[chart.y.scale];
    if (chart.y.scale === "linear" && chart.y.from_zero) y.range = (u, from, to) => [0, Math.max(to, 0) * 1.08 || 1];
    if (chart.y.scale === "asinh") y.range = (u, from, to) => [Math.min(from, -1) * 1.3, Math.max(to, 1) * 1.3];
    if (chart.y.scale === "log") y.range = (u, from, to) => (from == null ? [0.1, 1] : [snapped(from, false), snapped(to, true)]);
    const x = { time: false };
    const scattered = chart.series.every((series) => series.kind === "points");
    if (scattered) x.range = (u, from, to) => [from - 0.03 * (to - from || 1), to + 0.03 * (to - from || 1)];
    if (chart.x.labels) x.range = (u, from, to) => (from === to || from == null ? [-0.6, chart.x.labels.length - 0.4] : [Math.max(from, 0) - 0.6, Math.min(to, chart.x.labels.length - 1) + 0.6]);
    return { x, y };
  }

  function options(chart, data, box) {
    // uPlot takes whole pixels only.
    const font = `${Math.round(0.8 * parseFloat(getComputedStyle(document.documentElement).fontSize))}px system-ui, sans-serif`;
    const limits = limited(chart, 1 + chart.series.length);
    return {
      ...size(box, chart), scales: scales(chart), axes: axes(chart, font), bands: limits.bands,
      series: [{ label: withUnit(chart.x), value: (u, value) => (chart.x.labels ? chart.x.labels[value] ?? "–" : shown(value)) }, ...drawn(chart), ...limits.series],
      cursor: { drag: { x: true, y: false }, focus: { prox: 24 }, sync: chart.group ? { key: chart.group } : undefined },
      focus: { alpha: 0.35 }, legend: { live: true },
    };
  }

  const rem = () => parseFloat(getComputedStyle(document.documentElement).fontSize);
  /** Classes keep room for their names; on a narrow screen the figure then scrolls sideways. */
  const least = (chart) => (chart.x.labels ? (5 + 1.7 * chart.x.labels.length) * rem() : 200);
  const size = (box, chart) => ({ width: Math.max(least(chart), box.clientWidth), height: Math.round((chart.height_rem || 16) * rem()) });

  function build(entry) {
    if (entry.plot) entry.plot.destroy();
    entry.plot = new uPlot(options(entry.chart, entry.data, entry.box), entry.data, entry.box);
  }

  function zoomOut({ plot, data }) {
    plot.setScale("x", { min: data[0][0], max: data[0][data[0].length - 1] });
  }

  /** Arrow keys move the read-out, plus and minus zoom, Escape shows everything again. */
  function keyboard(entry) {
    entry.box.addEventListener("keydown", (event) => {
      const { plot, data } = entry;
      const at = plot.cursor.idx ?? 0;
      const move = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10 }[event.key];
      const factor = { "+": 0.5, "-": 2 }[event.key];
      if (move) {
        const x = data[0][Math.min(Math.max(at + move, 0), data[0].length - 1)];
        plot.setCursor({ left: plot.valToPos(x, "x"), top: plot.over.clientHeight / 2 });
      } else if (factor) {
        const half = (factor * (plot.scales.x.max - plot.scales.x.min)) / 2;
        plot.setScale("x", { min: Math.max(data[0][at] - half, data[0][0]), max: Math.min(data[0][at] + half, data[0][data[0].length - 1]) });
      } else if (event.key === "Escape") zoomOut(entry);
      else return;
      event.preventDefault();
    });
  }

  /** The numbers behind a figure, for the part that is in view. */
  function numbers(entry, holder) {
    const { chart, data, plot } = entry;
    const inView = [...data[0].keys()].filter((row) => data[0][row] >= plot.scales.x.min && data[0][row] <= plot.scales.x.max);
    const head = [withUnit(chart.x), ...chart.series.map((s) => (chart.y.unit ? `${s.label} (${chart.y.unit})` : s.label)), ...(chart.limits || []).map((l) => l.label)];
    const columns = head.length;
    const made = document.createElement("table");
    const add = (parent, name, text, scope) => {
      const cell = parent.appendChild(document.createElement(name));
      cell.textContent = text;
      if (scope) cell.scope = scope;
    };
    const top = made.createTHead().insertRow();
    head.forEach((text) => add(top, "th", text, "col"));
    const body = made.createTBody();
    for (const row of inView.slice(0, MOST_TABLE_ROWS)) {
      const line = body.insertRow();
      add(line, "th", chart.x.labels ? chart.x.labels[row] : shown(data[0][row]), "row");
      for (let k = 1; k < columns; k += 1) add(line, "td", shown(data[k][row]));
    }
    holder.replaceChildren(made);
    if (inView.length > MOST_TABLE_ROWS) {
      const note = holder.appendChild(document.createElement("p"));
      note.textContent = `The first ${MOST_TABLE_ROWS} of ${inView.length} rows in view; zoom in for others. The embedded result holds all.`;
    }
  }

  function start(figure) {
    const chart = JSON.parse(figure.dataset.chart);
    const entry = { figure, chart, box: figure.querySelector(".plot"), data: table(chart), plot: null };
    charts.push(entry);
    // More classes than half a page has room for take the whole of it.
    figure.classList.toggle("across", least(chart) > entry.box.clientWidth && entry.box.clientWidth > 0);
    build(entry);
    keyboard(entry);
    figure.querySelector(".reset").addEventListener("click", () => zoomOut(entry));
    const details = figure.querySelector("details");
    details.addEventListener("toggle", () => details.open && numbers(entry, details.querySelector(".numbers")));
    const fit = () => entry.box.clientWidth === 0 || size(entry.box, chart).width === entry.plot.width || entry.plot.setSize(size(entry.box, chart));
    entry.observer = new ResizeObserver(() => requestAnimationFrame(fit));
    entry.observer.observe(entry.box);
  }

  /** Draws the figures whose description names a part of the result that is another one now. */
  function redraw(path) {
    for (const entry of charts.filter(({ figure }) => figure.dataset.chart.includes(`"${path}`))) {
      entry.data = table(entry.chart);
      build(entry);
    }
  }

  /** Paper has its own width and its own colours: figures are drawn anew for it, and again for the screen. */
  function drawOn(paper) {
    document.documentElement.classList.toggle("on-paper", paper);
    charts.forEach(build);
  }
  const toPaper = () => drawOn(true);
  const toScreen = () => drawOn(false);

  function remove() {
    window.removeEventListener("beforeprint", toPaper);
    window.removeEventListener("afterprint", toScreen);
    dark.removeEventListener("change", rebuild);
    window.removeEventListener("dppxchange", rebuild);
    for (const { observer, plot } of charts) {
      observer.disconnect();
      plot.destroy();
    }
  }

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const rebuild = () => charts.forEach(build);
  root.querySelectorAll("figure[data-chart]").forEach(start);
  dark.addEventListener("change", rebuild);
  window.addEventListener("beforeprint", toPaper);
  window.addEventListener("afterprint", toScreen);
  // Another screen, another pixel ratio: text and lines are measured anew.
  window.addEventListener("dppxchange", rebuild);
  return { count: charts.length, redraw, remove };
};

{
  const embedded = document.getElementById("result");
  if (embedded) document.documentElement.dataset.charts = String(globalThis.drawFigures(document, JSON.parse(embedded.textContent)).count);
}
