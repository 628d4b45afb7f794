// Measures a screen's pixels, and finds buttons by their colour.
import assert from "node:assert/strict";
import { setTimeout as sleep } from "node:timers/promises";
import { HANG_LIMIT_MS } from "./desktop_process.mjs";

const POLL_MS = 50;

export const brightness = ({ rgb }) => rgb.reduce((sum, value) => sum + value, 0) / rgb.length;
// Returns the fraction, from 0 to 1, of the pixels whose red differs clearly between two pictures.
export function difference(a, b) {
  let count = 0;
  for (let i = 0; i < a.rgb.length; i += 3) if (Math.abs(a.rgb[i] - b.rgb[i]) > 12) count += 1;
  return (3 * count) / a.rgb.length;
}

export function region({ width, rgb }, { x, y, width: w, height: h }) {
  const rows = [];
  for (let row = y; row < y + h; row += 1) rows.push(rgb.subarray(3 * (row * width + x), 3 * (row * width + x + w)));
  return { rgb: Buffer.concat(rows) };
}

// Finds a button that can be pressed by its accent colour. Returns the centre and the right edge of the pixels in this
// colour.
export function accentIn(pixels, { x, y, width, height }) {
  const found = [];
  for (let row = y; row < y + height; row += 1) {
    for (let column = x; column < x + width; column += 1) {
      const at = 3 * (row * pixels.width + column);
      const [r, g, b] = pixels.rgb.subarray(at, at + 3);
      if (r > 245 && Math.abs(g - 209) < 12 && Math.abs(b - 107) < 16) found.push([column, row]);
    }
  }
  assert.ok(found.length > 100, "no button to press");
  const mean = (part) => Math.round(found.reduce((sum, each) => sum + each[part], 0) / found.length);
  return { x: mean(0), y: mean(1), right: Math.max(...found.map(([column]) => column)) };
}

export async function eventually(what, holds) {
  const deadline = Date.now() + HANG_LIMIT_MS;
  while (!(await holds())) {
    assert.ok(Date.now() < deadline, what);
    await sleep(POLL_MS);
  }
}

// Returns the mean red, green and blue, 0 to 255.
export function meanColor({ rgb }) {
  const sums = [0, 0, 0];
  for (let i = 0; i < rgb.length; i += 1) sums[i % 3] += rgb[i];
  return sums.map((sum) => (3 * sum) / rgb.length);
}

// Returns the number of pixels whose red, green and blue differ from `color` by at most `tolerance`.
export function pixelsLike({ rgb }, color, tolerance = 16) {
  let count = 0;
  for (let i = 0; i < rgb.length; i += 3) if (color.every((value, at) => Math.abs(rgb[i + at] - value) <= tolerance)) count += 1;
  return count;
}
