"""Reads OpenEXR files of one part in scan lines, uncompressed or ZIP, with 32-bit float channels. Cycles and
Thunderhead's reference write such files.

Each channel becomes a numpy array, rows from top to bottom. Format: openexr.com/en/latest/OpenEXRFileLayout.html.
"""

import struct
import zlib

import numpy as np

COMPRESSIONS = {0: 1, 2: 1, 3: 16}  # none, ZIPS, ZIP: scan lines per block
FLOAT = 2


def _string(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data):
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = _string(data, at)
        _, at = _string(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(value):
    names, at = [], 0
    while value[at] != 0:
        name, at = _string(value, at)
        if struct.unpack_from("<i", value, at)[0] != FLOAT:
            raise ValueError(f"channel {name} is not of 32-bit floats")
        names.append(name)
        at += 16
    return names


def _unzip(packed, size):
    if len(packed) == size:
        return packed
    # Each byte is the difference from the previous byte, plus 128. The first half has the bytes at even positions, the
    # second half those at odd positions.
    deltas = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
    deltas[1:] -= 128
    shuffled = np.cumsum(deltas).astype(np.uint8)
    plain = np.empty(size, np.uint8)
    half = (size + 1) // 2
    plain[0::2], plain[1::2] = shuffled[:half], shuffled[half:]
    return plain.tobytes()


def read(path):
    """Returns the channels of the file by name, as arrays of shape (height, width)."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"\x76\x2f\x31\x01":
        raise ValueError(f"{path} is not an OpenEXR file")
    header, at = _header(data)
    lines = COMPRESSIONS.get(header["compression"][0])
    if lines is None:
        raise ValueError(f"{path} is compressed in another way than ZIP")
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = _channels(header["channels"])
    rows = np.empty((height, len(names), width), np.float32)
    for offset in struct.unpack_from(f"<{-(-height // lines)}Q", data, at):
        y, size = struct.unpack_from("<2i", data, offset)
        first = y - y0
        count = min(lines, height - first)
        plain = _unzip(data[offset + 8:offset + 8 + size], count * len(names) * width * 4)
        rows[first:first + count] = np.frombuffer(plain, "<f4").reshape(count, len(names), width)
    return {name: rows[:, i] for i, name in enumerate(names)}


def read_rgb(path, layer=""):
    """Returns the channels of a layer ("" or "stderr.") as an array of shape (height, width, 3)."""
    channels = read(path)
    return np.stack([channels[layer + color] for color in "RGB"], axis=-1).astype(np.float64)
