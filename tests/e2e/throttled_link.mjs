// A link of limited speed and some length before a server, that can also be cut, fall silent or lose its connections without a
// word: a TCP proxy. Chromium's own emulation leaves WebSockets alone.
import { createServer, connect } from "node:net";

const SLICE_BYTES = 1460;
// After the last slice.
const END_MS = 5;
// How often a silent link is looked at.
const SILENCE_MS = 20;

// One direction: bytes leave at the link's speed and arrive after half its round trip. Like a router it holds little, so a
// sender is held back once that is full.
function carry(from, to, bytesPerMs, delayMs, link, pair) {
  const BUFFER_BYTES = 16 * 1024;
  let freeAt = 0;
  let held = 0;
  // In order, which timers of different lengths do not keep.
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

// Returns its port; functions that cut it (connections break, new ones are refused), silence it (connections stay, nothing
// arrives), lose it (the same, but what it carries now never arrives, not even that a connection was closed) and heal it; and
// the one that closes it.
export async function throttledLink({ port, kbitPerS, roundTripMs }) {
  const sockets = new Set();
  // Connections from end to end.
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
