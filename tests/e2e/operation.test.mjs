// The real program as its operator sees it: metrics, health, JSON logs, draining. Needs no browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { freePort, startServer } from "./server_process.mjs";

async function start(...more) {
  const operatorPort = await freePort();
  const flags = ["--metrics", `127.0.0.1:${operatorPort}`, "--log-format", "json", ...more];
  const ports = { httpPort: await freePort(), grpcPort: await freePort() };
  const server = await startServer({ ...ports, flags });
  const get = async (path) => {
    const answer = await fetch(`http://127.0.0.1:${operatorPort}/${path}`);
    return { status: answer.status, text: await answer.text() };
  };
  return { ...server, get };
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
  const exit = ended(server.child);
  server.child.kill("SIGTERM");
  assert.deepEqual(await exit, { code: 0, signal: null });
  const lines = server.log().split("\n").filter((line) => line.startsWith("{"));
  const messages = lines.map((line) => JSON.parse(line));
  for (const { time, level, message } of messages) {
    assert.match(time, /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$/);
    assert.ok(["trace", "debug", "info", "warning", "error", "critical"].includes(level), level);
    assert.equal(typeof message, "string");
  }
  assert.ok(messages.some(({ message }) => message.startsWith("draining")));
});
