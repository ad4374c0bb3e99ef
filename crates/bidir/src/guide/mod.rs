//! The knowledge of training that estimators use: which light vertices suit a camera vertex, how many of
//! their shadow rays arrive, and where light subpaths begin.
//!
//! It knows no paths. A vertex asks for its [`Cell`] when it is made, weights ask for `count_factor`, selection
//! for `root_visibility`, and the light vertex cache draws by [`LightProposals`]. All of it is frozen before the
//! first pass.

mod cells;
mod proposals;

pub use cells::{Cell, Cells};
pub(crate) use proposals::{CellDraw, ProposalRow};
pub use proposals::{LightProposals, PairSums};

use crate::light::LightChoice;
use crate::math::Vec3;

/// The parts of a training that an estimator uses; the default has none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide<'a> {
    /// The choice of light vertices. None: each is as likely as others.
    pub proposals: Option<&'a LightProposals>,
    /// The choice of the light that light subpaths begin on. None: by power.
    pub light_start: Option<&'a LightChoice>,
}

impl<'a> Guide<'a> {
    /// The cell of a vertex with the unit normal `n`; the default one without proposals.
    #[inline]
    pub(crate) fn cell(&self, point: Vec3, n: Vec3) -> Cell {
        let cell = |all: &LightProposals| all.cells().of(point, n);
        self.proposals.map_or(Cell::default(), cell)
    }

    /// The choice of light vertices for camera vertices in the cell `y`. None: each is as likely as others.
    #[inline]
    pub(crate) fn row(&self, y: Cell) -> Option<&'a ProposalRow> {
        self.proposals.map(|all| all.row(y))
    }

    /// n κ / M: the number of samples of a connection of these cells, relative to uniform proposals; 1 without
    /// proposals. It is a function of the path alone.
    #[inline]
    pub(crate) fn count_factor(&self, light: Cell, camera: Cell) -> f64 {
        self.proposals
            .map_or(1.0, |all| all.count_factor(light, camera))
    }

    /// √V̂ of shadow rays between these cells; 1 without proposals.
    #[inline]
    pub(crate) fn root_visibility(&self, light: Cell, camera: Cell) -> f32 {
        self.proposals
            .map_or(1.0, |all| all.root_visibility(light, camera))
    }
}
