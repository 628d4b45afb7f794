"""Makes random messages from their descriptors. Most are valid, some have unusual values, and some have damaged bytes.

A message is written as bytes, field by field. It can therefore also be a message that no library of protobuf would
write.
"""

import importlib
import math
import pathlib
import random
import struct
import subprocess
import sys
from collections import deque

import google
from google.protobuf.descriptor import Descriptor, FieldDescriptor, ServiceDescriptor

# The largest values of settings that decide how long a picture takes. Some mutations exceed them; then the server's
# limits apply.
SMALL = {"width_px": 40, "height_px": 40, "slices": 16, "count": 40, "scales": 2, "octaves": 2, "max_size_px": 32, "samples": 32,
         "error_seconds": 0.02, "frames_per_second": 10}
# Fields that are nearly always set: keys, and the size of pictures, whose default is large.
NEEDED = {"output", "width_px", "height_px", "session_id", "session_key", "job_id", "pictures"}
# The fields of responses with names that requests may use, and the requests' fields for them.
TOLD = {"CreateSessionResponse.session_id": "session", "CreateSessionResponse.viewer_key": "session", "StormSummary.id": "storm_id",
        "RenderJob.id": "job_id", "Joined.participant_key": "participant_key"}
ASKED = {"session_id": "session", "session_key": "session", "storm_id": "storm_id", "job_id": "job_id",
         "participant_key": "participant_key"}
ODD_TEXTS = [b"", b"\0", b"a\nb", b"\xff\xfe", b"\xc3\xa9" * 200, b"x" * 5000, b"../../etc/passwd", b"%s%n", b"\x1b[31m", b"\xf0\x9f\x8c\xa9",
             b"\xe2\x80\xae", b"'\"`<b>", b"\xed\xa0\x80"]
ODD_PATHS = ["", ".", "..", ".camera", "camera.", "camera..orbit", "fields.", "fields.scale", "fields.0", "storm_id.x", "*", "camera,orbit",
             "cameraOrbit", "rendering.other.numbers.key", "a" * 3000, "camera\n", "camera.\u00fc", "\ud800"]
ODD_NUMBERS = [0.0, -0.0, -1.0, 1e-300, 1e300, -1e300, math.inf, -math.inf, math.nan, 0.5, 1e9]
ODD_INTEGERS = [0, 1, -1, 127, 128, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**63 - 1, 2**63, 2**64 - 1]


def load_schema(proto: pathlib.Path, into: str) -> list[ServiceDescriptor]:
    """Generates and imports the modules of Thunderhead's messages. Returns all services in them."""
    files = sorted(str(path.relative_to(proto)) for folder in ("thunderhead", "google") for path in (proto / folder).rglob("*.proto"))
    subprocess.run(["protoc", "-I", str(proto), "-I", "/usr/include", f"--python_out={into}", *files], check=True, cwd=proto)
    sys.path.insert(0, into)
    google.__path__.append(f"{into}/google")
    modules = [importlib.import_module(file.removesuffix(".proto").replace("/", ".") + "_pb2") for file in files]
    Messages.limits = importlib.import_module("thunderhead.v1.limits_pb2")
    Messages.scene = importlib.import_module("thunderhead.v1.scene_pb2").Scene.DESCRIPTOR
    return [service for module in modules for service in module.DESCRIPTOR.services_by_name.values()]


def varint(number: int) -> bytes:
    number &= 2**64 - 1
    out = bytearray()
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    out.append(number)
    return bytes(out)


def delimited(number: int, value: bytes) -> bytes:
    return varint(number << 3 | 2) + varint(len(value)) + value


