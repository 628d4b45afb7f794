"""Makes mutated calls of every rpc by gRPC, gRPC-Web and WebSocket, and checks the server.

The server must not crash and must answer neither INTERNAL nor UNKNOWN. Every answer must be parsable. After a warm-up
the server's memory must stay the same. `./dev soak` runs it, and ctest runs it with few calls. Needs python3-protobuf
and protoc.
"""

import argparse
import base64
import collections
import dataclasses
import importlib.util
import json
import multiprocessing
import multiprocessing.connection
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# The exit code that ctest counts as skipped.
SKIPPED = 77
if importlib.util.find_spec("google.protobuf") is None or shutil.which("protoc") is None:
    print("SKIPPED: python3-protobuf or protobuf-compiler is not installed; ./dev install python does that")
    sys.exit(SKIPPED)

from messages import Messages, delimited, load_schema  # noqa: E402
from transports import HANG_LIMIT_S, Answer, Grpc, GrpcWeb, WebSocket, websocket_frame  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
# Calls that cost much more than others are made less often, so that they do not take most of the time.
SELDOM = {"RenderImage": 0.1, "RenderImageWithProgress": 0.1, "GenerateCloud": 0.05, "CreateRenderJob": 0.05, "Interact": 0.5,
          "WatchFrames": 0.3, "WatchRenderJob": 0.3}
# The limits are small, so that the server's tables are full when the warm-up ends.
SERVER_FLAGS = ["--max-requests", "0", "--max-calls-each", "0", "--max-sessions", "24", "--max-sessions-each", "24", "--max-picture", "0.003",
                "--max-samples", "0.1", "--max-render-time", "0.5", "--max-jobs", "10", "--max-jobs-each", "10", "--max-job-pictures", "20",
                "--max-kept-pictures", "50", "--jobs-quota", "0.01", "--memory-budget", "128MiB"]
GRPC_STATUSES = ["OK", "CANCELLED", "UNKNOWN", "INVALID_ARGUMENT", "DEADLINE_EXCEEDED", "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED",
                 "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION", "ABORTED", "OUT_OF_RANGE", "UNIMPLEMENTED", "INTERNAL", "UNAVAILABLE",
                 "DATA_LOSS", "UNAUTHENTICATED"]
UNKNOWN, INTERNAL = 2, 13
# Matches answers of gRPC's own library to headers that no gRPC client sends. Thunderhead never sees such calls.
OF_THE_LIBRARY = re.compile(r"(Bad|Missing) :?(te|path|method|scheme|status|authority) header")
CONTENT_TYPES = ["", "application/grpc", "application/grpc+json", "application/grpc-web", "application/grpc-web-text", "application/json",
                 "application/grpc-web+proto; charset=utf-8", "APPLICATION/GRPC-WEB+PROTO", "text/plain", "application/grpcx", "*/*",
                 "application/grpc;", "\xff", "application/grpc-web+proto,application/grpc-web+proto"]
SHORT_TIMEOUTS = ["0n", "1n", "1u", "1m", "00000001m"]
TIMEOUTS = ["", "99999999H", "123456789S", "-1S", "1.5S", "1", "S", "\xff", "1 S", *SHORT_TIMEOUTS]
NAMES = ["x-a", "x-a-bin", "authorization", "grpc-encoding", "grpc-accept-encoding", "grpc-status", "grpc-message", "grpc-tags-bin",
         "grpc-trace-bin", "grpc-previous-rpc-attempts", "grpc-retry-pushback-ms", "lb-token", "lb-cost-bin", "user-agent", "x-forwarded-for",
         "cookie", "te", "host", "origin", "content-length", "accept-encoding", "grpc-internal-encoding-request", "X-Upper", "x a", "x\xe9",
         ":odd", "", "-bin", "x" * 300, "grpc-status-details-bin", "x-b", "traceparent", "date"]
