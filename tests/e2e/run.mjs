// Checks the browser test's prerequisites, reports what is missing, and runs it.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
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

const run = spawnSync(process.execPath, ["--test", "page.test.mjs", "class.test.mjs", "catalogue.test.mjs", "deploy.test.mjs", "operation.test.mjs", "sign_in.test.mjs", "video.test.mjs", "tools.test.mjs", "questions.test.mjs", "manners.test.mjs"], { cwd: here, stdio: "inherit" });
process.exit(run.status ?? 1);
