// The meanings of the terms in a report.

/** Metrics; of each of them less is better. A test holds that none is missing. */
export const METRICS = new Map([
  ["rmse", "Root of the mean square error: the root of the mean, over all pixels and channels, of (image − reference)²."],
  [
    "relmse",
    "Relative mean square error: the mean, over all pixels and channels, of (image − reference)² / (reference² + 0.01). Dark and bright regions count alike.",
  ],
  [
    "rmse_trim",
    "rmse without the 0.1 % of pixels that have the largest error: what is left when a few very bright pixels are set aside. Biased downwards.",
  ],
  ["relmse_trim", "relmse without the 0.1 % of pixels that have the largest error."],
  [
    "relmse_block",
    "relmse of the means over blocks of 16 × 16 pixels: the error that is left where noise of single pixels averages out, such as that which neighbours share.",
  ],
  ["mape", "Mean absolute relative error: the mean, over all pixels and channels, of |image − reference| / (|reference| + 0.01)."],
  [
    "flip",
    "The difference that an observer sees when image and reference alternate at the same place on a screen that shows 0 to 1: 0 is none, 1 is black for white. The mean over all pixels.",
  ],
  ["flip_hdr", "The same for light of any strength: each pixel at the exposure at which the difference is seen best."],
]);

/**
 * Other words.
 * @param {string} ratios How ratios are found.
 * @returns {[string, string][]}
 */
export function words(ratios) {
  return [
    [
      "efficiency",
      "1 / (mean square error · cost), with the cost in rays or in seconds. Twice the efficiency gives the same error for half the cost. Training is part of both costs.",
    ],
    [
      "interval [low, high]",
      "Such intervals contain the true value in the stated share of repetitions of the whole experiment; 95 of 100 where nothing else is said. They are taken over independent seeds; those of means are Student's.",
    ],
    ["ratio", ratios],
    [
      "reproduced, not reproduced, undecided",
      "The results confirm the claim, or contradict it, and the intervals leave no doubt; otherwise it is undecided.",
    ],
    ["met, not met, not measured", "The target is reached, or is missed, and the interval leaves no doubt; or it was not measured."],
    [
      "processor seconds",
      "The processor time of all threads, as user and as system, training included: on a busy machine the same work takes more seconds, but hardly more processor seconds.",
    ],
    [
      "reference",
      "An image that is nearly exact: rendered with far more samples than what is compared with it, as described for each scene. Its own noise is in all errors.",
    ],
    ["samples per pixel, spp", "For each sample of a pixel one path is walked from the camera and one from a light."],
    [
      "rays",
      "Rays of all kinds: those of both walks, shadow rays between them, shadow rays to the camera, and those of training, which the claims on the 1995 paper leave out.",
    ],
    [
      "strategy (s, t)",
      "A way to make a path: s vertices are walked from a light and t from the camera, and the two ends are joined. A path of n vertices has n strategies, from s = 0 to t = 1.",
    ],
    [
      "weighted, raw",
      "Of a contribution, with the weight by which strategies share the paths that several of them can make, and without it.",
    ],
    ["seed", "It selects the random numbers. Renders with different seeds are independent."],
    [
      "log-log plot",
      "Equal distances are equal factors. The error of an unbiased method falls along a straight line: its mean square by a factor of ten for ten times the cost.",
    ],
  ];
}