VALUES = ["", "a", "gzip", "deflate", "identity", "!!!", "AAAA", "AAAA,BBBB", "=", "Bearer x", "\xff\xfe", "\t", "a" * 4000, "a" * 9000, "0", "-1", "%00",
          "\x7f", "1.2.3.4, 5.6.7.8", "http://evil.example", "trailers", "null"]


@dataclasses.dataclass
class Call:
    """Everything that is sent for one call."""

    transport: str
    path: str
    headers: list[tuple[str, str]]
    pieces: list[bytes]
    half_close: bool
    most: int

    def text(self) -> str:
        fields = dataclasses.asdict(self) | {"pieces": [base64.b64encode(piece).decode() for piece in self.pieces]}
        return json.dumps(fields)

    @staticmethod
    def of(text: str) -> "Call":
        fields = json.loads(text)
        return Call(**fields | {"pieces": [base64.b64decode(piece) for piece in fields["pieces"]]})


class Caller:
    """Makes random calls, one after another."""

    def __init__(self, rpcs: list, ports: dict[str, int], seed: str) -> None:
        self.chance = random.Random(seed)
        self.messages = Messages(self.chance)
        self.rpcs = rpcs
        self.intact = True  # whether the messages of the last call were left unmodified
        self.weights = [SELDOM.get(rpc.name, 1.0) for rpc in rpcs]
        self.transports = {"grpc": Grpc(ports["grpc"]), "web": GrpcWeb(ports["http"]), "websocket": WebSocket(ports["http"])}

    def odd(self, share: float) -> bool:
        return self.chance.random() < share

    def make(self, rpc) -> Call:
        chance, transport = self.chance, self.chance.choice([*self.transports])
        self.messages.used.clear()
        number = chance.randint(1, 6) if rpc.client_streaming else 1
        if self.odd(0.01):
            number = chance.choice([0, 2])
        damage = chance.choice([0, 0, 0, 0, 0.3, 0.6])
        self.intact = damage == 0
        made = [self.messages.make(rpc.input_type, damage, rpc.client_streaming and i == 0 and not self.odd(0.05)) for i in range(number)]
        headers = []
        if transport != "websocket":
            kind = "application/grpc" if transport == "grpc" else "application/grpc-web+proto"
            headers.append(("content-type", chance.choice(CONTENT_TYPES) if self.odd(0.03) else kind))
        # A session or job whose answer is not read would take a place until the end.
        keeps = rpc.name.startswith("Create")
        if self.odd(0.03) and not keeps:
            # A stream without messages ends only by its timeout. gRPC ignores a timeout that it cannot parse.
            headers.append(("grpc-timeout", chance.choice(SHORT_TIMEOUTS if rpc.server_streaming else TIMEOUTS)))
        elif rpc.server_streaming:
            headers.append(("grpc-timeout", f"{chance.randint(5, 200)}m"))
        if self.odd(0.15):
            headers += [(chance.choice(NAMES), chance.choice(VALUES)) for _ in range(chance.randint(1, 4))]
        path = f"/{rpc.containing_service.full_name}/{rpc.name}"
        if self.odd(0.005):
            path = chance.choice([path + "x", path[:-1], path.upper(), path + "/", "//", "/", path[1:], path.replace(".", "/"), path + "?a=b"])
        frame = self.websocket_piece if transport == "websocket" else self.framed
        return Call(transport, path, headers, [frame(message) for message in made], keeps or not self.odd(0.02),
                    chance.randint(1, 12) if rpc.server_streaming else 1000)

    def framed(self, message: bytes) -> bytes:
        flags, size = 0, len(message)
        if self.odd(0.01):
            flags = self.chance.choice([1, 2, 0x80, 0xFF])
        if self.odd(0.01):
            size = self.chance.choice([0, size + 1, max(0, size - 1), 2**20 + 1, 2**31, 2**32 - 1])
        return bytes([flags]) + size.to_bytes(4, "big") + message

    def websocket_piece(self, message: bytes) -> bytes:
        chance = self.chance
        if not self.odd(0.03):
            return websocket_frame(2, b"\0" + message)
        return chance.choice([
            websocket_frame(1, b"\0" + message), websocket_frame(2, b""), websocket_frame(2, b"\2" + message), websocket_frame(2, b"\1" + message),
            websocket_frame(2, b"\0" + message[:5], first=0) + websocket_frame(0, message[5:]), websocket_frame(0, message),
            websocket_frame(9, message[:125]) + websocket_frame(2, b"\0" + message), websocket_frame(8, message[:2]), websocket_frame(9, message[:126]),
            websocket_frame(2, b"\0" + message, first=0xC0), websocket_frame(2, b"\0" + message, mask=0), websocket_frame(11, message),
            b"\x82\xff" + b"\xff" * 8 + message])

    def answer(self, call: Call) -> Answer:
        """Returns the answer to a call. Opens a connection again once if the server has closed it since the last call."""
        transport = self.transports[call.transport]
        was_open = transport.socket is not None
        try:
            return transport.call(call.path, call.headers, call.pieces, call.half_close, call.most)
        except ConnectionRefusedError:
            transport.close()
            return Answer("refused")
        except ConnectionError:
            transport.close()
            return self.answer(call) if was_open else Answer("cut")

    def clean_up(self) -> None:
        """Closes, deletes and forgets everything that the server keeps for these calls and that it reported."""
        for name, rpc, more in [("session", "CloseSession", b""), ("storm_id", "DeleteCloud", b""), ("job_id", "CancelRenderJob", b"\x10\1")]:
            method = next(method for method in self.rpcs if method.name == rpc)
            for known in self.messages.known[name]:
                message = delimited(1, known.encode()) + more
                self.answer(Call("grpc", f"/{method.containing_service.full_name}/{rpc}", [("content-type", "application/grpc")],
                                 [b"\0" + len(message).to_bytes(4, "big") + message], True, 1000))

    def next(self) -> tuple[str, Call, Answer, str]:
        """Makes a call. Returns its rpc, what was sent, the answer, and what is wrong with the answer."""
        rpc = self.chance.choices(self.rpcs, self.weights)[0]
        # Each worker has a few sessions, so that none takes all places.
        keys = len(self.messages.known["session"])
        if (keys == 0 or keys > 6) and self.odd(0.3):
            rpc = next(rpc for rpc in self.rpcs if rpc.name == ("CreateSession" if keys == 0 else "CloseSession"))
        call = self.make(rpc)
        try:
            answer = self.answer(call)
        except TimeoutError:
            return rpc.name, call, Answer("none"), f"no answer within {HANG_LIMIT_S:.0f} s"
        wrong = fault(call, answer)
        for message in answer.messages:
            try:
                self.messages.learn(rpc.output_type._concrete_class.FromString(message))
            except Exception as error:
                wrong = wrong or f"the answer cannot be parsed: {error}"
        # A session is kept if its key was damaged in the request.
        if (self.intact and "no session" in answer.text) or (answer.status == 0 and rpc.name in ("CloseSession", "DeleteCloud")):
            self.messages.forget()
        return rpc.name, call, answer, wrong


