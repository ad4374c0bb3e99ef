"""Small files that unpack to much: each is refused, or read within two seconds and a GiB."""

import base64
import json
import struct
import zlib

import part
import runs

HEAD = 'Camera "perspective" WorldBegin LightSource "infinite"\n'
# Twice the documented time, for a busy machine.
LIMITS = runs.Limits(cpu=4, wall=300, memory=runs.GIB)
MEBI = 1 << 20


def zeros(size, head=b"", footer=b"", byte=b"\0"):
    """Makes a raw deflate stream of `head`, a repeated byte, and `footer`, without compressing all of it."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    begin = packer.compress(head) + packer.flush(zlib.Z_FULL_FLUSH)
    piece = packer.compress(byte * (16 * MEBI)) + packer.flush(zlib.Z_FULL_FLUSH)
    pieces, rest = divmod(size, 16 * MEBI)
    return begin + piece * pieces + packer.compress(byte * rest + footer) + packer.flush()


def gzip(size, head=b"", footer=b"", byte=b"\0"):
    checksum = zlib.crc32(head)
    for _ in range(size // MEBI):
        checksum = zlib.crc32(byte * MEBI, checksum)
    checksum = zlib.crc32(byte * (size % MEBI) + footer, checksum)
    length = (len(head) + size + len(footer)) & 0xFFFFFFFF
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + zeros(size, head, footer, byte) + struct.pack("<II", checksum, length)


def png(side, depth, colours):
    """Makes a black square image with a number of bits and a colour type."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    channels = {0: 1, 2: 3, 6: 4}[colours]
    size = side * (1 + (side * channels * depth + 7) // 8)
    # Adler-32 of zeros.
    data = b"\x78\xda" + zeros(size) + struct.pack(">I", (size % 65521) << 16 | 1)
    header = struct.pack(">IIBBBBB", side, side, depth, colours, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def inclusions(word, last):
    """Six files, each of which names the next ten times: a million in all."""
    files = {"e%d.pbrt" % i: '%s "e%d.pbrt"\n' % (word, i + 1) * 10 for i in range(6)}
    return {**files, "e6.pbrt": last, "scene.pbrt": HEAD + '%s "e0.pbrt"\n' % word}


def gltf(accessor, nodes=1, children=0):
    """A triangle mesh whose positions are of an accessor without bytes, and nodes below each other."""
    world = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "children": [i + 1] * children if i + 1 < nodes else []} for i in range(nodes)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1], **accessor}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
    }
    for node in world["nodes"]:
        if not node["children"]:
            del node["children"]
    return {"scene.gltf": json.dumps(world)}


def texture(image):
    return {"t.png": image, "scene.pbrt": HEAD + 'Texture "t" "spectrum" "imagemap" "string filename" "t.png" '
            'Material "diffuse" "texture reflectance" "t" Shape "sphere"'}


def mesh(data):
    return {"m.ply.gz": data, "scene.pbrt": HEAD + 'Shape "plymesh" "string filename" "m.ply.gz"'}


PLY = (b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
       b"property float x\nproperty float y\nproperty float z\n"
       b"element face 1\nproperty list uchar int vertex_indices\nend_header\n")
TRIANGLE = '"integer indices" [0 1 2] "point3 P" [0 0 1 1 0 1 0 1 1]'
FACE = struct.pack("<B3i", 3, 0, 1, 2)
INFO = ("info", "scene.pbrt")
GLTF = ("info", "scene.gltf")
RENDER = ("render", "scene.pbrt", "-q", "--size", "4x4", "--spp", "1", "--threads", "1", "-o", "a.png")
COMPARE = ("compare", "t.png", "t.png")


def packed(size, head=b"", footer=b"", byte=b"\0"):
    """A scene that includes a packed text."""
    return {"more.pbrt.gz": gzip(size, head, footer, byte), "scene.pbrt": HEAD + 'Include "more.pbrt.gz"'}


def subdivided(times):
    return {"scene.pbrt": HEAD + ('Shape "loopsubdiv" "integer levels" 10 %s\n' % TRIANGLE) * times}


def sparse():
    """Makes a file that announces three hundred million points and contains one."""
    indices, values = {"bufferView": 0, "componentType": 5125}, {"bufferView": 0}
    return gltf({"count": 3 * 10 ** 8, "sparse": {"count": 1, "indices": indices, "values": values}})


def repeated(word):
    yield "%s of a shape a million times" % word, lambda: inclusions(word, 'Shape "sphere"\n'), INFO
    yield "%s of nothing a million times" % word, lambda: inclusions(word, ""), INFO
    yield "%s of itself" % word, lambda: {"scene.pbrt": HEAD + '%s "scene.pbrt"\n' % word * 2}, INFO


def images(side, depth, colours):
    title = "PNG of %d pixels a side, %d bits, type %d" % (side, depth, colours)
    yield title + ", compared", lambda: {"t.png": png(side, depth, colours)}, COMPARE
    yield title + ", as a texture", lambda: texture(png(side, depth, colours)), RENDER


def bombs():
    """Titles, functions that make the files, and commands."""
    return [
        *repeated("Include"), *repeated("Import"),
        ("scene of blanks", lambda: packed(2048 * MEBI, b"", b'Shape "sphere"', b" "), INFO),
        ("scene of one word", lambda: packed(2048 * MEBI, b"", b"", b"x"), INFO),
        ("scene of one string", lambda: packed(2048 * MEBI, b'Material "', b'"', b"x"), INFO),
        ("mesh with bytes behind it", lambda: mesh(gzip(2048 * MEBI, PLY % 3 + bytes(36) + FACE)), INFO),
        ("mesh of a point", lambda: mesh(gzip(1536 * MEBI, PLY % (128 * MEBI))), INFO),
        ("mesh without a header", lambda: mesh(gzip(2048 * MEBI, b"ply\n", b"", b"c")), INFO),
        *images(12000, 8, 2), *images(30000, 1, 0), *images(16000, 16, 6),
        ("loopsubdiv of 10 levels", lambda: subdivided(1), INFO),
        ("loopsubdiv of 10 levels, 50 times", lambda: subdivided(50), INFO),
        ("glTF points without bytes", lambda: gltf({"count": 3 * 10 ** 8}), GLTF),
        ("glTF sparse points", sparse, GLTF),
        ("glTF nodes below each other", lambda: gltf({"count": 3, "bufferView": 0}, 5000, 1), GLTF),
        ("glTF nodes with the same children", lambda: gltf({"count": 3, "bufferView": 0}, 9, 10), GLTF),
    ]


def run(work):
    cases = bombs()
    if work.count() < len(cases):
        cases = work.random.sample(cases, work.count())
    for title, make, arguments in cases:
        with work.folder() as folder:
            for name, data in make().items():
                part.write(folder, name, data)
            command = work.bidir(*arguments)
            work.case(title, runs.run(command, folder, LIMITS).fault(), folder, command)
