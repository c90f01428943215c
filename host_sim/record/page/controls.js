// Slider, playing, and what the page says of its moment.

function makeControls(box) {
  const slider = document.getElementById('time'), play = document.getElementById('play'), speed = document.getElementById('speed');
  const now = document.getElementById('now'), flags = document.getElementById('flags');

  function tell(t) {
    slider.value = t;
    const phase = phaseAt(t), reach = (span.value[1] - span.value[0]) / 150;
    const text = [t.toFixed(2) + ' s', phase ? phase.name : '', ...faultsNear(t, reach).map(reactionTo)].filter(Boolean).join(' · ');
    now.textContent = text;
    slider.setAttribute('aria-valuetext', text);
  }

  slider.min = run.from;
  slider.max = run.to;

  let last = null;  // time of the picture before, while it plays
  function stop() {
    last = null;
    play.textContent = 'Play';
  }
  function step(stamp) {
    if (last === null) return;
    const t = moment.value + (stamp - last) / 1000 * Number(speed.value);
    last = stamp;
    showMoment(t, play);
    if (t >= run.to) stop(); else requestAnimationFrame(step);
  }
  play.addEventListener('click', () => {
    if (last !== null) return stop();
    if (moment.value >= run.to) showMoment(run.from, play);
    play.textContent = 'Pause';
    last = performance.now();
    requestAnimationFrame(step);
  });
  slider.addEventListener('input', () => {
    stop();
    showMoment(Number(slider.value), play);
  });

  const scaled = factor => {
    const half = (span.value[1] - span.value[0]) * factor / 2;
    showSpan(moment.value - half, moment.value + half);
  };
  document.getElementById('closer').addEventListener('click', () => scaled(0.5));
  document.getElementById('farther').addEventListener('click', () => scaled(2));
  document.getElementById('whole').addEventListener('click', showWholeRun);
  document.getElementById('wide').addEventListener('click', event => {
    const wide = document.getElementById('split').classList.toggle('wide');
    event.target.setAttribute('aria-pressed', String(wide));
  });

  for (const fault of run.faults) {
    const flag = flags.appendChild(document.createElement('i'));
    flag.style.left = 100 * (fault.t - run.from) / (run.to - run.from) + '%';
    flag.title = fault.t.toFixed(3) + ' s: ' + reactionTo(fault);
  }
  for (const cell of document.querySelectorAll('td[data-t]')) {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'jump';
    button.title = 'show this moment';
    button.append(...cell.childNodes);
    cell.append(button);
    button.addEventListener('click', () => {
      const t = Number(cell.dataset.t);
      if (t < span.value[0] || t > span.value[1]) showWholeRun();
      showMoment(t, button);
      box.scrollIntoView({block: 'nearest'});
    });
  }
  moment.watch(slider, tell);
  document.querySelectorAll('.live').forEach(element => { element.hidden = false; });
  showMoment(run.from, null);
}

if (document.getElementById('controls')) makeControls(document.getElementById('controls'));
