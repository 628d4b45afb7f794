// Functions that measure a picture: the spread of its luminance, its brightness, and its difference from another
// picture.
import { PNG } from "pngjs";

// Returns the canvas's pixels as PNG, without the panels over it.
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

// Returns the mean and standard deviation of the luminance, 0 to 255.
export function spread(picture) {
  const values = luminances(picture);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length;
  return { mean, deviation: Math.sqrt(variance) };
}

// Returns the share of pixels that are cloud instead of sky: nearly grey, and brighter than `least`. The sky is blue.
export function greyShare({ data, width, height }, least = 0) {
  let grey = 0;
  for (let i = 0; i < width * height; i += 1) {
    const [red, green, blue] = [data[4 * i], data[4 * i + 1], data[4 * i + 2]];
    const luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    if (luminance >= least && blue - red < 24) grey += 1;
  }
  return grey / (width * height);
}

// Returns the mean luminance within a box given in shares of the picture.
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

// Returns the mean absolute difference of all channels, 0 to 255.
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("the pictures differ in size");
  let sum = 0;
  for (let i = 0; i < a.data.length; i += 1) if (i % 4 !== 3) sum += Math.abs(a.data[i] - b.data[i]);
  return sum / (a.width * a.height * 3);
}

// Returns the differences of the means of blocks, channel by channel.
function blockDifferences(a, b, side) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("the pictures differ in size");
  const [columns, rows] = [Math.floor(a.width / side), Math.floor(a.height / side)];
  const means = new Float64Array(columns * rows * 3);
  for (let y = 0; y < rows * side; y += 1) {
    for (let x = 0; x < columns * side; x += 1) {
      const block = Math.floor(y / side) * columns + Math.floor(x / side);
      const at = 4 * (y * a.width + x);
      for (let i = 0; i < 3; i += 1) means[3 * block + i] += (a.data[at + i] - b.data[at + i]) / (side * side);
    }
  }
  return means;
}

// Returns the mean absolute difference of block means, 0 to 255. It compares colours independently of the pictures'
// sharpness.
export function blockDifference(a, b, side = 16) {
  const means = blockDifferences(a, b, side);
  return means.reduce((sum, value) => sum + Math.abs(value), 0) / means.length;
}

// Returns how much of the change from one picture to another a third picture shows, by least squares over blocks. It is
// 0 if the third is like the first, and 1 if it is like the other. Encoding noise is independent of the change, so it
// counts for little.
export function shareOfChange(picture, from, to, side = 16) {
  const [is, would] = [blockDifferences(picture, from, side), blockDifferences(to, from, side)];
  const along = (values) => values.reduce((sum, value, i) => sum + value * would[i], 0);
  return along(is) / along(would);
}

function withPixels(picture, change) {
  const data = Uint8ClampedArray.from(picture.data);
  for (let i = 0; i < data.length; i += 4) data.set(change(...picture.data.subarray(i, i + 3)), i);
  return { ...picture, data };
}

// Returns the picture as shown by a decoder that mistakes the colour differences of BT.601 for those of BT.709.
export const decodedByBt709 = (picture) =>
  withPixels(picture, (red, green, blue) => {
    const luma = 0.299 * red + 0.587 * green + 0.114 * blue;
    const [cb, cr] = [(blue - luma) / 1.772, (red - luma) / 1.402];
    return [luma + 1.5748 * cr, luma - 0.1873 * cb - 0.4681 * cr, luma + 1.8556 * cb];
  });

// Returns the picture as shown by a decoder that mistakes video's range of 16 to 235 for 0 to 255.
export const decodedAsFullRange = (picture) =>
  withPixels(picture, (...colours) => colours.map((colour) => 16 + (colour * 219) / 255));

// Returns the share of pixels in which two pictures differ by more than a JPEG's noise.
export function differingShare(a, b) {
  const noise = 10;
  const [first, second] = [luminances(a), luminances(b)];
  if (first.length !== second.length) throw new Error("the pictures differ in size");
  return first.filter((value, i) => Math.abs(value - second[i]) > noise).length / first.length;
}
