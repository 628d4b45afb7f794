// Starts the real program on the smaller sample storm, and stops it. The program's path is THUNDERHEAD_BINARY, or
// build/release/bin/thunderhead.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { createServer } from "node:net";
import { fileURLToPath } from "node:url";

export const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const BINARY = process.env.THUNDERHEAD_BINARY ?? `${ROOT}build/release/bin/thunderhead`;
// A program that takes longer to start or to stop counts as hung.
const START_TIMEOUT_MS = 600_000;
const STOP_TIMEOUT_MS = 600_000;

// Test programs take ports from this range, which lies below the ports that the kernel gives to connections and to
// programs that ask for any port. The range above it belongs to tests/engines/engine_test.py.
const FIRST_PORT = 20_000;
const END_OF_PORTS = 26_000;

// Listens until the returned server is closed. Returns undefined if the port is taken.
function listenAt(host, port) {
  return new Promise((resolve) => {
    const server = createServer().once("error", () => resolve(undefined));
    server.listen(port, host, () => resolve(server));
  });
}

// Returns a port of 127.0.0.1 that belongs to this process until it ends, so that a program that is started again later
// finds it free. While this process runs, it holds the same port of 127.0.0.2, which keeps other tests from taking it.
export async function freePort() {
  while (true) {
    const port = FIRST_PORT + Math.floor(Math.random() * (END_OF_PORTS - FIRST_PORT));
    const held = await listenAt("127.0.0.2", port);
    if (held === undefined) continue;
    const probe = await listenAt("127.0.0.1", port);
    if (probe === undefined) {
      held.close();
      continue;
    }
    await new Promise((resolve) => probe.close(resolve));
    held.unref();
    return port;
  }
}

// Starts the server. `state` is the folder in which the server saves its sessions, `data` the file or folder of storms,
// and `more` a list of further flags.
export async function startServer({
  httpPort,
  grpcPort,
  state = "none",
  data = `${ROOT}samples/supercell.nc`,
  more = [],
}) {
  const page = `${ROOT}client-web/dist`;
  if (!existsSync(BINARY)) throw new Error(`no program at ${BINARY}; build it, or set THUNDERHEAD_BINARY`);
  if (!existsSync(`${page}/index.html`)) throw new Error(`no page in ${page}; run npm run build in client-web`);
  const address = (port) => `127.0.0.1:${port}`;
  const flags = ["--data", data, "--http", address(httpPort), "--grpc", address(grpcPort)];
  const child = spawn(BINARY, ["serve", ...flags, "--page", page, "--state", state, ...more], { cwd: ROOT });
  let said = "";
  const url = await new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`no URL printed in time:\n${said}`)), START_TIMEOUT_MS);
    const settle = (finish, value) => {
      clearTimeout(timer);
      finish(value);
    };
    child.once("error", (error) => settle(reject, error));
    child.once("exit", (code) => settle(reject, new Error(`${BINARY} exited with ${code}:\n${said}`)));
    child.stderr.on("data", (text) => {
      said += text;
    });
    let printed = "";
    child.stdout.on("data", (text) => {
      said += text;
      printed += text;
      const match = /https?:\/\/[^\s"']+/.exec(printed);
      if (match) settle(resolve, match[0]);
    });
  });
  return { url, child, log: () => said, stop: (signal = "SIGTERM") => stop(child, signal) };
}

async function stop(child, signal) {
  if (child.exitCode !== null || child.signalCode !== null) return;
  const exited = new Promise((resolve) => child.once("exit", resolve));
  child.kill(signal);
  const timer = setTimeout(() => child.kill("SIGKILL"), STOP_TIMEOUT_MS);
  await exited;
  clearTimeout(timer);
}
