// The cloud and the robot in 3D, at the page's moment.

// At `t`, between the samples around it.
function coordinatesAt(motion, t) {
  const times = run.times[motion.t], i = lastBefore(times, t), j = Math.min(i + 1, times.length - 1);
  const share = j > i ? clamp((t - times[i]) / (times[j] - times[i]), 0, 1) : 0;
  return motion.coordinates.map(({v}) => v[i] + (v[j] - v[i]) * share);
}

// base_from_part of each part.
function posesAt(motion, t) {
  const at = coordinatesAt(motion, t), poses = [];
  for (const part of motion.parts) {
    let pose = product(part.parent < 0 ? identity : poses[part.parent], part.at);
    if (part.by >= 0) pose = product(pose, part.slides ? shifted(part.axis, at[part.by]) : turned(part.axis, at[part.by]));
    poses.push(pose);
  }
  return poses;
}

// Blue behind the plane, grey on it, red before it; what stands proud from violet to yellow. report_cloud.cpp has the same scale.
function cloudColour(distance_mm) {
  const mix = (a, b, share) => packed(...a.map((low, i) => low + (b[i] - low) * clamp(share, 0, 1)));
  const on = [150, 160, 168];
  if (distance_mm > 6) return mix([150, 70, 220], [255, 224, 70], (distance_mm - 6) / 114);
  return distance_mm < 0 ? mix(on, [58, 134, 255], -distance_mm / 6) : mix(on, [255, 92, 80], distance_mm / 6);
}

// base64 of little-endian int16 x, y, z in steps of 0.05 mm, in the plane's frame.
function readPoints() {
  const raw = atob(document.getElementById('points')?.textContent ?? ''), points = new Float32Array(raw.length / 2 | 0);
  for (let i = 0; i < points.length; ++i) points[i] = (raw.charCodeAt(2 * i) | raw.charCodeAt(2 * i + 1) << 8) << 16 >> 16;
  return points.map(step => step / 20000);
}

function makeStage(box) {
  const canvas = box.querySelector('canvas'), raster = new Raster(canvas), motion = run.motion, view = run.view;
  const points = readPoints(), paints = new Uint32Array(points.length / 3);
  for (let i = 0; i < paints.length; ++i) paints[i] = cloudColour(1000 * points[3 * i + 2]);
  const shown = {cloud: true, robot: true, controls: true, panel: points.length === 0, vehicle: false};
  const place = document.getElementById('tool-place');
  let yaw = view.yaw, pitch = view.pitch, zoom = 1, asked = false;

  function drawCloud(eye, scale) {
    const size = zoom > 2 ? 3 : 2;
    for (let i = 0; i < paints.length; ++i) {
      const [x, y, z] = placed(eye, points[3 * i], points[3 * i + 1], points[3 * i + 2]);
      raster.dot(Math.round(raster.width / 2 + scale * x), Math.round(raster.height / 2 - scale * y), z * scale, size, paints[i]);
    }
  }

  function drawRobot(eye, scale) {
    const poses = posesAt(motion, moment.value), from_base = product(eye, view.from_base);
    motion.parts.forEach((part, i) => {
      if (!shown[part.group]) return;
      for (const {v, f, c} of part.solids) raster.solid(poses[i], from_base, scale, v, f, c);
    });
    const tool = placed(poses[motion.tool.part], ...motion.tool.at);
    place.textContent = 'tool at ' + tool.map(metres => (1000 * metres).toFixed(1)).join(', ') + ' mm (truth)';
  }

  function draw() {
    asked = false;
    const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
    const eye = [cy, 0, sy, 0, sp * sy, cp, -sp * cy, 0, -cp * sy, sp, cp * cy, 0];
    const scale = zoom * 0.5 * Math.min(raster.width, 1.35 * raster.height) / view.radius;
    raster.clear();
    if (shown.cloud) drawCloud(eye, scale);
    if (motion) drawRobot(eye, scale);
    raster.show();
  }
  const ask = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(draw);
  };
  const turn = (right, up) => {
    yaw += right;
    pitch = clamp(pitch + up, -Math.PI / 2, Math.PI / 2);
    ask();
  };
  const enlarge = factor => {
    zoom = clamp(zoom * factor, 0.2, 12);
    ask();
  };

  let from = null;
  canvas.addEventListener('pointerdown', event => {
    from = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', event => {
    if (!from) return;
    turn((event.clientX - from[0]) * 0.008, (event.clientY - from[1]) * 0.008);
    from = [event.clientX, event.clientY];
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { from = null; });
  canvas.addEventListener('wheel', event => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    enlarge(Math.exp(-event.deltaY * 0.002));
  }, {passive: false});
  const keys = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
    '+': () => enlarge(1.3), '-': () => enlarge(0.77)};
  canvas.addEventListener('keydown', event => {
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  for (const button of box.querySelectorAll('button[data-view]')) {
    button.addEventListener('click', () => {
      [yaw, pitch] = button.dataset.view.split(',').map(Number);
      ask();
    });
  }
  for (const button of box.querySelectorAll('button[data-zoom]')) button.addEventListener('click', () => enlarge(Number(button.dataset.zoom)));
  for (const button of box.querySelectorAll('button[data-show]')) {
    const what = button.dataset.show;
    button.setAttribute('aria-pressed', String(shown[what]));
    button.addEventListener('click', () => {
      shown[what] = !shown[what];
      button.setAttribute('aria-pressed', String(shown[what]));
      ask();
    });
  }

  const fit = () => {
    const width = clamp(Math.round(canvas.clientWidth * devicePixelRatio), 240, 1400);
    if (width === raster.width) return;
    raster.fit(width, Math.round(width * 0.6));
    ask();
  };
  const picture = box.querySelector('img');
  if (picture) picture.hidden = true;
  canvas.hidden = false;
  new ResizeObserver(fit).observe(canvas);
  moment.watch(canvas, ask);
  draw();
}

if (document.getElementById('cloud')) makeStage(document.getElementById('cloud'));
