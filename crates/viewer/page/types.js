// Types of the messages of the server: `Status` by the socket, the others as answers to requests.

/** @typedef {import("./pixels.js").LaneName} LaneName */

/** @typedef {[number, number, number]} Triple Linear Rec. 709, or a point. */

/**
 * Rays by what they are for.
 * @typedef {{camera: number, light: number, connection: number, lightImage: number}} Rays
 */

/**
 * One render, of at most two that run side by side.
 * @typedef {object} Lane
 * @property {LaneName} lane
 * @property {number} generation Grows whenever it begins anew.
 * @property {{[name: string]: unknown}} settings
 * @property {string} integrator
 * @property {string} shadowRays
 * @property {number} passes
 * @property {number | null} target The passes it ends after; null: none.
 * @property {number} seconds
 * @property {number | null} eta Unit: seconds.
 * @property {number} samplesPerSecond
 * @property {Rays} raysPerSecond
 * @property {Rays} raysPerSample
 * @property {number | null} relativeError
 * @property {[number, number][]} curve Seconds and relative errors.
 * @property {number} strategyVertices 0: no images of strategies are kept.
 * @property {boolean} preview Whether it renders fewer pixels than the film has, since the camera moves.
 */

/** @typedef {"preparing" | "rendering" | "paused" | "done" | "failed"} RenderState */

/**
 * @typedef {object} Camera
 * @property {string} kind
 * @property {Triple} origin
 * @property {Triple} target
 * @property {Triple} up
 * @property {boolean} moved
 */

/**
 * @typedef {object} Status
 * @property {string} version
 * @property {string} scene
 * @property {RenderState} state
 * @property {string | null} message
 * @property {boolean} controls False: this page may only look.
 * @property {{resolution: [number, number], crop: [number, number, number, number]}} film
 * @property {{integrators: string[], shadowRays: string[]}} choices
 * @property {Camera | null} camera Null: it cannot be moved.
 * @property {boolean} split
 * @property {Lane[]} lanes
 */

/**
 * The values of a pixel.
 * @typedef {object} PixelReport
 * @property {number} x
 * @property {number} y
 * @property {Triple} mean
 * @property {Triple} standardError
 * @property {number} samples
 * @property {number | null} rays
 * @property {number} passes
 * @property {number} generation
 */

/** @typedef {import("./tiles.js").StrategyTile & {name: string}} StrategyTile */

/**
 * @typedef {object} StrategyReport
 * @property {number} generation
 * @property {number} passes
 * @property {number} vertices
 * @property {StrategyTile[]} tiles
 * @property {number} longerMean
 */

/**
 * @typedef {object} SampleVertex
 * @property {string} kind
 * @property {Triple} position
 * @property {boolean} is_infinite
 * @property {boolean} is_delta
 * @property {Triple} beta
 * @property {[number, number] | null} raster Where it is on the film; null behind the camera.
 */

/** @typedef {{vertices: SampleVertex[], escape: Triple | null}} SampleSubpath */

/** @typedef {{position: Triple, is_infinite: boolean, raster: [number, number] | null}} Place */

/**
 * The part that all strategies share. `value` is w C; `added` is what the pixel got.
 * @typedef {{s: number, t: number, contribution: Triple, weight: number, value: Triple, added: Triple}} SampleTerm
 */

/**
 * @typedef {SampleTerm & {light_end: Place, score: number | null, prob: number, is_chosen: boolean, is_visible: boolean}} SampleCandidate
 */

/** @typedef {SampleTerm & {light_end: Place, is_visible: boolean, raster: [number, number]}} SampleSplat */

/**
 * One sample, step by step.
 * @typedef {object} SampleReport
 * @property {number} generation That of the lane; 0 for one of a server that went away.
 * @property {[number, number]} pixel
 * @property {number} pass
 * @property {SampleSubpath} camera
 * @property {SampleSubpath} light
 * @property {SampleTerm[]} hits
 * @property {SampleCandidate[]} candidates
 * @property {string[]} zeros
 * @property {SampleSplat[]} light_image
 * @property {Triple} value
 * @property {Triple} value_of_all_candidates
 * @property {number} rays
 */

export {};