class Messages:
    """Makes random messages, which use names (such as ids and keys) from the server's responses."""

    limits = None  # the module of limits.proto
    scene = None  # the descriptor of Scene, whose fields are named by update masks

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.known = {name: deque(maxlen=64) for name in {*TOLD.values()}}
        self.used: list[str] = []  # names in the messages since the list was cleared
        self.wild = 0.0
        self.option = {}

    def odd(self) -> bool:
        return self.chance.random() < self.wild

    def make(self, message: Descriptor, damage: float, begins: bool = False) -> bytes:
        """Returns a message. Damages its bytes with the probability `damage`.

        A message that begins a stream uses the first choice of its oneof.
        """
        self.wild = self.chance.choice([0, 0, 0, 0, 0.02, 0.3])
        made = self.message(message, 0, begins)
        while self.chance.random() < damage:
            made = self.damaged(made)
        return made

    def message(self, message: Descriptor, depth: int, begins: bool = False) -> bytes:
        chosen = {oneof.name: oneof.fields[0] if begins else self.chance.choice(oneof.fields) for oneof in message.oneofs}
        out = bytearray()
        for field in message.fields:
            oneof = field.containing_oneof
            if oneof is not None and chosen[oneof.name] is not field:
                continue
            often = 0.97 if field.name in NEEDED else (0.8, 0.5, 0.4, 0.4, 0.3, 0.3, 0.1, 0.0)[min(depth, 7)]
            if self.chance.random() < often:
                out += self.field(field, depth)
        return bytes(out)

    def field(self, field: FieldDescriptor, depth: int) -> bytes:
        if field.label != FieldDescriptor.LABEL_REPEATED:
            return self.value(field, depth)
        most = self.options(field, "max_items") or 3
        number = most + 1 if self.odd() and most < 300 else self.chance.randint(0, min(3, most))
        return b"".join(self.value(field, depth) for _ in range(number))

    def options(self, field: FieldDescriptor, name: str):
        key = (field.full_name, name)
        if key not in self.option:
            self.option[key] = field.GetOptions().Extensions[getattr(self.limits, name)]
        return self.option[key]

    def value(self, field: FieldDescriptor, depth: int) -> bytes:
        number, kind = field.number, field.type
        if kind == FieldDescriptor.TYPE_MESSAGE:
            if field.message_type.full_name == "google.protobuf.FieldMask":
                return delimited(number, b"".join(delimited(1, self.path()) for _ in range(self.chance.randint(1, 3))))
            return delimited(number, self.message(field.message_type, depth + 1))
        if kind in (FieldDescriptor.TYPE_STRING, FieldDescriptor.TYPE_BYTES):
            return delimited(number, self.text(field))
        if kind == FieldDescriptor.TYPE_ENUM:
            value = self.chance.choice([99, -1, 2**31]) if self.odd() else self.chance.choice(field.enum_type.values).number
            return varint(number << 3) + varint(value)
        if kind == FieldDescriptor.TYPE_BOOL:
            return varint(number << 3) + varint(self.chance.randint(0, 1))
        value = self.number(field)
        if kind == FieldDescriptor.TYPE_DOUBLE:
            return varint(number << 3 | 1) + struct.pack("<d", value)
        if kind == FieldDescriptor.TYPE_FLOAT:
            return varint(number << 3 | 5) + struct.pack("<f", max(-3e38, min(3e38, value)) if math.isfinite(value) else value)
        return varint(number << 3) + varint(int(value))

    def number(self, field: FieldDescriptor) -> float:
        real = field.cpp_type in (FieldDescriptor.CPPTYPE_DOUBLE, FieldDescriptor.CPPTYPE_FLOAT)
        if self.odd():
            return self.chance.choice(ODD_NUMBERS if real else ODD_INTEGERS)
        limits = self.options(field, "number")
        if not limits or not limits.unit:
            return self.chance.randint(0, 5)
        low, high = limits.minimum, min(limits.maximum, max(limits.minimum, SMALL.get(field.name, math.inf)))
        if self.chance.random() < 0.1:
            return self.chance.choice([low, high])
        if limits.logarithmic and low > 0:
            value = min(high, math.exp(self.chance.uniform(math.log(low), math.log(high))))
        else:
            value = self.chance.uniform(low, high)
        return value if real else round(value)

    def text(self, field: FieldDescriptor) -> bytes:
        if self.odd():
            return self.chance.choice(ODD_TEXTS)
        names = self.known.get(ASKED.get(field.name, ""))
        if names and self.chance.random() < 0.9:
            self.used.append(names[-1] if self.chance.random() < 0.5 else self.chance.choice(names))
            return self.used[-1].encode()
        if field.name == "storm_id":
            return b""
        return self.chance.choice([b"2013-05-20T20:00:00Z", b"light_volume", b"a name", b"Z\xc3\xbcrich"])

    def path(self) -> bytes:
        """Returns a path of an update mask."""
        if self.odd():
            return self.chance.choice(ODD_PATHS).encode(errors="surrogatepass")
        message, names = self.scene, []
        while message is not None and (not names or self.chance.random() < 0.6):
            field = self.chance.choice(message.fields)
            names.append(field.name)
            message = field.message_type if field.label != FieldDescriptor.LABEL_REPEATED else None
        return ".".join(names).encode()

    def damaged(self, message: bytes) -> bytes:
        """Returns the message with one damage to its bytes."""
        chance, out = self.chance, bytearray(message)
        at = chance.randint(0, len(out))
        kind = chance.randint(0, 9)
        if kind == 0 and out:
            out[at % len(out)] ^= 1 << chance.randint(0, 7)
        elif kind == 1 and out:
            out[at % len(out)] = chance.choice([0, 1, 0x7F, 0x80, 0xFF])
        elif kind == 2:
            del out[at:]
        elif kind == 3:
            del out[at:at + chance.randint(1, 20)]
        elif kind == 4:
            out[at:at] = chance.randbytes(chance.randint(1, 20))
        elif kind == 5:
            out += out[at:]
        elif kind == 6:  # an unknown field of any wire type, including groups and field 0
            out += varint(chance.choice([0, 1, 2, 3, 100, 19000, 2**29 - 1]) << 3 | chance.randint(0, 7)) + chance.randbytes(chance.randint(0, 9))
        elif kind == 7:  # nested messages or groups
            number, depth = chance.randint(1, 12), chance.choice([20, 101, 3000])
            out += varint(number << 3 | 3) * depth if chance.random() < 0.5 else (varint(number << 3 | 2) + b"\x7f") * depth
        elif kind == 8:  # a number of too many bytes, or a length beyond the end
            out += varint(chance.randint(1, 20) << 3 | chance.choice([0, 2])) + b"\xff" * chance.choice([4, 9, 10, 11])
        else:
            out[at:at] = chance.choice(ODD_TEXTS)
        return bytes(out)

    def learn(self, message) -> None:
        """Remembers the names in a response."""
        for field, value in message.ListFields():
            if field.type == FieldDescriptor.TYPE_MESSAGE:
                if field.message_type.GetOptions().map_entry:
                    continue
                for part in value if field.label == FieldDescriptor.LABEL_REPEATED else [value]:
                    self.learn(part)
            elif name := TOLD.get(f"{field.containing_type.name}.{field.name}"):
                if value not in self.known[name]:
                    self.known[name].append(value)

    def forget(self) -> None:
        """Forgets the names that were used in messages since `used` was cleared."""
        for names in self.known.values():
            for used in self.used:
                if used in names:
                    names.remove(used)
