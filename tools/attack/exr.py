"""Pixels of the EXR files that `bidir render` writes: one part of lines, packed by ZIP or not at all."""

import array
import struct
import zlib
from pathlib import Path

# The number of rows of a block by the number of the compression.
ROWS = {0: 1, 2: 1, 3: 16}
# The letter of a value and its bytes by the number of a channel's type.
TYPES = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}


def attributes(data):
    """Returns the attributes of the header by name, and where they end."""
    found, at = {}, 8
    while data[at]:
        end = data.index(b"\0", at)
        kind_end = data.index(b"\0", end + 1)
        size, = struct.unpack_from("<I", data, kind_end + 1)
        found[data[at:end].decode()] = data[kind_end + 5:kind_end + 5 + size]
        at = kind_end + 5 + size
    return found, at + 1


def channels(data):
    """Returns names, letters and bytes, in the order of the file."""
    found, at = [], 0
    while data[at]:
        end = data.index(b"\0", at)
        found.append((data[at:end].decode(), *TYPES[struct.unpack_from("<I", data, end + 1)[0]]))
        at = end + 17
    return found


def unpack(block):
    """Undoes what ZIP of OpenEXR does before deflate: differences, and the halves of values apart."""
    data = bytearray(zlib.decompress(block))
    for i in range(1, len(data)):
        data[i] = (data[i - 1] + data[i] - 128) & 255
    half = (len(data) + 1) // 2
    out = bytearray(len(data))
    out[0::2], out[1::2] = data[:half], data[half:]
    return bytes(out)


def read(path):
    """Returns the values of every channel by name, row by row.

    Raises KeyError for files that other programs may write."""
    data = Path(path).read_bytes()
    header, at = attributes(data)
    most_rows = ROWS[header["compression"][0]]
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    kinds = channels(header["channels"])
    pixels = {name: array.array("f") for name, _, _ in kinds}
    line = width * sum(size for _, _, size in kinds)
    for offset in struct.unpack_from("<%dQ" % -(-height // most_rows), data, at):
        y, size = struct.unpack_from("<iI", data, offset)
        rows = min(most_rows, height - (y - y0))
        block = data[offset + 8:offset + 8 + size]
        # A block that would not become smaller is stored as it is.
        block, place = unpack(block) if size < rows * line else block, 0
        for name, letter, size in kinds * rows:
            pixels[name].extend(struct.unpack_from("<%d%s" % (width, letter), block, place))
            place += size * width
    return pixels


def mean(path):
    """Returns the mean of R, G and B over the image."""
    pixels = read(path)
    return sum(sum(pixels[name]) for name in "RGB") / sum(len(pixels[name]) for name in "RGB")
