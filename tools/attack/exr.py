"""Pixels of the EXR files that `bidir render` writes: one part of lines, packed by ZIP or not at all."""

import array
import struct
import sys
import zlib

# The number of rows of a block by the number of the compression.
ROWS = {0: 1, 2: 1, 3: 16}
# The letter of `array` and the bytes of a value by the number of a channel's type.
TYPES = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def header(data):
    """The attributes by name, and where they end."""
    attributes, at = {}, 8
    while data[at]:
        name, at = text(data, at)
        _, at = text(data, at)
        size, = struct.unpack_from("<I", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels(data):
    """Names and types, in the order of the file."""
    found, at = [], 0
    while data[at]:
        name, at = text(data, at)
        found.append((name, struct.unpack_from("<I", data, at)[0]))
        at += 16
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
    """The values of every channel by name, row by row.

    Raises ValueError for files that other programs may write."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = header(data)
    compression = attributes["compression"][0]
    if compression not in ROWS or attributes["lineOrder"][0] != 0:
        raise ValueError("%s is packed in a way that is not read here" % path)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    kinds = channels(attributes["channels"])
    pixels = {name: array.array("f") for name, _ in kinds}
    line = width * sum(TYPES[kind][1] for _, kind in kinds)
    blocks = -(-height // ROWS[compression])
    for offset in struct.unpack_from("<%dQ" % blocks, data, at):
        y, size = struct.unpack_from("<iI", data, offset)
        rows = min(ROWS[compression], height - (y - y0))
        block = data[offset + 8:offset + 8 + size]
        # A block that would not become smaller is stored as it is.
        block = unpack(block) if size < rows * line else block
        lines(block, rows, width, kinds, pixels)
    return pixels


def lines(block, rows, width, kinds, pixels):
    at = 0
    for _ in range(rows):
        for name, kind in kinds:
            letter, size = TYPES[kind]
            values = struct.unpack_from("<%d%s" % (width, letter), block, at)
            pixels[name].extend(values)
            at += size * width


def mean(path):
    """The mean of R, G and B over the image."""
    pixels = read(path)
    values = [value for name in "RGB" for value in pixels[name]]
    return sum(values) / len(values)


if __name__ == "__main__":
    print(mean(sys.argv[1]))