def fault(call: Call, answer: Answer) -> str:
    """Returns what is wrong with the answer to a call; empty if nothing is."""
    if answer.status in (UNKNOWN, INTERNAL) and not OF_THE_LIBRARY.fullmatch(answer.text):
        return f"{GRPC_STATUSES[answer.status]}: {answer.text}"
    # gRPC's library resets a call whose message is marked as compressed but is not.
    if answer.status == "reset 2" and any(piece[:1] != b"\0" for piece in call.pieces):
        return ""
    if answer.status in ("no trailers", "closed 1011", "reset 2", "http 500", "http 502"):
        return f"{answer.status}: {answer.text}"
    return ""


class Server:
    """The program, which serves a tiny storm from a temporary folder."""

    def __init__(self, program: str, folder: str) -> None:
        storm = f"{folder}/tiny.nc"
        subprocess.run([program, "generate", "-o", storm, "--spacing", "200", "--cells", "12x12x10", "--ellipsoid", "0,0,1000,900,900,700",
                        "--feature-size", "1000", "--octaves", "1"], check=True, stdout=subprocess.DEVNULL)
        self.log = pathlib.Path(folder) / "log"
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(
                [program, "serve", "--data", storm, "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", "--device", "software",
                 "--state", f"{folder}/state", "--clouds", f"{folder}/clouds", "--audit-log", f"{folder}/audit", *SERVER_FLAGS],
                stdout=log, stderr=log)
        ready, end = None, time.monotonic() + HANG_LIMIT_S
        while ready is None:
            ready = re.search(r"is ready at http://[^ ]*?:(\d+)\S* \(gRPC 127\.0\.0\.1:(\d+)\)", self.output())
            if self.process.poll() is not None or time.monotonic() > end:
                raise SystemExit("the server did not start:\n" + self.output())
            time.sleep(0.05)
        self.ports = {"http": int(ready[1]), "grpc": int(ready[2])}

    def output(self) -> str:
        return self.log.read_text(errors="replace")

    def memory_mb(self) -> float:
        found = re.search(r"VmRSS:\s+(\d+) kB", pathlib.Path(f"/proc/{self.process.pid}/status").read_text())
        return int(found[1]) / 1024 if found else 0.0

    def memory_at_rest_mb(self) -> float:
        """Returns the server's memory in MB after it has stopped changing."""
        values = collections.deque(maxlen=10)
        end = time.monotonic() + HANG_LIMIT_S
        while (len(values) < 10 or max(values) - min(values) > 0.5) and time.monotonic() < end:
            time.sleep(0.5)
            values.append(self.memory_mb())
        return values[-1]

    def stop(self) -> str:
        """Stops the server. Returns what was wrong with its end."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            code = self.process.wait(HANG_LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            return f"the server did not stop within {HANG_LIMIT_S:.0f} s"
        if code == 0:
            return ""
        return f"the server ended with {code}, its log with:\n" + self.output()[-3000:]


def work(rpcs: list, ports: dict[str, int], seed: str, calls: int, out: multiprocessing.connection.Connection) -> None:
    """Makes calls in a separate process. Sends its counts now and then.

    If something is wrong or the server has ended, it sends its last calls and ends.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    caller = Caller(rpcs, ports, seed)
    counts, last = collections.Counter(), collections.deque(maxlen=3)
    for i in range(calls):
        name, call, answer, wrong = caller.next()
        last.append(call.text())
        counts[name, call.transport, answer.status] += 1
        if wrong or answer.status == "refused":
            out.send((counts, wrong, list(last)))
            return
        if i % 50 == 49 or i == calls - 1:
            out.send((counts, "", []))
            counts = collections.Counter()
    caller.clean_up()


