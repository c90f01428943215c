// Points and triangles into a canvas, with a depth for each pixel: no graphics card is asked for. Orthographic; x right, y up, z toward the eye.

// Poses are rows of 3 by 4, in one array: turn and shift.
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

function product(a, b) {
  const c = new Array(12);
  for (let row = 0; row < 12; row += 4) {
    for (let k = 0; k < 4; ++k) c[row + k] = a[row] * b[k] + a[row + 1] * b[4 + k] + a[row + 2] * b[8 + k] + (k === 3 ? a[row + 3] : 0);
  }
  return c;
}

// By Rodrigues' formula; `axis` has length 1.
function turned([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), d = 1 - c;
  return [c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0, d * x * y + s * z, c + d * y * y, d * y * z - s * x, 0,
    d * x * z - s * y, d * y * z + s * x, c + d * z * z, 0];
}

const shifted = (axis, length) => [1, 0, 0, axis[0] * length, 0, 1, 0, axis[1] * length, 0, 0, 1, axis[2] * length];

const placed = (m, x, y, z) => [m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7], m[8] * x + m[9] * y + m[10] * z + m[11]];

const packed = (r, g, b) => 0xff000000 | Math.round(b) << 16 | Math.round(g) << 8 | Math.round(r);

class Raster {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.fit(canvas.width, canvas.height);
  }

  fit(width, height) {
    this.canvas.width = this.width = width;
    this.canvas.height = this.height = height;
    this.image = this.context.createImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.depth = new Float32Array(width * height);
  }

  clear() {
    this.pixels.fill(0xff1b140e);
    this.depth.fill(-1e9);
  }

  show() {
    this.context.putImageData(this.image, 0, 0);
  }

  dot(u, v, near, size, paint) {
    for (let j = 0; j < size; ++j) {
      for (let i = 0; i < size; ++i) {
        const x = u + i, y = v + j;
        if (x < 0 || y < 0 || x >= this.width || y >= this.height) continue;
        const k = y * this.width + x;
        if (near < this.depth[k]) continue;
        this.depth[k] = near;
        this.pixels[k] = paint;
      }
    }
  }

  // Corners as u, v, near, in pixels; each as seen from the eye in the same sense or left out.
  triangle(a, b, c, paint) {
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area === 0) return;
    const low = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]))), high = Math.min(this.height - 1, Math.floor(Math.max(a[1], b[1], c[1])));
    const left = Math.max(0, Math.ceil(Math.min(a[0], b[0], c[0]))), right = Math.min(this.width - 1, Math.floor(Math.max(a[0], b[0], c[0])));
    for (let y = low; y <= high; ++y) {
      for (let x = left; x <= right; ++x) {
        const p = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
        const q = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
        const r = 1 - p - q;
        if (p < 0 || q < 0 || r < 0) continue;
        const near = p * a[2] + q * b[2] + r * c[2], k = y * this.width + x;
        if (near < this.depth[k]) continue;
        this.depth[k] = near;
        this.pixels[k] = paint;
      }
    }
  }

  // A body of `vertices` (x, y, z one after the other), `faces` (three indices each) and `paint` (r, g, b of 0 to 1), lit from the eye's upper left.
  solid(pose, eye, scale, vertices, faces, paint) {
    const all = product(eye, pose), corners = [];
    for (let i = 0; i < vertices.length; i += 3) {
      const [x, y, z] = placed(all, vertices[i], vertices[i + 1], vertices[i + 2]);
      corners.push([this.width / 2 + scale * x, this.height / 2 - scale * y, z * scale]);
    }
    for (let i = 0; i < faces.length; i += 3) {
      const a = corners[faces[i]], b = corners[faces[i + 1]], c = corners[faces[i + 2]];
      const e = [b[0] - a[0], a[1] - b[1], b[2] - a[2]], f = [c[0] - a[0], a[1] - c[1], c[2] - a[2]];
      const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
      const length = Math.hypot(n[0], n[1], n[2]);
      if (n[2] <= 0 || length === 0) continue;  // it looks away
      const light = 255 * (0.35 + 0.65 * Math.max(0, (-0.35 * n[0] + 0.5 * n[1] + 0.79 * n[2]) / length));
      this.triangle(a, b, c, packed(paint[0] * light, paint[1] * light, paint[2] * light));
    }
  }
}
