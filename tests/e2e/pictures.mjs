// Measures of a picture: spread, brightness, difference from another picture.
import { PNG } from "pngjs";

// The canvas's pixels as PNG, without the panels over it.
export async function grabCanvas(page) {
  const dataUrl = await page.getByTestId("storm-canvas").evaluate((canvas) => canvas.toDataURL("image/png"));
  return PNG.sync.read(Buffer.from(dataUrl.split(",")[1], "base64"));
}

function luminances({ data, width, height }) {
  const values = new Float64Array(width * height);
  for (let i = 0; i < values.length; i += 1) {
    values[i] = 0.2126 * data[4 * i] + 0.7152 * data[4 * i + 1] + 0.0722 * data[4 * i + 2];
  }
  return values;
}

// Mean and standard deviation of the luminance, 0 to 255.
export function spread(picture) {
  const values = luminances(picture);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length;
  return { mean, deviation: Math.sqrt(variance) };
}

// Share of pixels that are cloud rather than sky: nearly grey, and brighter than `least`. The sky is blue.
export function greyShare({ data, width, height }, least = 0) {
  let grey = 0;
  for (let i = 0; i < width * height; i += 1) {
    const [red, green, blue] = [data[4 * i], data[4 * i + 1], data[4 * i + 2]];
    const luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    if (luminance >= least && blue - red < 24) grey += 1;
  }
  return grey / (width * height);
}

// Mean of the luminance within a box given in shares of the picture.
export function boxMean(picture, [left, top, right, bottom]) {
  const values = luminances(picture);
  let sum = 0;
  let count = 0;
  for (let y = Math.floor(top * picture.height); y < bottom * picture.height; y += 1) {
    for (let x = Math.floor(left * picture.width); x < right * picture.width; x += 1) {
      sum += values[y * picture.width + x];
      count += 1;
    }
  }
  return sum / count;
}

// Mean absolute difference of all channels, 0 to 255.
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("the pictures differ in size");
  let sum = 0;
  for (let i = 0; i < a.data.length; i += 1) if (i % 4 !== 3) sum += Math.abs(a.data[i] - b.data[i]);
  return sum / (a.width * a.height * 3);
}

// Mean absolute difference of the means of blocks, all channels, 0 to 255: of colours, whatever the pictures' sharpness.
export function blockDifference(a, b, side = 16) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("the pictures differ in size");
  const [columns, rows] = [Math.floor(a.width / side), Math.floor(a.height / side)];
  const sums = new Float64Array(columns * rows * 3);
  for (let y = 0; y < rows * side; y += 1) {
    for (let x = 0; x < columns * side; x += 1) {
      const block = Math.floor(y / side) * columns + Math.floor(x / side);
      const at = 4 * (y * a.width + x);
      for (let i = 0; i < 3; i += 1) sums[3 * block + i] += a.data[at + i] - b.data[at + i];
    }
  }
  return sums.reduce((sum, value) => sum + Math.abs(value), 0) / (sums.length * side * side);
}

// Share of pixels in which two pictures differ by more than a JPEG's noise.
export function differingShare(a, b) {
  const noise = 10;
  const [first, second] = [luminances(a), luminances(b)];
  if (first.length !== second.length) throw new Error("the pictures differ in size");
  return first.filter((value, i) => Math.abs(value - second[i]) > noise).length / first.length;
}
