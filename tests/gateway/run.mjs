// Checks the prerequisites of the stock clients' test, reports missing ones, generates the messages' code and runs the
// test.
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const root = fileURLToPath(new URL("../../", import.meta.url));
const server = process.env.THUNDERHEAD_ECHO_SERVER ?? `${root}build/release/bin/gateway_echo_server`;
const protoc = process.env.THUNDERHEAD_PROTOC ?? "/usr/bin/protoc";
const { dependencies } = JSON.parse(readFileSync(`${here}package.json`, "utf8"));

const needed = [
  ...Object.keys(dependencies).map((name) => [`${here}node_modules/${name}`, "run npm install in tests/gateway"]),
  [server, "build the target gateway_echo_server"],
  [protoc, "install Debian's package protobuf-compiler"],
];
const missing = needed.filter(([path]) => !existsSync(path));
for (const [path, remedy] of missing) console.error(`The stock clients' test needs ${path}: ${remedy}.`);
if (missing.length > 0) process.exit(1);

// The folder is below node_modules, so that the generated code finds its runtime and git ignores the code.
const generated = mkdtempSync(`${here}node_modules/.generated-`);
try {
  // Node.js 18 treats a .js file as a module only if a package.json says so.
  writeFileSync(`${generated}/package.json`, '{ "type": "module" }');
  const plugin = `--plugin=protoc-gen-es=${here}node_modules/.bin/protoc-gen-es`;
  const made = spawnSync(
    protoc,
    [
      ...["-I", here, "-I", `${root}proto`, plugin, `--es_out=${generated}`, "--es_opt=target=js"],
      ...["echo.proto", "google/rpc/status.proto", "google/rpc/error_details.proto"],
    ],
    { stdio: "inherit" },
  );
  if (made.status !== 0) throw new Error("protoc could not generate the messages' code");
  const run = spawnSync(process.execPath, ["--test", "stock_clients.test.mjs"], {
    cwd: here,
    stdio: "inherit",
    env: { ...process.env, THUNDERHEAD_ECHO_SERVER: server, THUNDERHEAD_GENERATED: generated },
  });
  process.exitCode = run.status ?? 1;
} finally {
  rmSync(generated, { recursive: true });
}
