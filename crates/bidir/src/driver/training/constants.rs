//! The constants of training and of `auto`. They come from measurements (docs/performance.md) unless another source
//! is given.

/// The most samples of the survey: they give the mean luminance within a few percent in most scenes, and four times
/// as many change variances by 3 % at most. Unit: samples, a power of two.
pub(super) const MOST_SAMPLES: u64 = 1 << 14;
/// The most samples for each pixel, unless that leaves less than [`ENOUGH_SAMPLES`] in all. Unit: samples.
pub(super) const MOST_OF_PIXEL: u64 = 16;
/// The number of samples that a small film gets at least, if time allows. Unit: samples, a power of two.
pub(super) const ENOUGH_SAMPLES: u64 = 1 << 10;
/// The least samples from which training learns about connections. Unit: samples, a power of two.
pub(super) const LEARNING_SAMPLES: u64 = 1 << 6;
/// The number of first samples, whose work decides how many follow. Unit: samples, a power of two.
pub(super) const FIRST_SAMPLES: u64 = 1 << 4;
/// The number of groups that the threads share in a round of the survey.
pub(super) const GROUPS: u64 = 64;
/// The mean work of a sample beyond which training takes fewer samples: in most scenes it is less. Unit: rays and
/// connections.
pub(super) const USUAL_WORK: f64 = 256.0;

/// The most possible connections of a path that the log keeps. Of a path with more it keeps only the connection that
/// made the path, if one did: this bounds memory where subpaths are long.
pub(super) const MOST_PARTS: usize = 8;

/// The number of blocks along each side of the film. Variances are relative to the mean of their block.
pub(super) const BLOCKS_PER_SIDE: usize = 16;
/// The number of pixels of a block whose mean is judged beside single pixels: 16 x 16, as eyes and denoisers see.
pub(super) const BLOCK_PIXELS: f64 = 256.0;
/// ε relative to the square of the image's mean: bounds the weight of dark blocks.
pub(super) const DARK: f64 = 0.01;

/// The least variance of a plan: estimates may be negative, and where nothing varies, cost decides. Unit: the plan's
/// second moment.
pub(super) const LEAST_VARIANCE: f64 = 1e-6;
/// The least albedo by which a second moment is divided: bounds rare dark paths.
pub(super) const LEAST_ALBEDO: f32 = 1e-3;
/// The least share of a path by which a second moment is divided: a plan that misses a path is very bad, not
/// infinitely bad.
pub(super) const LEAST_SHARE: f64 = 1e-9;

/// The cost of a ray of a camera walk whose vertices are connected with shared light subpaths. Unit of this and the
/// next six costs: a ray of path tracing's walk. They fit the times of 15 scenes at 192 x 108 to 6 %.
pub(super) const CONNECTED_CAMERA_RAY: f64 = 1.8;
/// The cost of a ray of a light walk, including the choice of the light that it begins on.
pub(super) const LIGHT_RAY: f64 = 1.6;
/// The cost of a connection ray.
pub(super) const CONNECTION_RAY: f64 = 0.7;
/// The cost of a light point as a candidate, including the choice of its light.
pub(super) const LIGHT_POINT: f64 = 1.2;
/// The cost of a candidate that is a connection with a light walk.
pub(super) const CANDIDATE: f64 = 0.7;
/// The cost of a candidate between diffuse vertices, which are evaluated four at a time.
pub(super) const DIFFUSE_CANDIDATE: f64 = 0.12;
/// The cost of a splat of the light image, including its ray.
pub(super) const LIGHT_IMAGE: f64 = 1.0;

/// The most vertices of a light cache: 30 MB in each thread. Unit: vertices.
pub(super) const MOST_CACHED: f64 = 131_072.0;
/// The fraction of light subpaths that choose their light by power: variance of light that training missed grows at
/// most tenfold.
pub(super) const POWER_FRACTION: f64 = 0.1;
/// The weight of what training learned of all lights, beside what it learned of one. Unit: subpaths.
pub(super) const LIGHT_PRIOR: f64 = 16.0;
