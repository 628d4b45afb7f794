// End-to-end test of a folder that a model still writes to: new times appear on the time bar automatically.
import assert from "node:assert/strict";
import { appendFileSync, mkdtempSync, renameSync, rmSync, unlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { cloudFile } from "./cloud_file.mjs";
import { launchBrowser, listenForErrors, rested, screenshot, until } from "./driver.mjs";
import { difference, grabCanvas } from "./pictures.mjs";
import { freePort, startServer } from "./server_process.mjs";

let folder;
let server;
let browser;
let page;
const complaints = [];

const fileOf = (hour) => join(folder, `ball_${String(hour).padStart(2, "0")}.nc`);
const validTime = () => page.getByTestId("valid-time").innerText();

async function awaitValidTime(pattern) {
  try {
    await until("the time", async () => pattern.test(await validTime()));
  } catch {
    assert.fail(`the time bar says "${await validTime()}", not ${pattern}\n${server.log()}`);
  }
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-e2e-"));
  writeFileSync(fileOf(1), cloudFile(1));
  writeFileSync(fileOf(2), cloudFile(2));
  server = await startServer({
    httpPort: await freePort(),
    grpcPort: await freePort(),
    data: folder,
    more: ["--settle-seconds", "0.3", "--rescan-seconds", "0.5"],
  });
  browser = await launchBrowser();
  page = await (await browser.newContext({ viewport: { width: 900, height: 560 } })).newPage();
  listenForErrors(page, complaints);
  await page.goto(server.url);
});

after(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

test("a session that shows the newest time goes on to a newer one when its file is complete", async () => {
  await awaitValidTime(/02:00.*2 of 2/s);
  const whole = cloudFile(3);
  writeFileSync(fileOf(3), whole.subarray(0, whole.length / 2));
  // A truncated file does not become a time of the storm, but a complete file that is written later does.
  writeFileSync(fileOf(0), cloudFile(0));
  await awaitValidTime(/02:00.*3 of 3/s);
  appendFileSync(fileOf(3), whole.subarray(whole.length / 2));
  await awaitValidTime(/03:00.*4 of 4/s);
  await screenshot("catalogue-newest", page);
});

test("a session with a time selected keeps it when others come", async () => {
  await page.getByTestId("time").fill("2");
  await awaitValidTime(/02:00.*3 of 4/s);
  writeFileSync(fileOf(4), cloudFile(4));
  await awaitValidTime(/02:00.*3 of 5/s);
  writeFileSync(fileOf(1.5), cloudFile(1.5));
  await awaitValidTime(/02:00.*4 of 6/s);
});

test("a file that is replaced keeps its time, and its picture comes by itself", async () => {
  await rested(page);
  const before = await grabCanvas(page);
  const fresh = `${folder}.nc`;
  writeFileSync(fresh, cloudFile(2, 1200));
  renameSync(fresh, fileOf(2));
  // The previous picture may be drawn again meanwhile, because the new earlier time changes the scene.
  await until("a smaller cloud", async () => {
    assert.match(await validTime(), /02:00.*4 of 6/s, "at any time");
    await rested(page);
    return difference(before, await grabCanvas(page)) > 1;
  });
});

test("a time that is deleted while it is shown says so, and others that are deleted go", async () => {
  unlinkSync(fileOf(2));
  unlinkSync(fileOf(0));
  await awaitValidTime(/02:00.*3 of 5.*deleted, shown from memory/s);
  await screenshot("catalogue-deleted", page);
  assert.deepEqual(complaints, []);
});
