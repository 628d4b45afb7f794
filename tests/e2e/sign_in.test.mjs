// Tests of a server that requires tokens and TLS, in a real browser. No storm is visible without a token, and a
// viewer's token permits only watching.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { digest, writeCertificate } from "./credentials.mjs";
import { launchBrowser, rested, screenshot, until } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const VIEWPORT = { width: 640, height: 400 };
const TOKENS = { teacher: "teacher-token-5f2c", student: "student-token-91aa" };

let folder;
let server;
let browser;

const file = (name) => join(folder, name);
const audit = () => readFileSync(file("audit.log"), "utf8");
// Waits until the audit log contains the line, because a separate thread of the server writes the log.
const audited = (line) => until(`${line} in the audit`, () => line.test(audit()));

function writeTokens(lines) {
  writeFileSync(file("tokens"), `${lines.join("\n")}\n`, { mode: 0o600 });
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-sign-in-"));
  writeTokens([
    `teacher presenter ${digest(TOKENS.teacher)}`,
    `student viewer ${digest(TOKENS.student)}`,
  ]);
  writeCertificate(file("cert.pem"), file("key.pem"));
  server = await startServer({
    httpPort: await freePort(),
    grpcPort: await freePort(),
    more: [
      ...["--auth", "tokens", file("tokens"), "--tls-cert", file("cert.pem"), "--tls-key", file("key.pem")],
      ...["--audit-log", file("audit.log")],
    ],
  });
  browser = await launchBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

async function openPage(url = server.url) {
  const context = await browser.newContext({ viewport: VIEWPORT, ignoreHTTPSErrors: true });
  const page = await context.newPage();
  await page.goto(url);
  return page;
}

async function signIn(page, token) {
  await page.getByTestId("token").fill(token);
  await page.getByRole("button", { name: "Sign in" }).click();
}

const visible = (page, id) => page.getByTestId(id).waitFor();
const asked = (page) => page.getByTestId("sign-in").isVisible();

let teacher;

test("nobody sees a storm without a token, or with a wrong one", async () => {
  assert.match(server.url, /^https:/);
  teacher = await openPage();
  await visible(teacher, "sign-in");
  await screenshot("sign-in", teacher);
  await signIn(teacher, "wrong-token-77");
  await until("the refusal of a wrong token", async () =>
    /does not know this token/.test(await teacher.getByTestId("sign-in").innerText()),
  );
  await audited(/identity="" role=none peer="127\.0\.0\.1:\d+" act=CreateSession verdict=refused reason="TOKEN_MISSING"/);
  await audited(/reason="TOKEN_UNKNOWN"/);
});

test("a presenter's token opens a session, also after a reload", async () => {
  await signIn(teacher, TOKENS.teacher);
  await rested(teacher);
  assert.equal(await asked(teacher), false);
  await teacher.reload();
  await rested(teacher);
  assert.equal(await asked(teacher), false);
  await audited(/identity="teacher" role=presenter peer="127\.0\.0\.1:\d+" act=CreateSession verdict=allowed/);
});

test("a viewer's token watches by the link, and opens nothing itself", async () => {
  const student = await openPage(teacher.url());
  await visible(student, "sign-in");
  await signIn(student, TOKENS.student);
  await rested(student);
  const alone = await openPage();
  await visible(alone, "sign-in");
  await signIn(alone, TOKENS.student);
  await until("the refusal of the role", async () =>
    /not for the role of viewer/.test(await alone.getByTestId("sign-in").innerText()),
  );
  await audited(/identity="student" role=viewer .* act=CreateSession verdict=refused reason="ROLE_MAY_NOT"/);
});

test("a token that is taken away ends what it opened", async () => {
  writeTokens([`student viewer ${digest(TOKENS.student)}`]);
  await visible(teacher, "sign-in");
  for (const token of ["wrong-token-77", ...Object.values(TOKENS)]) assert.ok(!audit().includes(token));
});
