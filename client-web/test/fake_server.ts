// Test support: an HTTP server for the built page and the fake service over gRPC-Web and WebSocket.
// It has the flags of `thunderhead serve`. With it the page and the browser tests run without the
// real program:
//   npm run fake -- serve --http 127.0.0.1:8099 --page dist
import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { connectNodeAdapter } from "@connectrpc/connect-node";
import { WebSocketServer } from "ws";
import { serveInteract } from "./fake_bridge";
import { FakeService } from "./fake_service";
import { drawFakeStorm } from "./fake_storm";

const TYPES: Readonly<Record<string, string>> = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
};

function flag(name: string, otherwise: string): string {
  const at = process.argv.indexOf(`--${name}`);
  return process.argv[at + 1] !== undefined && at > 0
    ? (process.argv[at + 1] ?? otherwise)
    : otherwise;
}

const [host, port] = flag("http", "127.0.0.1:8099").split(":");
const page = flag("page", "dist");
const service = new FakeService(drawFakeStorm, true);
const bridge = connectNodeAdapter({ routes: service.routes, grpc: false, connect: false });

const server = createServer((request, response) => {
  const path = normalize(new URL(request.url ?? "/", "http://fake").pathname);
  if (path.startsWith("/thunderhead.v1.")) {
    bridge(request, response);
    return;
  }
  const file = join(page, path === "/" ? "index.html" : path);
  if (!existsSync(file) || !statSync(file).isFile()) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
  createReadStream(file).pipe(response);
});

const sockets = new WebSocketServer({ noServer: true, handleProtocols: () => "grpc-websocket.v1" });
server.on("upgrade", (request, socket, head) => {
  sockets.handleUpgrade(request, socket, head, (opened) => serveInteract(service, opened));
});

server.listen(Number(port), host, () => {
  process.stdout.write(`Serving a fake storm on http://${host}:${port}/\n`);
});
