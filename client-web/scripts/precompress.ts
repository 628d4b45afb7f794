// Writes a gzip file beside each text file of the built page, named as the file with ".gz" added. The
// gateway sends those to browsers that accept gzip, so nothing is compressed per request.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";

const TEXT = /\.(js|mjs|css|html|svg|json|map|wasm|txt|webmanifest)$/;

// A file that gzip does not make smaller gets none beside it.
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
    // When every file has been written, those of public/ too: a gzip file older than its original is not sent.
    closeBundle: () => precompressFolder(folder),
  };
}
