// Runs the C++ test server as a child process.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createInterface } from "node:readline";

export async function startEchoServer() {
  const child = spawn(process.env.THUNDERHEAD_ECHO_SERVER, [], { stdio: ["pipe", "pipe", "inherit"] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const nextLine = async () => {
    const { value, done } = await lines.next();
    if (done) throw new Error("the echo server ended");
    return JSON.parse(value);
  };
  const { port } = await nextLine();
  return {
    url: `http://localhost:${port}`,
    // Returns the counts of the server's calls so far.
    async record() {
      child.stdin.write("\n");
      return nextLine();
    },
    async stop() {
      const ended = once(child, "exit");
      child.stdin.end();
      const [code] = await ended;
      if (code !== 0) throw new Error(`the echo server ended with ${code}`);
    },
  };
}
