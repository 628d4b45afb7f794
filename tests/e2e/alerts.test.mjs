// Tests of the Prometheus alerts (deploy/prometheus/alerts.yaml) on made-up time series, with promtool: `node --test
// alerts.test.mjs`. They need no browser and no server.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { test } from "node:test";

const PROMTOOL = "/usr/bin/promtool";
const here = fileURLToPath(new URL(".", import.meta.url));

test("each alarm fires when it should, and none on a server that is well", {
  skip: existsSync(PROMTOOL) ? false : "needs Debian's package prometheus (deploy/packages/test.txt)",
}, () => {
  const run = spawnSync(PROMTOOL, ["test", "rules", "alerts.test.yaml"], { cwd: here, encoding: "utf8" });
  assert.equal(run.status, 0, run.stdout + run.stderr);
});

test("each alarm is seen to fire and to be silent", () => {
  const alarms = readFileSync(`${here}../../deploy/prometheus/alerts.yaml`, "utf8").match(/(?<=alert: )\w+/g);
  const tests = readFileSync(`${here}alerts.test.yaml`, "utf8");
  assert.ok(alarms.length >= 13);
  for (const alarm of alarms) {
    assert.match(tests, new RegExp(`alertname: ${alarm}\\n\\s+exp_alerts`), `${alarm} is never seen to fire`);
    assert.match(tests, new RegExp(`alertname: ${alarm}\\}`), `${alarm} is never seen to be silent`);
  }
});
