// Writes dist/third-party-notices.txt: the licences of the npm packages that the page contains, according to the lock
// file. Debian's package and the image ship it with the page. The script fails for a package without a licence text.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const lock = JSON.parse(readFileSync("package-lock.json", "utf8"));
const notices = [
  "Thunderhead's page contains the npm packages below, each under its licence.",
  "The server and the native client contain no third-party code: they use Debian's packages, whose licences are in",
  "/usr/share/doc/PACKAGE/copyright.",
];
for (const [folder, found] of Object.entries(lock.packages)) {
  // The first entry is the page itself. Tools that only build or test the page are marked "dev".
  if (folder === "" || found.dev) continue;
  const file = readdirSync(folder).find((name) => /^(licen[cs]e|copying)/i.test(name));
  if (file === undefined) throw new Error(`${folder} has no licence's text; ask its authors, or use another package`);
  const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  notices.push(
    `${"=".repeat(80)}\n${about.name} ${about.version} (${found.license ?? about.license ?? "see below"})\n`,
    readFileSync(join(folder, file), "utf8").trim(),
  );
}
writeFileSync("dist/third-party-notices.txt", `${notices.join("\n\n")}\n`);
