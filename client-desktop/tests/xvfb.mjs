// A virtual display: starts Xvfb, runs xdotool in it, and takes screenshots.
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";

export const OUTPUT = fileURLToPath(new URL("output/", import.meta.url));
// This timeout only catches hangs.
const START_TIMEOUT_MS = 600_000;

// Starts a display. With `dpi` it reports a monitor of that resolution. With `managed` it runs a window manager,
// without which programs cannot switch between full screen and a window.
export async function startDisplay(width, height, { managed = false, dpi } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "thunderhead-xvfb-"));
  // -r disables key repeat. Otherwise a key whose release comes late on a busy machine would repeat.
  const flags = ["-screen", "0", `${width}x${height}x24`, "-fbdir", folder, "-r", "-nolisten", "tcp", "-displayfd", "3"];
  if (dpi !== undefined) flags.push("-dpi", String(dpi));
  const child = spawn("Xvfb", flags, { stdio: ["ignore", "ignore", "ignore", "pipe"] });
  const number = await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error("Xvfb did not start")), START_TIMEOUT_MS);
    child.once("error", reject);
    child.stdio[3].once("data", (text) => {
      clearTimeout(timer);
      resolve(Number(text));
    });
  });
  const env = { ...process.env, DISPLAY: `:${number}`, LIBGL_ALWAYS_SOFTWARE: "1", SDL_VIDEODRIVER: "x11" };
  // RandR is switched off, because Xvfb reports no physical size of its outputs through RandR. SDL then computes the
  // resolution from the screen's size.
  if (dpi !== undefined) env.SDL_VIDEO_X11_XRANDR = "0";
  // The font "fixed" needs no font file.
  const manager = managed ? spawn("evilwm", ["-fn", "fixed"], { env, stdio: "inherit" }) : undefined;
  const xdotool = (...words) => execFileSync("xdotool", words.map(String), { env, encoding: "utf8" });
  return {
    env,
    xdotool,
    pixels: () => readXwd(join(folder, "Xvfb_screen0")),
    screenshot(name) {
      mkdirSync(OUTPUT, { recursive: true });
      const path = `${OUTPUT}${name}.png`;
      writeFileSync(path, pngOf(readXwd(join(folder, "Xvfb_screen0"))));
      return path;
    },
    async stop() {
      const ended = new Promise((resolve) => child.once("exit", resolve));
      manager?.kill();
      child.kill();
      await ended;
      rmSync(folder, { recursive: true, force: true });
    },
  };
}

// Reads an X window dump with 32 bits a pixel. Returns width, height and RGB.
function readXwd(path) {
  const dump = readFileSync(path);
  const word = (at) => dump.readUInt32BE(4 * at);
  const [headerBytes, width, height, lineBytes, colors] = [word(0), word(4), word(5), word(12), word(19)];
  const start = headerBytes + 12 * colors;
  const rgb = Buffer.alloc(3 * width * height);
  for (let y = 0, to = 0; y < height; y += 1) {
    let from = start + y * lineBytes;
    for (let x = 0; x < width; x += 1, from += 4, to += 3) {
      rgb[to] = dump[from + 2];
      rgb[to + 1] = dump[from + 1];
      rgb[to + 2] = dump[from];
    }
  }
  return { width, height, rgb };
}

// Computes the CRC of ISO 3309, which PNG uses. Node 18 has no such function.
function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return (crc ^ 0xffffffff) >>> 0;
}

function pngOf({ width, height, rgb }) {
  const rows = Buffer.alloc((3 * width + 1) * height);
  for (let y = 0; y < height; y += 1) rgb.copy(rows, y * (3 * width + 1) + 1, 3 * width * y, 3 * width * (y + 1));
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 2, 0, 0, 0], 8);
  const chunk = (name, data) => {
    const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
    const whole = Buffer.alloc(body.length + 8);
    whole.writeUInt32BE(data.length, 0);
    body.copy(whole, 4);
    whole.writeUInt32BE(crc32(body), body.length + 4);
    return whole;
  };
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([signature, chunk("IHDR", header), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}
