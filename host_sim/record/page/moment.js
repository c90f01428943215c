// One moment and one span of time for the whole page: charts, slider and 3D view show the same.

const run = JSON.parse(document.getElementById('run').textContent);
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Tells each watcher but the one that set it.
function shared(value) {
  const watchers = [];
  return {
    value,
    set(next, by) {
      this.value = next;
      for (const watcher of watchers) if (watcher.owner !== by) watcher.show(next);
    },
    watch(owner, show) {
      watchers.push({owner, show});
    },
  };
}

const moment = shared(run.from);
const span = shared([run.from, run.to]);  // that the charts show

const showMoment = (t, by) => moment.set(clamp(t, run.from, run.to), by);

// At least a tenth of a second, within the run.
function showSpan(from, to) {
  const width = clamp(to - from, Math.min(0.1, run.to - run.from), run.to - run.from);
  const start = clamp((from + to - width) / 2, run.from, run.to - width);
  span.set([start, start + width]);
}
const showWholeRun = () => span.set([run.from, run.to]);

const phaseAt = t => run.phases.find(phase => phase.from <= t && t <= phase.to);
const faultsNear = (t, reach) => run.faults.filter(fault => fault.t - reach <= t && t <= fault.last + reach);
const reactionTo = fault => fault.text + (fault.reaction ? ': ' + fault.reaction : '');

// Index of the last of the ascending `times` that is not after `t`; 0 before the first.
function lastBefore(times, t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}
