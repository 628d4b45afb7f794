// Reads the text that a phone would read from the QR code in "Share": the pixels on the screen, decoded by another
// library than the one that drew them.
import jsQR from "jsqr";
import { PNG } from "pngjs";

export async function textOfCode(page) {
  const { data, width, height } = PNG.sync.read(await page.getByTestId("qr").screenshot());
  return jsQR(new Uint8ClampedArray(data), width, height)?.data;
}
