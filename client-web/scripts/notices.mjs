// Writes dist/third-party-notices.txt: the licences of the npm packages that the page contains, according to the lock
// file. Debian's package and the image ship it with the page. The notices of the programs are another file, which
// cmake/notices.cmake writes. The script fails for a package without a licence.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const lock = JSON.parse(readFileSync("package-lock.json", "utf8"));
const notices = [
  "Thunderhead's page contains the npm packages below, each under its licence.",
];
for (const [folder, found] of Object.entries(lock.packages)) {
  // The first entry is the page itself. Tools that only build or test the page are marked "dev".
  if (folder === "" || found.dev) continue;
  const file = readdirSync(folder).find((name) => /^(licen[cs]e|copying)/i.test(name));
  const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const licence = found.license ?? about.license;
  // Some packages only name their licence. If it is Apache-2.0, the text is taken from this project's LICENSE file,
  // which has the same licence.
  const path = file !== undefined ? join(folder, file) : /Apache-2\.0/.test(licence) ? "../LICENSE" : undefined;
  const text = path === undefined ? `The package has no more than this name; see ${about.homepage}` : readFileSync(path, "utf8");
  if (path === undefined && licence === undefined) {
    throw new Error(`${folder} names no licence; ask its authors, or use another package`);
  }
  notices.push(`${"=".repeat(80)}\n${about.name} ${about.version} (${licence ?? "see below"})\n`, text.trim());
}
writeFileSync("dist/third-party-notices.txt", `${notices.join("\n\n")}\n`);
