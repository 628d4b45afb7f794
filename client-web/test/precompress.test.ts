import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { gunzipSync } from "node:zlib";
import { afterEach, beforeEach, expect, test } from "vitest";
import { precompressFolder } from "../scripts/precompress";

let folder: string;

beforeEach(() => {
  folder = mkdtempSync(join(tmpdir(), "precompress-"));
});

afterEach(() => rmSync(folder, { recursive: true }));

test("text files get a gzip file beside them, in folders too", () => {
  const text = "storm ".repeat(100);
  mkdirSync(join(folder, "assets"));
  for (const name of ["index.html", "icon.svg", "assets/a.js", "assets/a.css"]) {
    writeFileSync(join(folder, name), text);
  }
  precompressFolder(folder);
  for (const name of ["index.html", "icon.svg", "assets/a.js", "assets/a.css"]) {
    expect(gunzipSync(readFileSync(join(folder, `${name}.gz`))).toString()).toBe(text);
  }
});

test("images, and what gzip makes no smaller, stay alone", () => {
  writeFileSync(join(folder, "picture.png"), "storm ".repeat(100));
  writeFileSync(join(folder, "short.js"), "1");
  precompressFolder(folder);
  expect(existsSync(join(folder, "picture.png.gz"))).toBe(false);
  expect(existsSync(join(folder, "short.js.gz"))).toBe(false);
});
