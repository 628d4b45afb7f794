// Tests of the files in deploy/ with the programs that use them. They cover HAProxy in front of the real server, the
// systemd unit, Prometheus's rules, and the flags in the Compose file. Each test needs the Debian package of its
// program.
import assert from "node:assert/strict";
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import http2 from "node:http2";
import https from "node:https";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";
import { writeCertificate } from "./credentials.mjs";
import { launchBrowser, listenForErrors, rested, until } from "./driver.mjs";
import { BINARY, freePort, startServer } from "./server_process.mjs";

const ROOT = fileURLToPath(new URL("../../", import.meta.url));
const VIEWPORT = { width: 640, height: 400 };
const HAPROXY = "/usr/sbin/haproxy";

const folder = mkdtempSync(join(tmpdir(), "thunderhead-deploy-"));
const file = (name) => join(folder, name);
after(() => rmSync(folder, { recursive: true, force: true }));

describe("HAProxy", { skip: existsSync(HAPROXY) ? false : "needs Debian's haproxy" }, () => {
  let server;
  let proxy;
  let browser;
  let port;
  let said = "";

  before(async () => {
    writeCertificate(file("cert.pem"), file("key.pem"));
    writeFileSync(file("both.pem"), readFileSync(file("cert.pem"), "utf8") + readFileSync(file("key.pem"), "utf8"), {
      mode: 0o600,
    });
    port = await freePort();
    const ports = { httpPort: await freePort(), grpcPort: await freePort() };
    server = await startServer({ ...ports, more: ["--trusted-proxy", "127.0.0.1"] });
    proxy = spawn(HAPROXY, ["-db", "-f", `${ROOT}deploy/haproxy/haproxy.cfg`], {
      env: {
        THUNDERHEAD_BIND: `127.0.0.1:${port}`,
        THUNDERHEAD_CERTIFICATE: file("both.pem"),
        THUNDERHEAD_HTTP_PORT: ports.httpPort,
        THUNDERHEAD_GRPC_PORT: ports.grpcPort,
      },
    });
    proxy.stderr.on("data", (text) => {
      said += text;
    });
    await until("the proxy's answer", async () => {
      assert.equal(proxy.exitCode, null, said);
      return (await status("/healthz").catch(() => 0)) === 200;
    });
    browser = await launchBrowser();
  });

  after(async () => {
    await browser?.close();
    proxy?.kill();
    await server?.stop();
  });

  const status = (path) =>
    new Promise((resolve, reject) => {
      https
        .get({ host: "127.0.0.1", port, path, rejectUnauthorized: false }, (answer) => {
          answer.resume();
          resolve(answer.statusCode);
        })
        .once("error", reject);
    });

  test("the page comes by HTTP/2 and shows the storm by its WebSocket", async () => {
    const context = await browser.newContext({ viewport: VIEWPORT, ignoreHTTPSErrors: true });
    const page = await context.newPage();
    const complaints = [];
    listenForErrors(page, complaints);
    const sockets = [];
    page.on("websocket", (socket) => sockets.push(socket.url()));
    const answer = await page.goto(`https://localhost:${port}/`);
    assert.equal(answer.status(), 200);
    assert.equal(answer.headers()["strict-transport-security"], "max-age=31536000");
    await rested(page);
    assert.match(sockets[0], /^wss:.*\/Interact$/);
    assert.deepEqual(complaints, []);
    await context.close();
  });

  // Returns the headers of `count` responses to requests that are sent at once on one connection.
  const ask = (client, count) => {
    const one = () =>
      new Promise((resolve, reject) => {
        client.request({ ":path": "/healthz" }).once("error", reject).once("response", resolve).resume();
      });
    return Promise.all(Array.from({ length: count }, one));
  };

  test("HTTP/2 without a browser", async () => {
    const client = http2.connect(`https://127.0.0.1:${port}`, { rejectUnauthorized: false });
    const [headers] = await ask(client, 1);
    client.close();
    assert.equal(client.alpnProtocol, "h2");
    assert.equal(headers[":status"], 200);
  });

  test("gRPC streams: a presenter who steers and two viewers", () => {
    const flags = ["--tls-roots", file("cert.pem"), "--viewers", "2", "--size", "320x180", "--json"];
    let least = 0;
    // On a slow machine a viewer may get no frame within the shortest duration, so the test tries longer durations.
    for (let seconds = 1; least === 0 && seconds <= 1000; seconds *= 10) {
      const load = spawnSync(BINARY, ["load", `localhost:${port}`, ...flags, "--seconds", String(seconds)], { encoding: "utf8" });
      assert.equal(load.status, 0, load.stderr);
      const { fps_min, errors } = JSON.parse(load.stdout);
      assert.equal(errors, 0);
      least = fps_min;
    }
    assert.ok(least > 0);
  });

  test("the server knows clients by the address that the proxy saw, whatever they say themselves", async () => {
    const body = Buffer.from([0, 0, 0, 0, 7, 10, 5, ...Buffer.from("wrong")]);
    await new Promise((resolve, reject) => {
      const request = https.request(
        {
          host: "127.0.0.1",
          port,
          localAddress: "127.0.0.3",
          method: "POST",
          path: "/thunderhead.v1.ThunderheadService/CloseSession",
          headers: { "content-type": "application/grpc-web+proto", "x-forwarded-for": "203.0.113.9" },
          rejectUnauthorized: false,
        },
        (answer) => answer.resume().once("end", resolve),
      );
      request.once("error", reject);
      request.end(body);
    });
    await until("the refusal in the audit", async () =>
      /peer="127\.0\.0\.3:0" act=CloseSession verdict=refused/.test(server.log()),
    );
    assert.doesNotMatch(server.log(), /203\.0\.113\.9/);
  });

  test("too many requests of one address are refused with 429", async () => {
    const client = http2.connect(`https://127.0.0.1:${port}`, { rejectUnauthorized: false });
    await until("a refusal", async () => {
      const answers = (await ask(client, 50)).map((headers) => headers[":status"]);
      assert.ok(answers.every((code) => code === 200 || code === 429), String(answers));
      return answers.includes(429);
    });
    client.close();
  });
});

