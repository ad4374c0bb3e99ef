// Reads an OpenEXR image of scan lines, of floats, uncompressed or by ZIP: as much of the format as
// this program writes, read apart from it.

import { inflateSync } from "node:zlib";

const NONE = 0;
const ZIPS = 2;
const ZIP = 3;
const FLOAT = 2;

/** Bytes, one after the other. */
class Reader {
  /** @param {Buffer} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  text() {
    const end = this.bytes.indexOf(0, this.at);
    const text = this.bytes.toString("latin1", this.at, end);
    this.at = end + 1;
    return text;
  }

  int() {
    this.at += 4;
    return this.bytes.readInt32LE(this.at - 4);
  }

  /** @param {number} count */
  take(count) {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }
}

/** @param {Reader} reader */
function header(reader) {
  if (reader.int() !== 20000630) throw new Error("this is no OpenEXR file");
  const version = reader.int();
  if (version & 0x1a00) throw new Error("tiles, deep data and several parts are not read");
  /** @type {Map<string, Buffer>} */
  const attributes = new Map();
  for (let name = reader.text(); name !== ""; name = reader.text()) {
    reader.text();
    attributes.set(name, reader.take(reader.int()));
  }
  return attributes;
}

/** @param {Buffer} list */
function channelNames(list) {
  const reader = new Reader(list);
  const names = [];
  for (let name = reader.text(); name !== ""; name = reader.text()) {
    const kind = reader.int();
    reader.take(12);
    if (kind !== FLOAT) throw new Error(`the channel ${name} is not of floats`);
    names.push(name);
  }
  return names;
}

/**
 * Undoes what is done to bytes before they are deflated: differences, and halves apart.
 * @param {Buffer} packed
 * @param {number} length
 */
function unzip(packed, length) {
  // A block that does not get smaller is stored unpacked.
  if (packed.length === length) return packed;
  const bytes = inflateSync(packed);
  for (let i = 1; i < bytes.length; i++) bytes[i] = (bytes[i - 1] + bytes[i] - 128) & 255;
  const half = (bytes.length + 1) >> 1;
  return Buffer.from(bytes.map((_, i) => bytes[(i & 1 ? half : 0) + (i >> 1)]));
}

/**
 * The image's size, and each channel's values, row by row from the top.
 * @param {Buffer} bytes
 */
export function readExr(bytes) {
  const reader = new Reader(bytes);
  const attributes = header(reader);
  const attribute = (/** @type {string} */ name) => attributes.get(name) ?? Buffer.alloc(16);
  const [x0, y0, x1, y1] = [0, 4, 8, 12].map((at) => attribute("dataWindow").readInt32LE(at));
  const [width, height] = [x1 - x0 + 1, y1 - y0 + 1];
  const names = channelNames(attribute("channels"));
  const compression = attribute("compression")[0];
  const rows = new Map([[NONE, 1], [ZIPS, 1], [ZIP, 16]]).get(compression);
  if (!rows) throw new Error(`the compression ${compression} is not read`);
  const channels = new Map(names.map((name) => [name, new Float32Array(width * height)]));
  const blocks = Math.ceil(height / rows);
  reader.take(8 * blocks);
  for (let block = 0; block < blocks; block++) {
    const first = reader.int() - y0;
    const count = Math.min(rows, height - first);
    const data = unzip(reader.take(reader.int()), 4 * count * width * names.length);
    let at = 0;
    for (let y = first; y < first + count; y++) {
      for (const values of channels.values()) {
        for (let x = 0; x < width; x++, at += 4) values[y * width + x] = data.readFloatLE(at);
      }
    }
  }
  return { width, height, origin: [x0, y0], channels };
}