class Soak:
    """The workers and their reports."""

    def __init__(self, options: argparse.Namespace, rpcs: list, server: Server) -> None:
        self.options, self.rpcs, self.server = options, rpcs, server
        self.counts: collections.Counter = collections.Counter()
        self.wrong, self.last = "", []
        self.began = time.monotonic()

    def run(self) -> str:
        """Makes all calls, or stops at the first fault. Returns that fault."""
        warm = min(self.options.warm_up, self.options.calls)
        self.make(warm, "warm-up")
        if self.wrong:
            return self.wrong
        before = self.server.memory_at_rest_mb()
        print(f"memory: {before:.1f} MB after {warm} calls", flush=True)
        if self.options.calls > warm:
            self.make(self.options.calls - warm, "then")
            after = before if self.wrong else self.server.memory_at_rest_mb()
            print(f"memory: {after:.1f} MB after {self.done} calls")
            if after - before > self.options.growth_mb:
                self.wrong = f"the memory grew by {after - before:.1f} MB"
        return self.wrong

    def make(self, calls: int, part: str) -> None:
        """Lets the workers make `calls` calls. Ends early if something is wrong."""
        pipes, workers, told, goal = [], [], 0.0, self.done + calls
        for i in range(self.options.workers):
            share = calls // self.options.workers + (i < calls % self.options.workers)
            ours, theirs = multiprocessing.Pipe(duplex=False)
            seed = f"{self.options.seed}/{part}/{i}"
            workers.append(multiprocessing.Process(target=work, args=(self.rpcs, self.server.ports, seed, share, theirs), daemon=True))
            workers[-1].start()
            theirs.close()
            pipes.append(ours)
        while pipes and not self.wrong:
            for pipe in multiprocessing.connection.wait(pipes, 1.0):
                try:
                    self.take(*pipe.recv())
                except EOFError:
                    pipes.remove(pipe)
            if self.server.process.poll() is not None:
                continue  # until every worker has reported its last calls
            if time.monotonic() - told > (5 if sys.stdout.isatty() else 30):
                told = time.monotonic()
                print(f"{self.done} of {self.options.calls} calls, {self.done / (told - self.began):.0f} a second, "
                      f"{self.server.memory_mb():.1f} MB", flush=True)
        if self.server.process.poll() is not None:
            self.wrong = self.wrong or "the server died"
        for process in workers:
            if self.wrong:
                process.terminate()
            process.join()
        if not self.wrong and self.done < goal:
            self.wrong = f"workers ended after {self.done} calls; the server refused connections, or a worker failed"

    @property
    def done(self) -> int:
        return self.counts.total()

    def take(self, counts: collections.Counter, wrong: str, last: list[str]) -> None:
        self.counts += counts
        self.last += last
        if wrong and not self.wrong:
            self.wrong, self.last = wrong, last[-1:]

    def summary(self) -> None:
        def table(index: int) -> str:
            sums = collections.Counter()
            for key, number in self.counts.items():
                name = key[index]
                sums[GRPC_STATUSES[name] if isinstance(name, int) and name < len(GRPC_STATUSES) else str(name)] += number
            return ", ".join(f"{name} {number}" for name, number in sums.most_common())
        print("calls:", table(0))
        print("transports:", table(1))
        print("answers:", table(2))
        seconds = time.monotonic() - self.began
        print(f"{self.done} calls in {seconds:.0f} s, {self.done / seconds:.0f} a second")


