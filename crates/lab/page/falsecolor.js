// False colour: luminance on a scale of stops, by the colour map magma [SmithWalt15].

/** The ends of the scale, from the darkest colour to the brightest, in stops of exposed light. */
export const STOPS = [-8, 4];

/** Polynomials of degree 6 for red, green and blue, coded in sRGB; the constant first. */
export const MAGMA = [
  [-0.0021, 0.2505, 8.3459, -27.667, 52.1707, -50.7586, 18.6643],
  [-0.0007, 0.6945, -3.596, 14.2539, -27.9446, 29.0539, -11.49],
  [-0.0095, 2.4953, 0.3291, -13.6466, 12.8811, 4.2699, -5.5708],
];

/**
 * The colour at a place of the scale, as a CSS colour.
 * @param {number} t In [0, 1].
 */
export function magma(t) {
  const channels = MAGMA.map((fit) => {
    const value = fit.reduceRight((sum, factor) => sum * t + factor, 0);
    return Math.round(255 * Math.min(Math.max(value, 0), 1));
  });
  return `rgb(${channels.join(" ")})`;
}

/**
 * The luminances that are marked on the scale, from its dark end.
 * @param {number} exposure Unit: stops.
 * @returns {{t: number, value: number}[]}
 */
export function marks(exposure) {
  const [low, high] = STOPS;
  const count = 4;
  return Array.from({ length: count + 1 }, (_, i) => {
    const t = i / count;
    return { t, value: 2 ** (low + t * (high - low) - exposure) };
  });
}
