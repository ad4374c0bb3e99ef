// Types of the data of the report's page: `results.json` with its tables, plots and images. Numbers that
// are not finite are null.

/** @typedef {{value: number | null, low: number | null, high: number | null}} Interval */

/** @typedef {string | number | null | Interval} Cell */

/** @typedef {{caption: string, columns: string[], rows: Cell[][]}} Table */

/** @typedef {"linear" | "log"} Scale */

/** @typedef {{label: string, scale: Scale}} Axis */

/**
 * A curve with its intervals, or none. Null is what is no number.
 * @typedef {object} Series
 * @property {string} name
 * @property {[number | null, number | null][]} points
 * @property {[number | null, number | null][]} intervals
 */

/** @typedef {{caption: string, kind: "lines" | "histogram", x: Axis, y: Axis, series: Series[]}} Plot */

/** @typedef {"reproduced" | "not-reproduced" | "undecided" | "met" | "not-met" | "not-measured"} Verdict */

/**
 * @typedef {object} Claim
 * @property {string} id
 * @property {string} claim
 * @property {string} source
 * @property {Verdict} verdict
 * @property {string} found
 * @property {string} method
 * @property {Table[]} tables
 * @property {Plot[]} plots
 */

/**
 * @typedef {object} SceneInfo
 * @property {string} name
 * @property {string} file
 * @property {string} digest
 * @property {[number, number]} size
 * @property {string} reference
 * @property {string | null} reference_image
 * @property {number | null} reference_mse
 */

/** @typedef {{name: string, settings: {[name: string]: string}}} Method */

/** @typedef {{name: string, kind: "samples" | "rays" | "seconds", amount: number}} Budget */

/** @typedef {{seed: number | string, seconds: number, rays: {[kind: string]: number}}} RenderRecord */

/**
 * @typedef {object} Strategy
 * @property {number} s
 * @property {number} t
 * @property {number} mean
 * @property {number} raw_mean
 * @property {number | null} variance
 * @property {number} rays
 * @property {number} blocked
 */

/**
 * @typedef {object} PyramidInfo
 * @property {string} scene
 * @property {string} method
 * @property {number | string} seed
 * @property {number} spp
 * @property {[number, number]} size
 * @property {number} vertices
 * @property {number} mean
 * @property {number} longer
 * @property {Strategy[]} strategies
 */

/**
 * @typedef {object} Results
 * @property {string} title
 * @property {string} description
 * @property {string} program
 * @property {{processor: string, threads: number, isa: string, system: string}} machine
 * @property {SceneInfo[]} scenes
 * @property {Method[]} methods
 * @property {Budget[]} budgets
 * @property {RenderRecord[]} records
 * @property {PyramidInfo[]} [pyramids]
 * @property {Claim[]} claims
 */

/**
 * An image as it is stored: `halves` are three half floats for each pixel, low byte first, `flip` one
 * byte, 254 for an error of 1 and 255 for no number; both in base64.
 * @typedef {object} StoredImage
 * @property {string} scene
 * @property {string} name
 * @property {boolean} is_reference
 * @property {[number, number]} size
 * @property {string} halves
 * @property {string | null} flip
 */

/** The images of a pyramid by the names of their layers. @typedef {{[layer: string]: string}} Layers */

/**
 * @typedef {object} Report
 * @property {Results} results
 * @property {Table[]} tables
 * @property {Plot[]} plots
 * @property {StoredImage[]} images
 * @property {Layers[]} layers One for each pyramid.
 * @property {{scene: string, method: string, budget: string, share: number}[]} noises
 * @property {string} ratios How ratios are found.
 * @property {number} most_flip_pixels
 * @property {string} command
 */

export {};
