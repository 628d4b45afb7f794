// Writes a gzip file next to each text file of the built page, with ".gz" added to its name. The
// gateway sends these files to browsers that accept gzip, so it compresses nothing per request.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";

const TEXT = /\.(js|mjs|css|html|svg|json|map|wasm|txt|webmanifest)$/;

// Writes the gzip files of a folder. Omits a gzip file that would not be smaller than its original.
export function precompressFolder(folder: string): void {
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) {
      precompressFolder(path);
    } else if (entry.isFile() && TEXT.test(entry.name)) {
      const text = readFileSync(path);
      const compressed = gzipSync(text, { level: 9 });
      if (compressed.length < text.length) writeFileSync(`${path}.gz`, compressed);
    }
  }
}

export function precompress(): Plugin {
  let folder = "";
  return {
    name: "precompress",
    apply: "build",
    configResolved: (config) => {
      folder = join(config.root, config.build.outDir);
    },
    // This runs after every file was written, including those of public/. A gzip file that is older
    // than its original is not sent.
    closeBundle: () => precompressFolder(folder),
  };
}
