// Tests of the real program as its operator sees it: metrics, health, JSON logs, draining. They need no browser.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { linkSync, mkdtempSync, readdirSync, readlinkSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { until } from "./driver.mjs";
import { BINARY, ROOT, freePort, startServer } from "./server_process.mjs";

// Maximum number of log lines per second that libraries may write (server/app/library_log.h).
const LINES_A_SECOND = 10;
// A drain time that is longer than any picture takes.
const DRAIN = ["--drain-seconds", "3600"];

async function start(...more) {
  const operatorPort = await freePort();
  const flags = ["--metrics", `127.0.0.1:${operatorPort}`, "--log-format", "json", ...more];
  const ports = { httpPort: await freePort(), grpcPort: await freePort() };
  const server = await startServer({ ...ports, more: flags });
  const get = async (path) => {
    const answer = await fetch(`http://127.0.0.1:${operatorPort}/${path}`);
    return { status: answer.status, text: await answer.text() };
  };
  const metric = async (name) => Number(new RegExp(`^thunderhead_${name} (\\d+)`, "m").exec((await get("metrics")).text)?.[1]);
  // The server draws two pictures for itself at its start, each in a session.
  await until("the server's own pictures", async () => (await metric("sessions_opened_total")) === 2 && (await metric("sessions")) === 0);
  // Begins a picture that takes some seconds. The promise resolves when the server has received the request.
  const beginPicture = async (file) => {
    const child = spawn(BINARY, [
      ...["render", "supercell", "-o", file, "--technique", "light_volume", "--slices", "512"],
      ...["--size", "1920x1080", "--server", `127.0.0.1:${ports.grpcPort}`],
    ]);
    let said = "";
    child.stderr.on("data", (text) => {
      said += text;
    });
    await until("the picture to begin", async () => {
      assert.equal(child.exitCode, null, said);
      return (await metric("pictures_in_progress")) > 0;
    });
    return child;
  };
  return { ...server, get, beginPicture };
}

// Returns the number of the folder's files that the process has open.
function openFiles({ pid }, folder) {
  const open = `/proc/${pid}/fd`;
  return readdirSync(open).filter((descriptor) => {
    try {
      return readlinkSync(`${open}/${descriptor}`).startsWith(folder);
    } catch {
      // The file has been closed meanwhile.
      return false;
    }
  }).length;
}

const ended = (child) => new Promise((resolve) => child.once("exit", (code, signal) => resolve({ code, signal })));

test("metrics, health and logs of a server that serves and then stops", async () => {
  const server = await start();
  assert.deepEqual(await server.get("healthz"), { status: 200, text: "serving\n" });
  assert.deepEqual(await server.get("readyz"), { status: 200, text: "serving\n" });
  const { text } = await server.get("metrics");
  for (const line of [/^thunderhead_sessions 0$/m, /^thunderhead_sessions_limit [1-9]/m, /^thunderhead_storms 1$/m, /^thunderhead_draining 0$/m]) {
    assert.match(text, line);
  }
  assert.match(text, /^thunderhead_memory_bytes [1-9]/m);
  // Protobuf logs an error for each request with a text field that is not UTF-8.
  const wrong = Buffer.from([0, 0, 0, 0, 4, 0x0a, 2, 0xff, 0xfe]);
  for (let i = 0; i < 200; i += 1) {
    const headers = { "content-type": "application/grpc-web+proto" };
    const method = "thunderhead.v1.ThunderheadService/DescribeStorm";
    await fetch(`${server.url}${method}`, { method: "POST", headers, body: wrong }).then((answer) => answer.text());
  }
  const exit = ended(server.child);
  server.child.kill("SIGTERM");
  assert.deepEqual(await exit, { code: 0, signal: null });
  const lines = server.log().split("\n").filter((line) => line !== "" && !line.startsWith("Thunderhead is ready"));
  const messages = lines.map((line) => JSON.parse(line));
  for (const { time, level, message } of messages) {
    assert.match(time, /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$/);
    assert.ok(["trace", "debug", "info", "warning", "error", "critical"].includes(level), level);
    assert.equal(typeof message, "string");
  }
  assert.ok(messages.some(({ message }) => message.startsWith("draining")));
  const complaints = messages.filter(({ message }) => message.startsWith("protobuf: "));
  assert.ok(complaints.length >= 1, "faulty calls are told");
  const seconds = complaints.map(({ time }) => time.slice(0, 19));
  for (const second of new Set(seconds)) {
    const lines = seconds.filter((each) => each === second).length;
    // The last line of the previous second may be written late.
    assert.ok(lines <= LINES_A_SECOND + 1, `${lines} lines in the second ${second}`);
  }
});

test("SIGTERM ends a server that still reads its storms", async () => {
  const folder = mkdtempSync(join(ROOT, "build", "starting-"));
  try {
    // Each file takes some 20 ms to read, so the server is still busy with these files when it gets the signal.
    for (let i = 0; i < 1500; i += 1) linkSync(join(ROOT, "samples", "supercell.nc"), join(folder, `storm${i}.nc`));
    const ports = ["--http", `127.0.0.1:${await freePort()}`, "--grpc", `127.0.0.1:${await freePort()}`];
    const child = spawn(BINARY, ["serve", "--data", folder, "--state", "none", ...ports]);
    let said = "";
    for (const stream of [child.stdout, child.stderr]) {
      stream.on("data", (text) => {
        said += text;
      });
    }
    await until("a storm that is read", () => {
      assert.equal(child.exitCode, null, said);
      return openFiles(child, folder) > 0;
    });
    const exit = ended(child);
    child.kill("SIGTERM");
    assert.deepEqual(await exit, { code: 0, signal: null });
    // If the server had already started, it was still searching the folder. The signal then also ends the search.
    assert.match(said, /stopped by a signal while starting|\bstopping$/m);
    assert.doesNotMatch(said, /hangs/);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});

test("SIGTERM waits for the picture that was begun, a second one ends at once", async () => {
  const folder = mkdtempSync(join(tmpdir(), "thunderhead-drain-"));
  const file = join(folder, "picture.png");
  try {
    const server = await start(...DRAIN);
    const picture = await server.beginPicture(file);
    const drawn = ended(picture);
    const exit = ended(server.child);
    server.child.kill("SIGTERM");
    let ready;
    await until("the server to drain", async () => {
      ready = await server.get("readyz");
      return ready.status !== 200;
    });
    assert.deepEqual(ready, { status: 503, text: "draining\n" });
    assert.equal((await server.get("healthz")).status, 200);
    assert.deepEqual(await drawn, { code: 0, signal: null });
    assert.ok(statSync(file).size > 10_000);
    assert.deepEqual(await exit, { code: 0, signal: null });

    const other = await start(...DRAIN);
    const lost = await other.beginPicture(file);
    const gaveUp = ended(lost);
    const killed = ended(other.child);
    other.child.kill("SIGTERM");
    await until("the server to drain", async () => (await other.get("readyz")).status === 503);
    // Signals that closely follow the first one count as the same request.
    await until("the end", () => {
      other.child.kill("SIGTERM");
      return other.child.exitCode !== null || other.child.signalCode !== null;
    });
    assert.deepEqual(await killed, { code: 128 + 15, signal: null });
    assert.notEqual((await gaveUp).code, 0);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
