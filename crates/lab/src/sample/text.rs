//! The report of a sample as text: tables of the subpaths and of each kind of strategy, and the sums.

use super::report::{RayReport, SampleReport, SubpathReport, TermReport, VertexReport};
use super::training::TrainingReport;
use bidir::driver::Landing;
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

/// The columns that all terms have.
const TERM: &str = "    s   t  contribution C, unoccluded              weight w";

impl Display for SampleReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        let names = ["integrator", "shadow-rays", "mis", "strategies", "seed"];
        writeln!(f, "pixel {x},{y} pass {}: {} rays", self.pass, self.rays)?;
        writeln!(f, "{}", self.settings.line(&names))?;
        self.training
            .iter()
            .try_for_each(|training| write!(f, "{training}"))?;
        write!(
            f,
            "\ncamera subpath, {}\nlight subpath, {}",
            self.camera, self.light
        )?;
        table(
            f,
            "hits of lights, s = 0",
            &format!("{TERM}  adds w C"),
            &self.hits,
        )?;
        self.write_candidates(f)?;
        let title = format!(
            "splats to the light image, t = 1, of one of {} light subpaths",
            self.light_subpaths
        );
        let columns = format!(
            "{TERM}  way      lands at             in pixel     adds w C / {}, times the filter's part",
            self.light_paths
        );
        table(f, &title, &columns, &self.light_image)?;
        self.write_sums(f)
    }
}

/// Writes the terms of a kind as a table: their number, the heads of the columns, and the rows.
fn table(f: &mut Formatter<'_>, title: &str, columns: &str, rows: &[impl Display]) -> fmt::Result {
    writeln!(f, "\n{title}: {}", rows.len())?;
    if !rows.is_empty() {
        writeln!(f, "{columns}")?;
    }
    rows.iter().try_for_each(|row| writeln!(f, "  {row}"))
}

impl SampleReport {
    fn write_candidates(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let is_lvc = self.settings.request.integrator == Some(IntegratorKind::Lvc);
        let learned = ["", ", times √V̂ where visibility is learned"][usize::from(is_lvc)];
        let columns = format!(
            "  g, by which candidates are chosen, is the mean of the channels of w C{learned}\n\
             {TERM}           g  probability  ray         way      adds w C / probability"
        );
        table(
            f,
            "candidates for shadow rays, s >= 1 and t >= 2",
            &columns,
            &self.candidates,
        )?;
        if !self.zeros.is_empty() {
            let zeros = self.zeros.join(" ");
            writeln!(f, "  zero (Dirac, facing away, or switched off): {zeros}")?;
        }
        Ok(())
    }

    fn write_sums(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f)?;
        for (name, sum) in [
            ("added to the pixel", self.value),
            ("  by hits", self.value_of_hits),
            ("  by candidates", self.value_of_candidates),
            ("  if all were traced", self.value_of_all_candidates),
        ] {
            writeln!(f, "{name:<20} {}", Triple(sum))?;
        }
        if self.dropped > 0 {
            writeln!(f, "dropped              {} contributions", self.dropped)?;
        }
        Ok(())
    }
}

impl Display for TrainingReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (samples, rays, mean) = (self.samples, self.rays.total(), self.mean_luminance);
        writeln!(
            f,
            "training: {samples} samples with {rays} rays found an image mean of {mean:.4e}"
        )?;
        let Some(g) = self.threshold else {
            return Ok(());
        };
        write!(f, "          connections with g >= {g:.4e} are certain, ")?;
        writeln!(f, "others have probability g / {g:.4e}")
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
        let at = ["at", "towards"][usize::from(self.place.is_infinite)];
        write!(f, "{:<7} {at} {}", self.kind, Point(self.place.position))?;
        write!(f, "  beta {}", Triple(self.beta))?;
        write!(
            f,
            "  pdf_fwd {:.4e}  pdf_rev {:.4e}",
            self.pdf_fwd, self.pdf_rev
        )?;
        if let Some(light) = self.light {
            write!(f, "  light {light}")?;
        }
        f.write_str(if self.is_delta { "  delta" } else { "" })
    }
}

/// Writes the columns of [`TERM`], those of the shadow ray, and the value that the term added.
impl Display for TermReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (contribution, weight) = (Triple(self.contribution), self.weight);
        write!(
            f,
            "{:>3} {:>3}  {contribution}  {weight:>10.4e}",
            self.s, self.t
        )?;
        if let Some(ray) = &self.ray {
            write!(f, "{ray}")?;
        }
        if self.is_dropped {
            write!(f, "  dropped: not finite, or too large")
        } else if self.added.iter().all(|channel| *channel == 0.0) {
            write!(f, "  nothing")
        } else {
            write!(f, "  {}", Triple(self.added))
        }
    }
}

impl Display for RayReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if let Some(choice) = &self.choice {
            let score = choice.score.map_or("-".to_owned(), |g| format!("{g:.4e}"));
            let ray = ["not chosen", "chosen"][usize::from(choice.is_chosen)];
            write!(f, "  {score:>10}  {:>11.4e}  {ray:<10}", choice.prob)?;
        }
        let way = ["blocked", "clear"][usize::from(self.is_visible)];
        write!(f, "  {way:<7}")?;
        let Some(Landing { raster, pixel }) = self.landing else {
            return Ok(());
        };
        let at = format!("{:.3},{:.3}", raster[0], raster[1]);
        let pixel = pixel.map_or("none".to_owned(), |[x, y]| format!("{x},{y}"));
        write!(f, "  {at:<19}  {pixel:<11}")
    }
}
