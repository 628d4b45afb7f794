// Starts the native client, sends it real input, and reads its state from its status file. The file gets a line after
// every turn of the window's loop. Tests can therefore wait for states instead of a fixed time.
import { spawn } from "node:child_process";
import { closeSync, existsSync, fstatSync, mkdtempSync, openSync, readSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const PROGRAM = process.env.THUNDERHEAD_DESKTOP ?? `${ROOT}build/desktop/bin/thunderhead-desktop`;
// The longest wait before a test counts as hung. It is not a performance requirement.
export const HANG_LIMIT_MS = 600_000;
const POLL_MS = 20;
// Number of drawings after which the interface has settled: kSettlingDraws in desktop/app.cc.
const SETTLING_DRAWINGS = 6;
// Every line of the status file is shorter than this.
const MOST_LINE_BYTES = 8192;

// Returns the last complete line of a file; undefined if there is none.
function lastLine(path) {
  let file;
  try {
    file = openSync(path, "r");
  } catch {
    return undefined; // not created yet, or just renamed
  }
  try {
    const { size } = fstatSync(file);
    const tail = Buffer.alloc(Math.min(size, 2 * MOST_LINE_BYTES));
    const read = readSync(file, tail, 0, tail.length, size - tail.length);
    return tail.toString("utf8", 0, read).split("\n").slice(0, -1).at(-1);
  } finally {
    closeSync(file);
  }
}

// Returns true if the effects of the last input, and of texts that changed, have been drawn.
export const drawn = (status) => status.drawings >= SETTLING_DRAWINGS;

// Returns true if a refined picture of the newest scene is on the screen.
export const rests = (status) =>
  status.link === "live" && status.refined && status.revision > 0 && status.shown_revision >= status.revision;

// Returns true if rests() returns true and no better picture will follow. Use it only without path-traced correction:
// the last picture then arrives in full quality as AVIF.
export const complete = (status) => rests(status) && status.image_scale >= 1 && status.encoding === "AVIF" && drawn(status);

// Returns true if rests() returns true and the controls know the storm's fields and times, which arrive separately.
export const ready = (status) => rests(status) && status.times > 0 && status.people > 0 && drawn(status);

export function startDesktop(display, port, flags = []) {
  if (!existsSync(PROGRAM)) throw new Error(`no program at ${PROGRAM}; run ./dev build desktop`);
  const folder = mkdtempSync(join(tmpdir(), "thunderhead-desktop-"));
  const file = join(folder, "status");
  const child = spawn(PROGRAM, [`127.0.0.1:${port}`, "--status", file, "--status-always", ...flags], { env: display.env });
  let said = "";
  for (const stream of [child.stdout, child.stderr]) {
    stream.on("data", (text) => {
      said += text;
    });
  }
  const ended = new Promise((resolve) => child.once("exit", resolve));
  // Just after the status file was restarted, the newest line is the last line of the previous file.
  const status = () => JSON.parse(lastLine(file) ?? lastLine(`${file}.1`) ?? "{}");
  const desktop = {
    child,
    ended,
    status,
    said: () => said,
    // Waits until `holds` returns true for the status, and returns the status.
    async until(what, holds) {
      const deadline = Date.now() + HANG_LIMIT_MS;
      for (;;) {
        const now = status();
        if (now.t_s !== undefined && holds(now)) return now;
        if (child.exitCode !== null) throw new Error(`the program ended with ${child.exitCode}:\n${said}`);
        if (Date.now() > deadline) throw new Error(`never came: ${what}; ${JSON.stringify(now)}`);
        await sleep(POLL_MS);
      }
    },
    // Sends input by `act`. Waits until the window has handled the input and drawn its effects, and returns the status.
    // The parameter `keys` counts released keys, except Ctrl and the like. The parameters `buttons` and `notches` count
    // presses and releases of mouse buttons, and notches of the wheel. The parameter `at` is the pointer's final
    // position.
    async input({ keys = 0, buttons = 0, notches = 0, at }, act) {
      const before = status();
      act();
      const taken = (now) =>
        now.keys >= before.keys + keys &&
        now.buttons >= before.buttons + buttons &&
        now.notches >= before.notches + notches &&
        (at === undefined || (now.pointer_x === at.x && now.pointer_y === at.y));
      return this.until("the input", (now) => taken(now) && drawn(now));
    },
    key(...keys) {
      return this.input({ keys: keys.length }, () => display.xdotool("key", ...keys));
    },
    move(x, y) {
      return this.input({ at: { x, y } }, () => display.xdotool("mousemove", x, y));
    },
    // All events are sent at once. The click is not lost, because the window draws between a press and its release,
    // however fast they arrive.
    click(x, y) {
      return this.input({ at: { x, y }, buttons: 2 }, () => display.xdotool("mousemove", x, y, "click", 1));
    },
    // Drags with the left button, in steps.
    async drag(from, to, steps = 12) {
      await this.input({ at: from, buttons: 1 }, () => display.xdotool("mousemove", from.x, from.y, "mousedown", 1));
      const at = (a, b, step) => Math.round(a + ((b - a) * step) / steps);
      const path = Array.from({ length: steps }, (_, i) => ["mousemove", at(from.x, to.x, i + 1), at(from.y, to.y, i + 1)]);
      return this.input({ at: to, buttons: 1 }, () => display.xdotool(...path.flat(), "mouseup", 1));
    },
    // Turns the mouse wheel up by one notch.
    wheel() {
      return this.input({ notches: 1 }, () => display.xdotool("click", 4));
    },
    // Types into the field that has the keyboard.
    type(text) {
      return this.input({ keys: text.length }, () => display.xdotool("type", "--", text));
    },
    // Replaces the value of a field.
    async fill(x, y, text) {
      await this.click(x, y);
      return this.input({ keys: text.length + 2 }, () => {
        display.xdotool("key", "ctrl+a");
        display.xdotool("type", "--", text);
        display.xdotool("key", "Return");
      });
    },
    // Chooses quality "Fast", in a window of scale 1. By default the server traces paths while a picture rests, which
    // would keep the processors busy during the test.
    async chooseFast() {
      await this.key("k");
      await this.click(162, 131);
      return this.key("Escape");
    },
    async stop() {
      if (child.exitCode === null && child.signalCode === null) child.kill();
      await ended;
      rmSync(folder, { recursive: true, force: true });
    },
  };
  return desktop;
}
