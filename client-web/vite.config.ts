import { defineConfig } from "vitest/config";
import { precompress } from "./scripts/precompress";

// A running server for `npm run dev` to pass calls on to.
const server = process.env.THUNDERHEAD_URL ?? "http://127.0.0.1:8080";

export default defineConfig({
  // Relative addresses, so that the page also works below a path behind a proxy.
  base: "./",
  plugins: [precompress()],
  build: { outDir: "dist", emptyOutDir: true, target: "es2022" },
  server: {
    proxy: {
      "^/thunderhead\\.v1\\.": {
        target: server,
        changeOrigin: true,
        ws: true,
        // The server accepts a WebSocket only from its own origin, so the proxy replaces the
        // origin.
        configure: (proxy) =>
          proxy.on("proxyReqWs", (request) => request.setHeader("origin", new URL(server).origin)),
      },
    },
  },
  test: {
    include: ["test/**/*.test.ts"],
    environment: "node",
    // Limits against hangs. They say nothing about speed.
    testTimeout: 600_000,
    hookTimeout: 600_000,
  },
});
