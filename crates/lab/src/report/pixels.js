// Pixels: from what is stored in the page to colours on the screen.

/**
 * An image as it is stored.
 * @typedef {object} StoredImage
 * @property {string} name
 * @property {boolean} is_reference
 * @property {number} width
 * @property {number} height
 * @property {string} halves Three half floats for each pixel, low byte first, in base64.
 * @property {string | null} flip One byte for each pixel, 254 for an error of 1, 255 for no number, in base64.
 */

/** @typedef {{name: string, images: StoredImage[]}} StoredScene */

/** @typedef {"image" | "relative" | "flip"} Layer */

/** What no number looks like: green, which no error has. */
const NO_NUMBER = [0, 255, 0];

/** The relative error that has the darkest colour, and the one that has the brightest. */
const RELATIVE_RANGE = [1e-4, 1e1];

/**
 * Bytes of a base64 text.
 * @param {string} text
 */
function bytesOf(text) {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}

/**
 * The number of a half float.
 * @param {number} bits
 */
function fromHalf(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const mantissa = bits & 1023;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  if (exponent === 31) return mantissa ? NaN : sign * Infinity;
  return sign * (1024 + mantissa) * 2 ** (exponent - 25);
}

/** Every half float, since there are few of them. */
const HALVES = Float32Array.from({ length: 65536 }, (_, bits) => fromHalf(bits));

/** An image whose pixels are decoded when they are first asked for. */
class Picture {
  /** @param {StoredImage} stored */
  constructor(stored) {
    this.stored = stored;
    this.name = stored.name;
    this.width = stored.width;
    this.height = stored.height;
    /** @type {Float32Array | null} */
    this.decoded = null;
    /**
     * What was asked for of `errorsOf`.
     * @type {Map<Layer, Float32Array | null>}
     */
    this.errors = new Map();
  }

  /** Three channels for each pixel, row by row from the top left. */
  get channels() {
    if (!this.decoded) {
      const bytes = bytesOf(this.stored.halves);
      this.decoded = new Float32Array(bytes.length / 2);
      for (let i = 0; i < this.decoded.length; i++) {
        this.decoded[i] = HALVES[bytes[2 * i] | (bytes[2 * i + 1] << 8)];
      }
    }
    return this.decoded;
  }

  /**
   * The three channels of a pixel.
   * @param {number} pixel
   */
  at(pixel) {
    return [0, 1, 2].map((channel) => this.channels[3 * pixel + channel]);
  }
}

/**
 * For every pixel the mean over the channels of (a - b)² / (b² + 0.01).
 * @param {Picture} image
 * @param {Picture} reference
 */
function relativeErrors(image, reference) {
  const [a, b] = [image.channels, reference.channels];
  return Float32Array.from({ length: a.length / 3 }, (_, pixel) => {
    let sum = 0;
    for (let i = 3 * pixel; i < 3 * pixel + 3; i++) {
      sum += (a[i] - b[i]) ** 2 / (b[i] ** 2 + 0.01);
    }
    return sum / 3;
  });
}

/**
 * The errors of a layer against the reference of the scene. Null: they are not known.
 * @param {Layer} layer
 * @param {Picture} image
 * @param {Picture | undefined} reference
 */
function errorsOf(layer, image, reference) {
  let errors = image.errors.get(layer);
  if (errors === undefined) {
    errors = computedErrors(layer, image, reference);
    image.errors.set(layer, errors);
  }
  return errors;
}

/**
 * The same, computed anew.
 * @param {Layer} layer
 * @param {Picture} image
 * @param {Picture | undefined} reference
 */
function computedErrors(layer, image, reference) {
  const isReference = image === reference;
  if (layer === "flip") {
    if (isReference) return new Float32Array(image.width * image.height);
    const fraction = (/** @type {number} */ byte) => (byte === 255 ? NaN : byte / 254);
    return image.stored.flip ? Float32Array.from(bytesOf(image.stored.flip), fraction) : null;
  }
  const isComparable = reference && reference.width === image.width && reference.height === image.height;
  return isComparable ? relativeErrors(image, reference) : null;
}

/**
 * The colour map magma, as the program's own error maps have it.
 * @param {number} t Range: [0, 1].
 */
function magma(t) {
  const fit = [
    [-0.0021, 0.2505, 8.3459, -27.667, 52.1707, -50.7586, 18.6643],
    [-0.0007, 0.6945, -3.596, 14.2539, -27.9446, 29.0539, -11.49],
    [-0.0095, 2.4953, 0.3291, -13.6466, 12.8811, 4.2699, -5.5708],
  ];
  return fit.map((powers) => 255 * powers.reduceRight((sum, factor) => sum * t + factor, 0));
}

/**
 * Where an error is between the darkest and the brightest colour.
 * @param {Layer} layer
 * @param {number} error
 */
function errorFraction(layer, error) {
  if (layer === "flip") return Math.min(error, 1);
  const [low, high] = RELATIVE_RANGE;
  const fraction = Math.log(Math.max(error, low) / low) / Math.log(high / low);
  return Math.min(fraction, 1);
}

/**
 * Errors as colours.
 * @param {Layer} layer
 * @param {Float32Array} errors
 * @param {ImageData} target
 */
function paintErrors(layer, errors, target) {
  errors.forEach((error, pixel) => {
    const color = Number.isNaN(error) ? NO_NUMBER : magma(errorFraction(layer, error));
    target.data.set([...color, 255], 4 * pixel);
  });
}

/** The bytes that sRGB gives to 65536 equal steps of light. */
const SRGB = Uint8Array.from({ length: 65536 }, (_, step) => {
  const light = step / 65535;
  const stored = light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055;
  return Math.round(255 * stored);
});

/**
 * Light as colours: exposed, clipped, and brought to the screen.
 * @param {Picture} image
 * @param {number} stops
 * @param {string} curve `srgb` or `linear`.
 * @param {ImageData} target
 */
function paintLight(image, stops, curve, target) {
  const channels = image.channels;
  const scale = 2 ** stops;
  for (let pixel = 0; pixel < channels.length / 3; pixel++) {
    let isNumber = true;
    for (let channel = 0; channel < 3; channel++) {
      const light = Math.min(Math.max(channels[3 * pixel + channel] * scale, 0), 1);
      isNumber &&= !Number.isNaN(light);
      target.data[4 * pixel + channel] = curve === "srgb" ? SRGB[Math.round(65535 * light)] : 255 * light;
    }
    if (!isNumber) target.data.set(NO_NUMBER, 4 * pixel);
    target.data[4 * pixel + 3] = 255;
  }
}

/**
 * The mean of numbers.
 * @param {Float32Array} numbers
 */
function meanOf(numbers) {
  return numbers.reduce((sum, number) => sum + number, 0) / numbers.length;
}
