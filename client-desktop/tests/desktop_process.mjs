// Starts the native client, and reads what it says of itself in its status file.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const PROGRAM = process.env.THUNDERHEAD_DESKTOP ?? `${ROOT}build/desktop/bin/thunderhead-desktop`;
const PATIENCE_MS = 60_000;

export function startDesktop(display, port, flags = []) {
  if (!existsSync(PROGRAM)) throw new Error(`no program at ${PROGRAM}; run ./dev build desktop`);
  const folder = mkdtempSync(join(tmpdir(), "thunderhead-desktop-"));
  const file = join(folder, "status");
  const child = spawn(PROGRAM, [`127.0.0.1:${port}`, "--status", file, ...flags], { env: display.env });
  let said = "";
  for (const stream of [child.stdout, child.stderr]) {
    stream.on("data", (text) => {
      said += text;
    });
  }
  const ended = new Promise((resolve) => child.once("exit", resolve));
  // Just after it was begun anew it is empty.
  const lines = () => (existsSync(file) ? readFileSync(file, "utf8").split("\n").slice(0, -1) : []);
  const status = () => JSON.parse(lines().at(-1) ?? "{}");
  return {
    child,
    ended,
    status,
    said: () => said,
    // Waits until its status is as wanted, and returns it.
    async until(what, holds, patienceMs = PATIENCE_MS) {
      const deadline = Date.now() + patienceMs;
      for (;;) {
        const now = status();
        if (now.t_s !== undefined && holds(now)) return now;
        if (child.exitCode !== null) throw new Error(`the program ended with ${child.exitCode}:\n${said}`);
        if (Date.now() > deadline) throw new Error(`never came: ${what}; ${JSON.stringify(now)}`);
        await sleep(100);
      }
    },
    // The status after all that was done to it before this call: the line that comes next may have been begun before.
    async settled() {
      const count = lines().length;
      return this.until("two more lines", () => lines().length >= count + 2);
    },
    async stop() {
      if (child.exitCode === null && child.signalCode === null) child.kill();
      await ended;
      rmSync(folder, { recursive: true, force: true });
    },
  };
}

// A full picture of the newest scene is on the screen.
export const rests = (status) =>
  status.link === "live" && status.refined && status.revision > 0 && status.shown_revision >= status.revision;
