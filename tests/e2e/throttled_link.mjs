// A TCP proxy that imitates a link of limited speed and some latency in front of a server. It can also cut the link,
// silence it, or lose its connections without notice. Chromium's own emulation does not affect WebSockets.
import { createServer, connect } from "node:net";

const SLICE_BYTES = 1460;
// Delay in milliseconds between the last bytes of a connection and its end.
const END_MS = 5;
// Interval in milliseconds at which a silent link checks whether it may carry bytes again.
const SILENCE_MS = 20;

// Carries bytes in one direction: they leave at the link's speed and arrive after half its round trip. Like a router it
// buffers little, so a sender is held back once the buffer is full.
function carry(from, to, bytesPerMs, delayMs, link, pair) {
  const BUFFER_BYTES = 16 * 1024;
  let freeAt = 0;
  let held = 0;
  // A queue keeps the bytes in order. Timers of different lengths would not.
  const onTheirWay = [];
  const arrive = () => {
    if (link.silent) return setTimeout(arrive, SILENCE_MS);
    const slice = onTheirWay.shift();
    if (to.writable && !pair.lost) to.write(slice);
  };
  from.on("data", (data) => {
    for (let at = 0; at < data.length; at += SLICE_BYTES) {
      const slice = data.subarray(at, at + SLICE_BYTES);
      freeAt = Math.max(freeAt, performance.now()) + slice.length / bytesPerMs;
      held += slice.length;
      setTimeout(() => {
        held -= slice.length;
        if (held < BUFFER_BYTES) from.resume();
      }, freeAt - performance.now());
      onTheirWay.push(slice);
      setTimeout(arrive, freeAt + delayMs - performance.now());
    }
    if (held >= BUFFER_BYTES) from.pause();
  });
  const end = () => {
    if (!pair.lost) to.end();
  };
  from.on("end", () => setTimeout(end, Math.max(0, freeAt - performance.now()) + delayMs + END_MS));
  from.on("error", () => {
    if (!pair.lost) to.destroy();
  });
}

// Returns the link's port and the functions that control it.
// - cut: breaks connections and refuses new ones.
// - silence: keeps connections, but nothing arrives.
// - lose: like silence, but the present connections never carry bytes or their closing again.
// - heal: accepts new connections again, and lets silent connections carry bytes again. Lost connections stay lost.
// - close: closes the link.
export async function throttledLink({ port, kbitPerS, roundTripMs }) {
  const sockets = new Set();
  // Each connection from a client to the server consists of two sockets.
  const pairs = new Set();
  const link = { cut: false, silent: false };
  const breakAll = () => {
    for (const socket of sockets) socket.destroy();
  };
  const server = createServer({ allowHalfOpen: true, noDelay: true }, (near) => {
    if (link.cut) return near.destroy();
    const far = connect({ port, host: "127.0.0.1", allowHalfOpen: true, noDelay: true });
    const pair = { lost: false };
    pairs.add(pair);
    for (const socket of [near, far]) {
      sockets.add(socket);
      socket.on("close", () => {
        sockets.delete(socket);
        pairs.delete(pair);
      });
    }
    carry(near, far, kbitPerS / 8, roundTripMs / 2, link, pair);
    carry(far, near, kbitPerS / 8, roundTripMs / 2, link, pair);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    port: server.address().port,
    cut: () => {
      link.cut = true;
      breakAll();
    },
    silence: () => {
      link.silent = true;
    },
    lose: () => {
      link.silent = true;
      for (const pair of pairs) pair.lost = true;
    },
    heal: () => {
      link.cut = false;
      link.silent = false;
    },
    close: () => {
      breakAll();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}
