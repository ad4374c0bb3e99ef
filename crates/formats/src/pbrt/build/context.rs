//! What building knows throughout: the description, what may stand in for what is missing, warnings.

use crate::error::ErrorKind;
use crate::pbrt::scene::{SceneDescription, Warning, warn};
use crate::source::{Fault, Span};

pub(super) struct Context<'a> {
    pub(super) description: &'a SceneDescription,
    /// True where a stand-in may replace what is not supported yet.
    lenient: bool,
    pub(super) warnings: Vec<Warning>,
}

impl<'a> Context<'a> {
    pub(super) fn new(description: &'a SceneDescription, lenient: bool) -> Self {
        Self {
            description,
            lenient,
            warnings: description.warnings.clone(),
        }
    }

    pub(super) fn warn(&mut self, span: Span, message: impl Into<String>) {
        warn(&mut self.warnings, span, message);
    }

    /// Something that the format has and the renderer has not: an error, or a warning that says
    /// what stands in.
    pub(super) fn unsupported(
        &mut self,
        span: Span,
        what: &str,
        stand_in: &str,
    ) -> Result<(), Fault> {
        if self.lenient {
            self.warn(span, format!("{what} is not supported yet: {stand_in}"));
            return Ok(());
        }
        let message = format!("{what} is recognised but not supported yet");
        let fault = Fault::new(ErrorKind::Unsupported, span, message);
        Err(fault.with_hint(format!("with --lenient: {stand_in}")))
    }
}
