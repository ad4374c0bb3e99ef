//! The numbers of training and of `auto`. Their sources are measurements (docs/performance.md) where no other
//! is given.

/// The most samples of the survey: the mean luminance is then within a few percent in most scenes, and four
/// times as many change variances by 3 % at most. Unit: samples, a power of two.
pub(super) const MOST_SAMPLES: u64 = 1 << 14;
/// The most samples for each pixel, where that gives at least [`ENOUGH_SAMPLES`] in all. Unit: samples.
pub(super) const MOST_OF_PIXEL: u64 = 16;
/// Small films have at least as many, if work allows it. Unit: samples, a power of two.
pub(super) const ENOUGH_SAMPLES: u64 = 1 << 10;
/// Nothing is learned about connections from fewer. Unit: samples, a power of two.
pub(super) const LEARNING_SAMPLES: u64 = 1 << 6;
/// The first samples, whose work decides how many follow. Unit: samples, a power of two.
pub(super) const FIRST_SAMPLES: u64 = 1 << 4;
/// Groups of samples for the threads to share. Unit: groups in a round of the survey.
pub(super) const GROUPS: u64 = 64;
/// The work of a sample beyond which there are fewer: samples of most scenes stay below. Unit: rays and
/// connections.
pub(super) const USUAL_WORK: f64 = 256.0;

/// A path of more possible connections than these adds only the one that made it, if one did: this bounds memory
/// where subpaths are long.
pub(super) const MOST_PARTS: usize = 8;

/// Blocks along each side of the film, of each of which variances are relative to the mean.
pub(super) const BLOCKS_PER_SIDE: usize = 16;
/// The pixels of a block whose mean is judged beside pixels: 16 x 16, as eyes and denoisers see.
pub(super) const BLOCK_PIXELS: f64 = 256.0;
/// ε relative to the square of the image's mean: bounds what dark blocks count.
pub(super) const DARK: f64 = 0.01;

/// The least variance of a plan, as estimates may be negative: where nothing varies, cost decides. Unit: its second
/// moment.
pub(super) const LEAST_VARIANCE: f64 = 1e-6;
/// The least albedo that a second moment is divided by: bounds rare dark paths.
pub(super) const LEAST_ALBEDO: f32 = 1e-3;
/// The least share of a path that a second moment is divided by: a missed path makes a plan very bad, not
/// infinitely so.
pub(super) const LEAST_SHARE: f64 = 1e-9;

/// The cost of a ray of a camera walk whose vertices are connected with shared light subpaths. Unit of this
/// and the next six, which fit the times of 15 scenes at 192 x 108 to 6 %: a ray of path tracing's walk.
pub(super) const CONNECTED_CAMERA_RAY: f64 = 1.8;
/// The cost of a ray of a light walk, with the light that it begins on.
pub(super) const LIGHT_RAY: f64 = 1.6;
/// The cost of a connection ray.
pub(super) const CONNECTION_RAY: f64 = 0.7;
/// The cost of a light point as a candidate, with the choice of its light.
pub(super) const LIGHT_POINT: f64 = 1.2;
/// The cost of a candidate that is a connection with a light walk.
pub(super) const CANDIDATE: f64 = 0.7;
/// The cost of a candidate of diffuse vertices, four of which are evaluated at a time.
pub(super) const DIFFUSE_CANDIDATE: f64 = 0.12;
/// The cost of a light image, with its ray.
pub(super) const LIGHT_IMAGE: f64 = 1.0;

/// The vertices of a light cache, of which each thread has one: 30 MB. Unit: vertices.
pub(super) const MOST_CACHED: f64 = 131_072.0;
/// The fraction of light subpaths that begin on a light by power: light that training missed costs at most ten
/// times as much.
pub(super) const POWER_FRACTION: f64 = 0.1;
/// The strength of what is known of all lights beside what is learned of one. Unit: subpaths.
pub(super) const LIGHT_PRIOR: f64 = 16.0;
