// The charts, by uPlot, in the place of the drawings that show without scripts and in print.

const charts = [];

// Rows for uPlot: one column of times, one of values each series; a gap where a series has no sample at a time of another.
function tableOf(chart) {
  const used = [...new Set(chart.series.map(series => series.t))];
  const tables = used.map(t => [run.times[t], ...chart.series.filter(series => series.t === t).map(series => series.v)]);
  if (used.length === 1) return {rows: tables[0], series: chart.series};
  return {rows: uPlot.join(tables), series: used.flatMap(t => chart.series.filter(series => series.t === t))};
}

// Four digits of the largest value.
function decimalsOf(series) {
  let largest = 0;
  for (const each of series) for (const value of each.v) largest = Math.max(largest, Math.abs(value ?? 0));
  return largest > 0 ? clamp(3 - Math.floor(Math.log10(largest)), 0, 6) : 0;
}

// Phases as dotted lines, faults as lines with a flag; one that came again is a bar to its last time.
function drawMarks(plot) {
  const {ctx, bbox} = plot, ratio = devicePixelRatio;
  const x = t => Math.round(plot.valToPos(t, 'x', true));
  const upright = t => {
    ctx.beginPath();
    ctx.moveTo(x(t), bbox.top);
    ctx.lineTo(x(t), bbox.top + bbox.height);
    ctx.stroke();
  };
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = ratio;
  ctx.strokeStyle = colour('--accent');
  ctx.setLineDash([ratio, 4 * ratio]);
  for (const phase of run.phases) upright(phase.from);
  ctx.setLineDash([]);
  ctx.strokeStyle = ctx.fillStyle = colour('--bad');
  for (const fault of run.faults) {
    upright(fault.t);
    ctx.fillRect(x(fault.t), bbox.top, Math.max(7 * ratio, x(fault.last) - x(fault.t)), 5 * ratio);
  }
  ctx.restore();
}

// Of the series that are shown, dotted in their colours.
function drawLimits(plot, series) {
  const {ctx, bbox} = plot, ratio = devicePixelRatio;
  ctx.save();
  ctx.lineWidth = ratio;
  ctx.globalAlpha = 0.7;
  ctx.setLineDash([2 * ratio, 3 * ratio]);
  series.forEach((each, index) => {
    if (!plot.series[index + 1].show) return;
    ctx.strokeStyle = colour('--c' + each.colour);
    for (const limit of limitsOf(each)) {
      const y = Math.round(plot.valToPos(limit, 'y', true));
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
  });
  ctx.restore();
}

const limitsOf = series => series.v.some(value => value != null) ? series.limits.filter(limit => limit != null) : [];

// A finger's drag sideways is a mouse's; up and down it scrolls the page.
function takeTouch(plot) {
  let held = false, last = 0;
  const forward = (kind, event, target) => {
    // uPlot takes a drag's move without a movement for one that the browser made up.
    target.dispatchEvent(new MouseEvent(kind, {clientX: event.clientX, clientY: event.clientY, movementX: event.clientX - last, button: 0, bubbles: true}));
    last = event.clientX;
  };
  plot.over.style.touchAction = 'pan-y';
  plot.over.addEventListener('pointerdown', event => {
    if (event.pointerType !== 'touch' || !event.isPrimary) return;
    held = true;
    forward('mousemove', event, plot.over);
    forward('mousedown', event, plot.over);
  });
  plot.over.addEventListener('pointermove', event => {
    if (held && event.isPrimary) forward('mousemove', event, plot.over);
  });
  const release = event => {
    if (!held || !event.isPrimary) return;
    held = false;
    if (event.type === 'pointercancel') plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    forward('mouseup', event, document);
  };
  plot.over.addEventListener('pointerup', release);
  plot.over.addEventListener('pointercancel', release);
}

// The legend's names switch their lines; uPlot has that for the mouse alone.
function takeKeys(plot) {
  plot.root.querySelectorAll('.u-legend .u-series th').forEach((name, index) => {
    if (index === 0) return;
    name.tabIndex = 0;
    name.setAttribute('role', 'button');
    name.setAttribute('aria-pressed', 'true');
    name.addEventListener('click', () => name.setAttribute('aria-pressed', String(plot.series[index].show)));
    name.addEventListener('keydown', event => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      name.click();
    });
  });
}

