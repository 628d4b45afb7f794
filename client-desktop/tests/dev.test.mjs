// `./dev desktop` with a program that prints its arguments: HOST:PORT is found among the flags, or added.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../../", import.meta.url));
let folder;

function put(path, text, mode = 0o644) {
  mkdirSync(dirname(join(folder, path)), { recursive: true });
  writeFileSync(join(folder, path), text, { mode });
}

before(() => {
  folder = mkdtempSync(join(tmpdir(), "thunderhead-dev-"));
  copyFileSync(`${ROOT}dev`, join(folder, "dev"));
  put("deploy/packages/desktop.txt", "");
  put("build/desktop/build.ninja", "");
  put("build/desktop/bin/thunderhead-desktop", "#!/bin/sh\nprintf '%s\\n' \"$@\"\n", 0o755);
  put("bin/cmake", "#!/bin/sh\n", 0o755);
});

after(() => rmSync(folder, { recursive: true, force: true }));

function argumentsOf(...words) {
  const env = { ...process.env, PATH: `${join(folder, "bin")}:${process.env.PATH}` };
  const said = execFileSync("bash", [join(folder, "dev"), "desktop", ...words], { env, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
  return said.split("\n").slice(0, -1);
}

const OWN = "localhost:50051";

test("without HOST:PORT it is that of ./dev serve", () => {
  for (const words of [[], ["--kiosk"], ["--name", "Room 5:2"], ["--key", "a:1", "--full-screen"], ["--views", "a:1.json", "b.json"], ["--name=a:1"]]) {
    assert.deepEqual(argumentsOf(...words), [OWN, ...words]);
  }
});

test("HOST:PORT is found before, between and after flags", () => {
  const server = "storms.example.org:50051";
  for (const words of [
    [server],
    [server, "--name", "Wall"],
    ["--name", "Wall", server],
    ["--kiosk", server, "--views", "a.json"],
    ["--views", "a.json", "--kiosk", server],
    ["--tls-ca=ca.pem", server],
    ["[::1]:50051"],
  ]) {
    assert.deepEqual(argumentsOf(...words), words);
  }
});