describe("systemd", { skip: existsSync("/usr/bin/systemd-analyze") ? false : "needs Debian's systemd" }, () => {
  test("the unit is sound and exposes little", () => {
    const unit = file("thunderhead.service");
    cpSync(`${ROOT}deploy/systemd/thunderhead.service`, unit);
    // The program is not installed on this machine, so the unit gets the built program's path.
    writeFileSync(unit, readFileSync(unit, "utf8").replace("/opt/thunderhead/bin/thunderhead", BINARY));
    const verify = spawnSync("systemd-analyze", ["verify", unit], { encoding: "utf8" });
    assert.equal(verify.status, 0, verify.stderr);
    assert.equal(verify.stderr.trim(), "");
    // The measured exposure is 1.7, on a scale from 0 (good) to 10. The threshold is ten times the permitted exposure.
    const security = spawnSync("systemd-analyze", ["security", "--offline=true", "--threshold=20", unit], {
      encoding: "utf8",
    });
    assert.equal(security.status, 0, security.stdout.slice(-400));
  });
});

describe("Prometheus", { skip: existsSync("/usr/bin/promtool") ? false : "needs Debian's prometheus" }, () => {
  test("the rules are sound and name metrics that there are", () => {
    const rules = `${ROOT}deploy/prometheus/alerts.yaml`;
    const check = spawnSync("/usr/bin/promtool", ["check", "rules", rules], { encoding: "utf8" });
    assert.equal(check.status, 0, check.stderr);
    const sources = ["server/telemetry/exposition.cc", "server/app/operation.cc"].map((path) => readFileSync(ROOT + path, "utf8"));
    for (const name of new Set(readFileSync(rules, "utf8").match(/thunderhead_[a-z_]+/g))) {
      const short = name.replace(/_bucket$/, "");
      const bare = short.replace("thunderhead_", "");
      assert.ok(
        sources.some((text) => text.includes(`"${short}"`)) || sources[1].includes(`add("${bare}"`),
        `${name} is not exported`,
      );
    }
  });
});

describe("Compose", () => {
  test("its command has flags that there are, and it mounts what the Dockerfile makes", () => {
    const compose = readFileSync(`${ROOT}deploy/compose/compose.yaml`, "utf8");
    const help = execFileSync(BINARY, ["serve", "--help"], { encoding: "utf8" });
    const flags = compose.match(/^\s+- (--[a-z-]+)$/gm).map((line) => line.trim().slice(2));
    assert.ok(flags.length >= 5);
    for (const flag of flags) assert.ok(help.includes(`${flag} `), flag);
    const dockerfile = readFileSync(`${ROOT}Dockerfile`, "utf8");
    assert.match(dockerfile, /\/var\/lib\/thunderhead/);
    const python = spawnSync("python3", ["-c", "import sys, yaml; yaml.safe_load(sys.stdin)"], { input: compose, encoding: "utf8" });
    if (!/No module named|ENOENT/.test(`${python.stderr}${python.error ?? ""}`)) assert.equal(python.status, 0, python.stderr);
  });
});
