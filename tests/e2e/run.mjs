// Checks the prerequisites of the browser tests, reports missing ones, and runs the named test files, or all.
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const root = fileURLToPath(new URL("../../", import.meta.url));

const needed = [
  [`${here}node_modules/playwright-core`, "run npm install in tests/e2e"],
  [`${root}client-web/dist/index.html`, "run npm install and npm run build in client-web"],
  [process.env.THUNDERHEAD_CHROMIUM ?? "/usr/bin/chromium", "install Debian's package chromium"],
  [process.env.THUNDERHEAD_BINARY ?? `${root}build/release/bin/thunderhead`, "build the target thunderhead"],
];

const missing = needed.filter(([path]) => !existsSync(path));
for (const [path, remedy] of missing) console.error(`The browser test needs ${path}: ${remedy}.`);
if (missing.length > 0) process.exit(1);

// Runs two files at a time, because tests mostly wait for pictures.
const named = process.argv.slice(2);
const files = named.length > 0 ? named : readdirSync(here).filter((file) => file.endsWith(".test.mjs"));
const run = spawnSync(process.execPath, ["--test", "--test-concurrency=2", ...files], { cwd: here, stdio: "inherit" });
process.exit(run.status ?? 1);