// The cursor where the page's moment is; none where that is not shown.
function placeCursor(plot) {
  const t = moment.value;
  const inside = span.value[0] <= t && t <= span.value[1];
  plot.setCursor(inside ? {left: plot.valToPos(t, 'x'), top: 0} : {left: -10, top: -10}, false);
}

function makeChart(figure, chart) {
  const {rows, series} = tableOf(chart);
  const decimals = decimalsOf(series);
  const axis = {stroke: () => colour('--soft'), grid: {stroke: () => colour('--line'), width: 1}, ticks: {stroke: () => colour('--line'), width: 1}};
  const size = () => ({width: Math.max(240, figure.clientWidth), height: figure.clientWidth < 480 ? 150 : 190});
  const limits = series.flatMap(limitsOf);
  // uPlot's own range, and the limits within it.
  const range = (_, low, high) => uPlot.rangeNum(Math.min(low, ...limits), Math.max(high, ...limits), 0.1, true);
  const plot = new uPlot({
    ...size(),
    scales: {x: {time: false, auto: false, min: span.value[0], max: span.value[1]}, ...(limits.length ? {y: {range}} : {})},
    axes: [{...axis, size: 34}, {...axis, size: 58}],
    cursor: {
      y: false,
      points: {size: 6, fill: (_, index) => `var(--c${series[index - 1].colour})`, stroke: () => 'transparent'},
      drag: {x: true, y: false, setScale: false},
      bind: {
        mousemove: (self, _, follow) => event => {
          follow(event);
          if (self.cursor.left >= 0) showMoment(self.posToVal(self.cursor.left, 'x'), self);
        },
        mouseleave: (self, _, follow) => event => {
          follow(event);
          placeCursor(self);
        },
        dblclick: () => () => showWholeRun(),
      },
    },
    legend: {markers: {stroke: (_, index) => index > 0 ? `var(--c${series[index - 1].colour})` : '', dash: (_, index) => index > 0 && series[index - 1].dashed ? 'dotted' : 'solid'}},
    series: [{label: 't', value: (_, t) => t == null ? '–' : t.toFixed(3) + ' s'},
      ...series.map(each => ({
        label: each.name, stroke: () => colour('--c' + each.colour), width: 1.5, dash: each.dashed ? [5, 4] : undefined,
        points: {show: false}, value: (_, value) => value == null ? '–' : value.toFixed(decimals).replace(/^-(0\.?0*)$/, '$1'),
      }))],
    hooks: {
      drawAxes: [drawMarks, self => drawLimits(self, series)],
      draw: [placeCursor],  // scale and size are new only now
      setSelect: [self => {
        const {left, width} = self.select;
        self.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
        if (width >= 4) showSpan(self.posToVal(left, 'x'), self.posToVal(left + width, 'x'));
      }],
    },
  }, rows, figure);
  figure.classList.add('lively');
  plot.root.setAttribute('role', 'group');
  plot.root.setAttribute('aria-label', chart.title + ' over time, ' + chart.unit);
  takeTouch(plot);
  takeKeys(plot);
  moment.watch(plot, () => placeCursor(plot));
  span.watch(plot, ([min, max]) => plot.setScale('x', {min, max}));
  new ResizeObserver(() => {
    const next = size();
    if (next.width !== plot.width || next.height !== plot.height) plot.setSize(next);
  }).observe(figure);
  charts.push(plot);
}

document.querySelectorAll('figure[data-chart]').forEach(figure => {
  const chart = run.charts[Number(figure.dataset.chart)];
  if (chart.series.some(series => series.v.some(value => value != null))) makeChart(figure, chart);
});
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => charts.forEach(plot => plot.redraw(false, true)));