def repeat(text: str, rpcs: list, server: Server) -> str:
    """Makes one call that an earlier run printed."""
    call = Call.of(text)
    answer = Caller(rpcs, server.ports, "").answer(call)
    print(f"answer: {answer.status} {answer.text}, {len(answer.messages)} messages")
    return fault(call, answer)


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--calls", type=int, default=1_000_000)
    options.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**9))
    options.add_argument("--workers", type=int, default=6, help="processes that call; with another number the calls are others")
    options.add_argument("--warm-up", type=int, default=100_000, help="calls after which the memory may not grow")
    options.add_argument("--growth-mb", type=float, default=5.0, help="MB by which it may grow all the same")
    options.add_argument("--call", metavar="JSON", help="makes one call alone, as a former run printed it")
    options = options.parse_args()
    program = os.environ.get("THUNDERHEAD_BINARY", str(ROOT / "build/release/bin/thunderhead"))
    folder = tempfile.mkdtemp(prefix="thunderhead-soak-")
    try:
        os.mkdir(f"{folder}/messages")
        services = load_schema(ROOT / "proto", f"{folder}/messages")
        rpcs = [rpc for service in services for rpc in service.methods]
        server = Server(program, folder)
        if options.call:
            wrong, last = repeat(options.call, rpcs, server), []
        else:
            print(f"{options.calls} calls of {len(rpcs)} rpcs with seed {options.seed}", flush=True)
            soak = Soak(options, rpcs, server)
            wrong, last = soak.run(), soak.last
            soak.summary()
        ended = server.stop()
        for text in [wrong, ended]:
            if text:
                print(f"FAILED: {text}")
        for call in last if wrong or ended else []:
            print(f"repeat it by  ./dev soak --call {call!r}")
        return 1 if wrong or ended else 0
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
