"""Calls by gRPC, gRPC-Web and WebSocket over plain sockets, which can send what no client library would send.

Each transport has `call(path, headers, pieces, half_close, most)`. It sends the request, reads at most `most` messages
of the answer, and then leaves the call. A wait that lasts too long raises TimeoutError.
"""

import base64
import dataclasses
import socket
import struct

# The longest wait before a call counts as hung. It is not a requirement on speed.
HANG_LIMIT_S = 600.0
Headers = list[tuple[str, str]]


@dataclasses.dataclass
class Answer:
    """An answer. `status` is a gRPC status, or a word: `left` after enough messages, `http 404`, `reset 8`, `closed 1008`."""

    status: int | str
    text: str = ""
    messages: list[bytes] = dataclasses.field(default_factory=list)


class Connection:
    """A TCP connection, which is opened at its first use."""

    def __init__(self, port: int) -> None:
        self.port, self.socket, self.buffer = port, None, b""

    def open(self) -> None:
        self.socket = socket.create_connection(("127.0.0.1", self.port), HANG_LIMIT_S)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer = b""

    def close(self) -> None:
        if self.socket is not None:
            self.socket.close()
        self.socket = None

    def take(self, size: int) -> bytes:
        while len(self.buffer) < size:
            self.more()
        taken, self.buffer = self.buffer[:size], self.buffer[size:]
        return taken

    def take_until(self, end: bytes) -> bytes:
        while end not in self.buffer:
            self.more()
        taken, _, self.buffer = self.buffer.partition(end)
        return taken

    def more(self) -> None:
        received = self.socket.recv(65536)
        if not received:
            raise ConnectionResetError("the server closed the connection")
        self.buffer += received


def trailers(text: bytes) -> dict[str, str]:
    lines = (line.partition(":") for line in text.decode("latin-1").split("\r\n"))
    return {name.strip().lower(): value.strip() for name, _, value in lines}


