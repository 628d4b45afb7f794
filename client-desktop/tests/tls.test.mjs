// Tests the native client against a real server that requires TLS and tokens: what it shows, and its messages if it
// cannot connect.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, before, test } from "node:test";
import { digest, writeCertificate } from "../../tests/e2e/credentials.mjs";
import { freePort, startServer } from "../../tests/e2e/server_process.mjs";
import { throttledLink } from "../../tests/e2e/throttled_link.mjs";
import { HANG_LIMIT_MS, PROGRAM, rests, startDesktop } from "./desktop_process.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 640, height: 400 };
const WINDOW = ["--width", String(SIZE.width), "--height", String(SIZE.height), "--scale", "1"];
const TOKENS = { teacher: "teacher-token-5f2c", student: "student-token-91aa" };

let folder;
let display;
let server;
let serverFlags;
const started = [];

const file = (name) => join(folder, name);

const start = (...flags) => startAt(serverFlags.grpcPort, ...flags);

function startAt(port, ...flags) {
  const desktop = startDesktop(display, port, [...WINDOW, ...flags]);
  started.push(desktop);
  return desktop;
}

const trusts = (name) => ["--tls-ca", file(`${name}.pem`)];
const hasToken = (name) => ["--token-file", file(`${name}.token`)];

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-desktop-tls-"));
  for (const name of ["server", "other"]) writeCertificate(file(`${name}.pem`), file(`${name}.key`));
  const roles = { teacher: "presenter", student: "viewer" };
  const lines = Object.entries(TOKENS).map(([name, token]) => {
    writeFileSync(file(`${name}.token`), `${token}\n`, { mode: 0o600 });
    return `${name} ${roles[name]} ${digest(token)}\n`;
  });
  writeFileSync(file("tokens"), lines.join(""), { mode: 0o600 });
  writeFileSync(file("wrong.token"), "wrong-token-77", { mode: 0o600 });
  display = await startDisplay(SIZE.width, SIZE.height);
  serverFlags = {
    httpPort: await freePort(),
    grpcPort: await freePort(),
    state: file("state"),
    more: ["--auth", "tokens", file("tokens"), "--tls-cert", file("server.pem"), "--tls-key", file("server.key")],
  };
  server = await startServer(serverFlags);
});

afterEach(async () => {
  for (const desktop of started.splice(0)) await desktop.stop();
});

after(async () => {
  await server?.stop();
  await display?.stop();
  rmSync(folder, { recursive: true, force: true });
});

test("a presenter's token steers, a viewer's watches, and both come back after the server's end", async () => {
  const teacher = start(...trusts("server"), ...hasToken("teacher"));
  const { viewer_key, role, steers } = await teacher.until("the teacher's picture", rests);
  assert.deepEqual({ role, steers }, { role: "presenter", steers: true });
  const student = start(...trusts("server"), ...hasToken("student"), "--key", viewer_key);
  const seen = await student.until("the student's picture", rests);
  assert.deepEqual({ role: seen.role, steers: seen.steers }, { role: "viewer", steers: false });
  display.screenshot("tls");

  await server.stop("SIGKILL");
  await student.until("the loss", (now) => now.link === "lost");
  server = await startServer(serverFlags);
  for (const desktop of [teacher, student]) {
    const back = await desktop.until("the return", (now) => rests(now) && now.joined > 1);
    assert.equal(back.viewer_key, viewer_key);
  }
});

const refusals = {
  "without TLS": { flags: () => hasToken("teacher"), link: "lost", reason: /answers, but closes the connection: .*TLS.*--tls-ca/ },
  "a certificate that the file does not vouch for": {
    flags: () => [...trusts("other"), ...hasToken("teacher")],
    link: "lost",
    reason: /TLS certificate is not signed by an authority in '.*other\.pem'/,
  },
  "the same, joining by key": {
    flags: () => [...trusts("other"), ...hasToken("teacher"), "--key", "0123456789abcdef0123456789abcdef"],
    link: "lost",
    reason: /TLS certificate is not signed by an authority in '.*other\.pem'/,
  },
  "without a token": { flags: () => trusts("server"), link: "refused", reason: /needs a token/ },
  "a wrong token": {
    flags: () => [...trusts("server"), ...hasToken("wrong")],
    link: "refused",
    reason: /does not know this token/,
  },
  "a viewer's token that is to open a session": {
    flags: () => [...trusts("server"), ...hasToken("student")],
    link: "refused",
    reason: /is not for the role of viewer/,
  },
};
for (const [name, { flags, link, reason }] of Object.entries(refusals)) {
  test(`${name}: it says so`, async () => {
    const desktop = start(...flags());
    const now = await desktop.until("a reason", (status) => status.link !== "connecting");
    assert.equal(now.link, link);
    assert.match(now.reason, reason);
    assert.equal(now.frames, 0);
  });
}

test("a file that holds no certificate ends the program with one line", () => {
  const flags = [`localhost:${serverFlags.grpcPort}`, "--tls-ca", file("tokens")];
  assert.throws(
    () => execFileSync(PROGRAM, flags, { env: display.env, stdio: "pipe", encoding: "utf8", timeout: HANG_LIMIT_MS }),
    ({ status, stderr }) => status > 0 && stderr.trim().split("\n").length === 1 && /contains no certificate in PEM/.test(stderr),
  );
});

test("TLS before a server that does not speak it is told from a server that is off, and the page's port from both", async () => {
  const plain = { httpPort: await freePort(), grpcPort: await freePort() };
  const reasonAt = async (port, ...flags) =>
    (await startAt(port, ...flags).until("a reason", ({ link }) => link !== "connecting")).reason;
  assert.match(await reasonAt(plain.grpcPort, ...trusts("server")), /^The server at 127\.0\.0\.1:\d+ cannot be reached$/);
  const another = await startServer(plain);
  try {
    assert.match(await reasonAt(plain.grpcPort, ...trusts("server")), /TLS certificate is not signed/);
    assert.match(await reasonAt(plain.httpPort), /answers by HTTP, so it is probably the port of the server's page; give its gRPC port/);
  } finally {
    await another.stop();
  }
});

// TLS takes three round trips, here 1.2 seconds, before the first call. The client must not give up earlier.
test("a link with a round trip of 400 ms", async () => {
  const link = await throttledLink({ port: serverFlags.grpcPort, kbitPerS: 20_000, roundTripMs: 400 });
  try {
    await startAt(link.port, ...trusts("server"), ...hasToken("teacher")).until("a picture", rests);
  } finally {
    link.close();
  }
});
