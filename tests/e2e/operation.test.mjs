// The real program as its operator sees it: metrics, health, JSON logs, draining. Needs no browser.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { linkSync, mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { setTimeout } from "node:timers/promises";
import { BINARY, ROOT, freePort, startServer } from "./server_process.mjs";

// Of the 30 s that the first signal leaves a picture; a busy machine takes a second to end a process.
const AT_ONCE_MS = 5000;

async function start(...more) {
  const operatorPort = await freePort();
  const flags = ["--metrics", `127.0.0.1:${operatorPort}`, "--log-format", "json", ...more];
  const ports = { httpPort: await freePort(), grpcPort: await freePort() };
  const server = await startServer({ ...ports, more: flags });
  const get = async (path) => {
    const answer = await fetch(`http://127.0.0.1:${operatorPort}/${path}`);
    return { status: answer.status, text: await answer.text() };
  };
  const pictures = async () =>
    Number(/^thunderhead_pictures_in_progress (\d+)/m.exec((await get("metrics")).text)?.[1]);
  // Begins a picture that takes some seconds; resolves when the server has it.
  const beginPicture = async (file) => {
    // The server draws two by itself at its start, one after the other.
    for (let quiet = 0; quiet < 10; quiet = (await pictures()) === 0 ? quiet + 1 : 0) await setTimeout(50);
    const child = spawn(BINARY, [
      ...["render", "supercell", "-o", file, "--renderer", "light_volume", "--slices", "512"],
      ...["--size", "2560x1440", "--server", `127.0.0.1:${ports.grpcPort}`],
    ]);
    let said = "";
    child.stderr.on("data", (text) => {
      said += text;
    });
    while ((await pictures()) === 0) {
      assert.equal(child.exitCode, null, said);
      await setTimeout(20);
    }
    return child;
  };
  return { ...server, get, beginPicture };
}

const ended = (child) => new Promise((resolve) => child.once("exit", (code, signal) => resolve({ code, signal })));

test("metrics, health and logs of a server that serves and then stops", async () => {
  const server = await start();
  assert.deepEqual(await server.get("healthz"), { status: 200, text: "serving\n" });
  assert.deepEqual(await server.get("readyz"), { status: 200, text: "serving\n" });
  const { text } = await server.get("metrics");
  for (const line of [/^thunderhead_sessions 0$/m, /^thunderhead_storms 1$/m, /^thunderhead_draining 0$/m]) {
    assert.match(text, line);
  }
  assert.match(text, /^thunderhead_memory_bytes [1-9]/m);
  // A field of text that is not UTF-8 makes protobuf complain, as often as somebody sends it.
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
  const complaints = messages.filter(({ message }) => message.startsWith("protobuf: ")).length;
  assert.ok(complaints >= 1 && complaints <= 100, `${complaints} lines of 200 faulty calls`);
});

test("SIGTERM ends a server that still reads its storms", async () => {
  const folder = mkdtempSync(join(ROOT, "build", "starting-"));
  try {
    // Some 20 ms of reading each.
    for (let i = 0; i < 1500; i += 1) linkSync(join(ROOT, "samples", "supercell.nc"), join(folder, `storm${i}.nc`));
    const ports = ["--http", `127.0.0.1:${await freePort()}`, "--grpc", `127.0.0.1:${await freePort()}`];
    const child = spawn(BINARY, ["serve", "--data", folder, "--state", "none", ...ports]);
    let said = "";
    for (const stream of [child.stdout, child.stderr]) {
      stream.on("data", (text) => {
        said += text;
      });
    }
    await setTimeout(1000);
    assert.equal(child.exitCode, null, said);
    const exit = ended(child);
    child.kill("SIGTERM");
    assert.deepEqual(await exit, { code: 0, signal: null });
    assert.match(said, /told to stop while starting/);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});

test("SIGTERM waits for the picture that was begun, a second one ends at once", async () => {
  const folder = mkdtempSync(join(tmpdir(), "thunderhead-drain-"));
  const file = join(folder, "picture.png");
  try {
    // A busy machine may take more than the usual 30 s for the picture.
    const server = await start("--drain-seconds", "300");
    const picture = await server.beginPicture(file);
    const drawn = ended(picture);
    const exit = ended(server.child);
    server.child.kill("SIGTERM");
    await setTimeout(100);
    assert.deepEqual(await server.get("readyz"), { status: 503, text: "draining\n" });
    assert.equal((await server.get("healthz")).status, 200);
    assert.deepEqual(await drawn, { code: 0, signal: null });
    assert.ok(statSync(file).size > 10_000);
    assert.deepEqual(await exit, { code: 0, signal: null });

    const other = await start();
    const lost = await other.beginPicture(file);
    const gaveUp = ended(lost);
    const killed = ended(other.child);
    other.child.kill("SIGTERM");
    await setTimeout(400);
    const again = Date.now();
    other.child.kill("SIGTERM");
    assert.deepEqual(await killed, { code: 128 + 15, signal: null });
    const tookMs = Date.now() - again;
    assert.ok(tookMs < AT_ONCE_MS, `it ended after ${tookMs} ms`);
    assert.notEqual((await gaveUp).code, 0);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