class Grpc(Connection):
    """gRPC over HTTP/2. Headers are sent as literals, that is HPACK without a table."""

    DATA, HEADERS, RESET, SETTINGS, PING, GOAWAY, WINDOW, CONTINUATION = 0, 1, 3, 4, 6, 7, 8, 9
    STATIC = {8: (":status", "200"), 9: (":status", "204"), 10: (":status", "206"), 11: (":status", "304"), 12: (":status", "400"),
              13: (":status", "404"), 14: (":status", "500")}

    def frame(self, kind: int, flags: int, stream: int, payload: bytes) -> bytes:
        return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload

    def open(self) -> None:
        super().open()
        self.stream, self.window, self.first_window, self.unacknowledged = -1, 65535, 65535, 0
        # The settings are no header table, no push, and the largest windows.
        settings = struct.pack(">HIHIHI", 1, 0, 2, 0, 4, 2**31 - 1)
        self.socket.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + self.frame(self.SETTINGS, 0, 0, settings)
                            + self.frame(self.WINDOW, 0, 0, struct.pack(">I", 2**31 - 1 - 65535)))

    def call(self, path: str, headers: Headers, pieces: list[bytes], half_close: bool, most: int) -> Answer:
        if self.socket is None or self.stream > 2**30:
            self.close()
            self.open()
        self.stream += 2
        self.stream_window = self.first_window
        self.answer, self.block, self.data, self.messages = None, b"", b"", []
        block = b"".join(self.literal(name, value) for name, value in [
            (":method", "POST"), (":scheme", "http"), (":path", path), (":authority", "localhost"), ("te", "trailers"), *headers])
        blocks = [block[i:i + 16000] for i in range(0, len(block), 16000)]
        for i, part in enumerate(blocks):
            last = 4 if i == len(blocks) - 1 else 0
            self.socket.sendall(self.frame(self.CONTINUATION if i else self.HEADERS, last, self.stream, part))
        for piece in pieces:
            self.send(piece)
        if half_close and self.answer is None:
            self.socket.sendall(self.frame(self.DATA, 1, self.stream, b""))
        elif not half_close:
            most = 0
        while self.answer is None and (most > len(self.messages)):
            self.read()
        if self.answer is None:
            self.socket.sendall(self.frame(self.RESET, 0, self.stream, struct.pack(">I", 8)))
            self.answer = Answer("left")
        self.answer.messages = self.messages
        return self.answer

    def send(self, piece: bytes) -> None:
        while piece and self.answer is None:
            size = min(len(piece), 16384, self.window, self.stream_window)
            if size <= 0:
                self.read()
                continue
            self.socket.sendall(self.frame(self.DATA, 0, self.stream, piece[:size]))
            self.window -= size
            self.stream_window -= size
            piece = piece[size:]

    @staticmethod
    def literal(name: str, value: str) -> bytes:
        def text(raw: bytes) -> bytes:
            size = len(raw)
            if size < 127:
                return bytes([size]) + raw
            out, size = bytearray([127]), size - 127
            while size > 127:
                out.append(size & 127 | 128)
                size >>= 7
            return bytes(out) + bytes([size]) + raw
        return b"\0" + text(name.encode("latin-1")) + text(value.encode("latin-1"))

    def headers(self, block: bytes) -> dict[str, str]:
        found, at = {}, 0

        def integer(bits: int) -> int:
            nonlocal at
            value = block[at] & (2**bits - 1)
            at += 1
            if value == 2**bits - 1:
                shift = 0
                while True:
                    value += (block[at] & 127) << shift
                    shift += 7
                    at += 1
                    if block[at - 1] < 128:
                        break
            return value

        def text() -> str:
            nonlocal at
            compressed = block[at] & 128
            size = integer(7)
            at += size
            return "?" if compressed else block[at - size:at].decode("latin-1")
        while at < len(block):
            first = block[at]
            if first & 0x80:
                name, value = self.STATIC.get(integer(7), ("?", "?"))
            elif first & 0xE0 == 0x20:
                integer(5)
                continue
            else:
                index = integer(6 if first & 0x40 else 4)
                name = self.STATIC.get(index, ("?",))[0] if index else text()
                value = text()
            found[name] = value
        return found

    def read(self) -> None:
        """Reads one frame."""
        head = self.take(9)
        size, kind, flags = int.from_bytes(head[:3], "big"), head[3], head[4]
        stream = int.from_bytes(head[5:], "big") & 2**31 - 1
        payload = self.take(size)
        if kind == self.SETTINGS and not flags & 1:
            for key, value in struct.iter_unpack(">HI", payload):
                if key == 4:
                    self.stream_window += value - self.first_window
                    self.first_window = value
            self.socket.sendall(self.frame(self.SETTINGS, 1, 0, b""))
        elif kind == self.PING and not flags & 1:
            self.socket.sendall(self.frame(self.PING, 1, 0, payload))
        elif kind == self.GOAWAY:
            code = int.from_bytes(payload[4:8], "big")
            self.close()
            self.answer = self.answer or Answer(f"goaway {code}", payload[8:].decode("latin-1"))
        elif kind == self.WINDOW:
            if stream == 0:
                self.window += int.from_bytes(payload, "big")
            elif stream == self.stream:
                self.stream_window += int.from_bytes(payload, "big")
        elif kind == self.DATA:
            self.unacknowledged += size
            if self.unacknowledged > 2**20:
                self.socket.sendall(self.frame(self.WINDOW, 0, 0, struct.pack(">I", self.unacknowledged)))
                self.unacknowledged = 0
            if stream == self.stream:
                self.data += payload
                while len(self.data) >= 5 and len(self.data) >= 5 + int.from_bytes(self.data[1:5], "big"):
                    end = 5 + int.from_bytes(self.data[1:5], "big")
                    self.messages.append(self.data[5:end])
                    self.data = self.data[end:]
                if flags & 1:
                    self.answer = self.answer or Answer("no trailers")
        elif kind == self.RESET and stream == self.stream:
            self.answer = self.answer or Answer(f"reset {int.from_bytes(payload, 'big')}")
        elif kind in (self.HEADERS, self.CONTINUATION) and stream == self.stream:
            if kind == self.HEADERS:
                self.last = flags & 1
            self.block += payload
            if flags & 4:
                found, self.block = self.headers(self.block), b""
                if self.last:
                    status = found.get("grpc-status")
                    self.answer = Answer(int(status) if status else f"http {found.get(':status')}", found.get("grpc-message", ""))


