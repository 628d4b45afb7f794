// Tests the library's example against the real server: the picture that it saves, and its message if no picture
// arrives.
import assert from "node:assert/strict";
import { execFile, execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BINARY, freePort, ROOT, startServer } from "../../tests/e2e/server_process.mjs";

const PROGRAM = process.env.THUNDERHEAD_SAVE_PICTURE ?? `${ROOT}build/desktop/bin/save_picture`;

let folder;
let server;
let grpcPort;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-example-"));
  grpcPort = await freePort();
  server = await startServer({ httpPort: await freePort(), grpcPort });
});

after(async () => {
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

function run(...words) {
  return new Promise((resolve) => {
    execFile(PROGRAM, words, (error, _, said) => resolve({ code: error?.code ?? 0, said }));
  });
}

test("it saves the picture that render makes, in full quality", async () => {
  const file = join(folder, "storm.jpg");
  assert.deepEqual(await run(`127.0.0.1:${grpcPort}`, file), { code: 0, said: "" });
  const rendered = join(folder, "rendered.jpg");
  execFileSync(BINARY, ["render", `${ROOT}samples/supercell.nc`, "--size", "640x400", "-o", rendered], { stdio: "ignore" });
  assert.ok(readFileSync(file).equals(readFileSync(rendered)), "the pictures differ");
});

test("an address that is none is named", async () => {
  const file = join(folder, "none.jpg");
  const { code, said } = await run("nowhere", file);
  assert.equal(code, 64);
  assert.match(said, /'nowhere' is not HOST:PORT/);
  assert.ok(!existsSync(file));
});
