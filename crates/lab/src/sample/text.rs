//! The report of a sample as a text: tables of the subpaths, of each kind of strategy, and the sums.

use super::SampleReport;
use super::subpath::{SubpathReport, VertexReport};
use super::term::{CandidateReport, SplatReport, TermReport};
use bidir::integrator::IntegratorKind;
use std::fmt::{self, Display, Formatter};

/// A point or direction, in columns.
struct Point([f32; 3]);

impl Display for Point {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "({x:>9.4} {y:>9.4} {z:>9.4})")
    }
}

/// Numbers of any size, in columns.
struct Triple([f32; 3]);

impl Display for Triple {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [a, b, c] = self.0;
        write!(f, "({a:>10.4e} {b:>10.4e} {c:>10.4e})")
    }
}

impl Display for SampleReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        writeln!(f, "pixel {x},{y} pass {}: {} rays", self.pass, self.rays)?;
        self.write_settings(f)?;
        write!(f, "\ncamera subpath, {}", self.camera)?;
        write!(f, "\nlight subpath, {}", self.light)?;
        self.write_hits(f)?;
        self.write_candidates(f)?;
        self.write_light_image(f)?;
        self.write_sums(f)
    }
}

impl SampleReport {
    fn write_settings(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let names = ["integrator", "shadow-rays", "mis", "strategies", "seed"];
        writeln!(f, "{}", self.settings.line(&names))?;
        let Some(training) = &self.training else {
            return Ok(());
        };
        writeln!(
            f,
            "training: {} samples with {} rays found an image mean of {:.4e}",
            training.samples,
            training.rays.total(),
            training.mean_luminance
        )?;
        match training.threshold {
            Some(threshold) => writeln!(
                f,
                "          connections with g >= {threshold:.4e} are certain, \
                 others have probability g / {threshold:.4e}"
            ),
            None => Ok(()),
        }
    }

    fn write_hits(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let count = self.hits.len();
        writeln!(f, "\nhits of lights, s = 0: {count}")?;
        if count > 0 {
            writeln!(f, "  {TERM_HEADER}  {:<35}", "adds w C")?;
        }
        for hit in &self.hits {
            writeln!(f, "  {hit}  {}", Added(hit))?;
        }
        Ok(())
    }

    fn write_candidates(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let count = self.candidates.len();
        writeln!(
            f,
            "\ncandidates for shadow rays, s >= 1 and t >= 2: {count}"
        )?;
        if count > 0 {
            writeln!(
                f,
                "  g, by which candidates are chosen, is the mean of the channels of w C{}",
                if self.settings.request.integrator == Some(IntegratorKind::Lvc) {
                    ", times √V̂ where visibility is learned"
                } else {
                    ""
                }
            )?;
            writeln!(
                f,
                "  {TERM_HEADER}  {:>10}  {:>11}  {:<10}  {:<7}  adds w C / probability",
                "g", "probability", "ray", "way"
            )?;
        }
        for candidate in &self.candidates {
            writeln!(f, "  {candidate}")?;
        }
        if !self.zeros.is_empty() {
            let zeros = self.zeros.join(" ");
            writeln!(f, "  zero (Dirac, facing away, or switched off): {zeros}")?;
        }
        Ok(())
    }

    fn write_light_image(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (count, paths) = (self.light_image.len(), self.light_paths);
        writeln!(
            f,
            "\nsplats to the light image, t = 1, of one of {} light subpaths: {count}",
            self.light_subpaths
        )?;
        if count > 0 {
            writeln!(
                f,
                "  {TERM_HEADER}  {:<7}  {:<19}  {:<11}  adds w C / {paths}, times the filter's part",
                "way", "lands at", "in pixel"
            )?;
        }
        for splat in &self.light_image {
            writeln!(f, "  {splat}")?;
        }
        Ok(())
    }

    fn write_sums(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nadded to the pixel   {}", Triple(self.value))?;
        writeln!(f, "  by hits            {}", Triple(self.value_of_hits))?;
        writeln!(
            f,
            "  by candidates      {}",
            Triple(self.value_of_candidates)
        )?;
        writeln!(
            f,
            "  if all were traced {}",
            Triple(self.value_of_all_candidates)
        )?;
        if self.dropped > 0 {
            writeln!(f, "dropped              {} contributions", self.dropped)?;
        }
        Ok(())
    }
}

impl Display for SubpathReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} vertices", self.vertices.len())?;
        for (i, vertex) in self.vertices.iter().enumerate() {
            writeln!(f, "  {i:>3}  {vertex}")?;
        }
        match self.escape {
            Some(direction) => writeln!(f, "       escapes along {}", Point(direction)),
            None => Ok(()),
        }
    }
}

impl Display for VertexReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let place = &self.place;
        let at = if place.is_infinite { "towards" } else { "at" };
        write!(f, "{:<7} {at} {}", self.kind, Point(place.position))?;
        write!(f, "  beta {}", Triple(self.beta))?;
        write!(
            f,
            "  pdf_fwd {:.4e}  pdf_rev {:.4e}",
            self.pdf_fwd, self.pdf_rev
        )?;
        if let Some(light) = self.light {
            write!(f, "  light {light}")?;
        }
        if self.is_delta {
            write!(f, "  delta")
        } else {
            Ok(())
        }
    }
}

/// Above the columns of a [`TermReport`].
const TERM_HEADER: &str = "  s   t  contribution C, unoccluded              weight w";

impl Display for TermReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let contribution = Triple(self.contribution);
        write!(
            f,
            "{:>3} {:>3}  {contribution}  {:>10.4e}",
            self.s, self.t, self.weight
        )
    }
}

/// The value that a term added.
struct Added<'a>(&'a TermReport);

impl Display for Added<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.0.is_dropped {
            f.write_str("dropped: not finite, or too large")
        } else if self.0.added.iter().all(|channel| *channel == 0.0) {
            f.write_str("nothing")
        } else {
            Triple(self.0.added).fmt(f)
        }
    }
}

/// The visibility of a connection, traced or not: true where the way is clear.
struct Way(bool);

impl Display for Way {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.pad(if self.0 { "clear" } else { "blocked" })
    }
}

impl Display for CandidateReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let score = self.score.map_or("-".to_owned(), |g| format!("{g:.4e}"));
        let ray = if self.is_chosen {
            "chosen"
        } else {
            "not chosen"
        };
        let (term, prob, way) = (&self.term, self.prob, Way(self.is_visible));
        write!(
            f,
            "{term}  {score:>10}  {prob:>11.4e}  {ray:<10}  {way:<7}  {}",
            Added(term)
        )
    }
}

impl Display for SplatReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y] = self.raster;
        let raster = format!("{x:.3},{y:.3}");
        let landed = self
            .landed
            .map_or("none".to_owned(), |[x, y]| format!("{x},{y}"));
        let (term, way) = (&self.term, Way(self.is_visible));
        write!(
            f,
            "{term}  {way:<7}  {raster:<19}  {landed:<11}  {}",
            Added(term)
        )
    }
}
