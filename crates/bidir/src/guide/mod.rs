//! The knowledge from training that estimators use: probabilities of light vertices for a camera vertex, visibilities
//! of their shadow rays, and the light on which light subpaths begin.
//!
//! This module does not know paths. A vertex asks for its [`Cell`] when it is made, weights ask for `count_factor`,
//! selection for `root_visibility`, and the light vertex cache draws by [`LightProposals`]. All of it is fixed before
//! the first pass.

mod cells;
mod proposals;

pub use cells::{Cell, Cells};
pub(crate) use proposals::{CellDraw, Part, ProposalRow, inverse_prob};
pub use proposals::{LightProposals, PairSums};

use crate::light::LightChoice;
use crate::math::Vec3;

/// The results of training that an estimator uses; the default has none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guide<'a> {
    /// The choice of light vertices. None: all are equally likely.
    pub proposals: Option<&'a LightProposals>,
    /// The choice of the light on which a light subpath begins. None: by power.
    pub light_start: Option<&'a LightChoice>,
}

impl<'a> Guide<'a> {
    /// Returns the cell of a vertex with the unit normal `n`; without proposals it is the default.
    #[inline]
    pub(crate) fn cell(&self, point: Vec3, n: Vec3) -> Cell {
        let cell = |all: &LightProposals| all.cells.of(point, n);
        self.proposals.map_or(Cell::default(), cell)
    }

    /// Returns the knowledge of connections of camera vertices in the cell `y`.
    #[inline]
    pub(crate) fn of_camera(&self, y: Cell) -> CellGuide<'a> {
        CellGuide(self.proposals.map(|all| (all, all.row(y))))
    }
}

/// The knowledge of the connections of camera vertices of one cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellGuide<'a>(Option<(&'a LightProposals, &'a ProposalRow)>);

impl<'a> CellGuide<'a> {
    /// Returns the choice of light vertices. None: all are equally likely.
    #[inline]
    pub(crate) fn row(self) -> Option<&'a ProposalRow> {
        self.0.map(|(_, row)| row)
    }

    /// Returns n κ / M: the number of samples of a connection with the cell `light`, relative to uniform proposals; 1
    /// without proposals. It depends only on the path.
    #[inline(always)]
    pub(crate) fn count_factor(self, light: Cell) -> f64 {
        self.0
            .map_or(1.0, |(all, row)| all.count_factor(light, row))
    }

    /// Returns √V̂ of shadow rays from the cell `light`; 1 without proposals.
    #[inline(always)]
    pub(crate) fn root_visibility(self, light: Cell) -> f32 {
        self.0.map_or(1.0, |(_, row)| row.root_visibility(light))
    }
}