class GrpcWeb(Connection):
    """gRPC-Web over HTTP/1.1, with a connection that is kept open."""

    def call(self, path: str, headers: Headers, pieces: list[bytes], half_close: bool, most: int) -> Answer:
        if self.socket is None:
            self.open()
        body = b"".join(pieces)
        lines = [f"POST {path} HTTP/1.1", "Host: localhost", f"Content-Length: {len(body) + (not half_close)}"]
        lines += [f"{name}: {value}" for name, value in headers]
        self.socket.sendall("\r\n".join([*lines, "", ""]).encode("latin-1") + body)
        if not half_close:
            self.close()
            return Answer("left")
        status, _, rest = self.take_until(b"\r\n\r\n").partition(b"\r\n")
        found = trailers(rest)
        chunked = "chunked" in found.get("transfer-encoding", "")
        data, messages, answer = b"", [], None
        left = 0 if chunked else int(found.get("content-length", 0))
        while True:
            if chunked:
                size = int(self.take_until(b"\r\n").split(b";")[0], 16)
                data += self.take(size)
                self.take(2)
                ended = size == 0
            else:
                data += self.take(left)
                ended = True
            while found.get("content-type", "").startswith("application/grpc") and len(data) >= 5:
                end = 5 + int.from_bytes(data[1:5], "big")
                if len(data) < end:
                    break
                if data[0] & 0x80:
                    found.update(trailers(data[5:end]))
                else:
                    messages.append(data[5:end])
                data = data[end:]
            if ended:
                break
            if len(messages) >= most:
                answer = Answer("left")
                break
        if answer is None:
            code = int(status.split()[1])
            told = found.get("grpc-status")
            answer = Answer(int(told) if told and code == 200 else f"http {code}", found.get("grpc-message", "") or data[:200].decode("latin-1"))
        if answer.status == "left" or "close" in found.get("connection", "").lower():
            self.close()
        answer.messages = messages
        return answer


class WebSocket(Connection):
    """gRPC over WebSocket, with a connection for each call. Pieces are frames that `websocket_frame` makes."""

    def call(self, path: str, headers: Headers, pieces: list[bytes], half_close: bool, most: int) -> Answer:
        self.open()
        try:
            return self.converse(path, headers, pieces, half_close, most)
        finally:
            self.close()

    def converse(self, path: str, headers: Headers, pieces: list[bytes], half_close: bool, most: int) -> Answer:
        lines = [f"GET {path} HTTP/1.1", "Host: localhost", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
                 f"Sec-WebSocket-Key: {base64.b64encode(bytes(16)).decode()}", "Sec-WebSocket-Protocol: grpc-websocket.v1"]
        lines += [f"{name}: {value}" for name, value in headers]
        self.socket.sendall("\r\n".join([*lines, "", ""]).encode("latin-1"))
        status, _, rest = self.take_until(b"\r\n\r\n").partition(b"\r\n")
        if status.split()[1] != b"101":
            return Answer(f"http {int(status.split()[1])}", self.take(int(trailers(rest).get("content-length", 0))).decode("latin-1"))
        try:
            self.socket.sendall(b"".join(pieces) + (websocket_frame(2, b"\1") if half_close else b""))
        except (BrokenPipeError, ConnectionResetError):
            return Answer("cut")
        messages = []
        while len(messages) < most and half_close:
            try:
                kind, payload = self.message()
            except ConnectionResetError:
                return Answer("cut", messages=messages)
            if kind == 8:
                return Answer(f"closed {int.from_bytes(payload[:2], 'big')}", payload[2:].decode("latin-1"), messages)
            if kind == 2 and payload[:1] == b"\0":
                messages.append(payload[1:])
            elif kind == 2:
                found = trailers(payload[1:])
                return Answer(int(found["grpc-status"]), found.get("grpc-message", ""), messages)
        return Answer("left", messages=messages)

    def message(self) -> tuple[int, bytes]:
        head = self.take(2)
        size = head[1] & 127
        if size > 125:
            size = int.from_bytes(self.take(2 if size == 126 else 8), "big")
        return head[0] & 15, self.take(size)


def websocket_frame(kind: int, payload: bytes, first: int = 0x80, mask: int = 0x80) -> bytes:
    """Returns a frame whose masking key is zero, so that the payload is sent unchanged."""
    size = len(payload)
    length = bytes([mask | size]) if size < 126 else bytes([mask | 126]) + struct.pack(">H", size) if size < 65536 else (
        bytes([mask | 127]) + struct.pack(">Q", size))
    return bytes([first | kind]) + length + (bytes(4) if mask else b"") + payload
