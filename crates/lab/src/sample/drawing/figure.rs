//! The lines of a sample: subpaths, candidates and splats.

use super::super::report::{SampleReport, SubpathReport, TermReport};
use super::super::view::Place;
use super::shapes::{circle, polyline, px, text};
use super::view::View;
use crate::number::number;
use bidir::math::{Vec2, Vec3};
use bidir::spectrum::luminance;

/// The line between the ends of two subpaths: a candidate, or a splat.
pub(super) struct Ray {
    /// The CSS class, which determines colour and dashes.
    pub(super) class: &'static str,
    pub(super) light_end: Place,
    camera_end: Place,
    /// True if the light end is not a vertex of the light subpath.
    pub(super) is_foreign: bool,
    /// Strategy and value, in words.
    title: String,
    /// The luminance of a candidate's value times its probability; 0 for a splat, which is part of another pixel.
    pub(super) weight: f32,
}

impl Ray {
    /// Returns all rays of a sample.
    pub(super) fn all(report: &SampleReport) -> Vec<Self> {
        let all = report.candidates.iter().chain(&report.light_image);
        all.filter_map(|term| Self::new(report, term)).collect()
    }

    /// Returns the ray of a term. None: it has none.
    fn new(report: &SampleReport, term: &TermReport) -> Option<Self> {
        let ray = term.ray.as_ref()?;
        let z = report.light.vertices.get(usize::from(term.s) - 1);
        let y = report.camera.vertices.get(usize::from(term.t) - 1);
        let (value, prob) = (
            luminance(term.value),
            term.choice().map(|choice| choice.prob),
        );
        let probability = prob.map(|prob| format!(", probability {}", number(prob)));
        Some(Self {
            class: match (term.choice().map(|choice| choice.is_chosen), ray.is_visible) {
                (None, true) => "splat",
                (None, false) => "splat hidden",
                (Some(false), _) => "untraced",
                (Some(true), false) => "blocked",
                (Some(true), true) => "arrives",
            },
            light_end: ray.light_end,
            camera_end: y.map_or(report.eye, |y| y.place),
            is_foreign: z.is_none_or(|z| z.place != ray.light_end),
            title: format!(
                "s{}t{}: w C = {}{}",
                term.s,
                term.t,
                number(f64::from(value)),
                probability.unwrap_or_default()
            ),
            weight: prob.map_or(0.0, |prob| value * prob as f32),
        })
    }

    /// Returns the line, whose width grows with its weight relative to the largest one. None: both ends are at
    /// infinity.
    pub(super) fn draw(&self, view: &View<'_>, largest: f32) -> Option<String> {
        let (light, camera) = (self.light_end, self.camera_end);
        if light.is_infinite && camera.is_infinite {
            return None;
        }
        let from = view.seen_from(&light, camera.point);
        let to = view.seen_from(&camera, light.point);
        // The maximum is a number also where the weight is none.
        let width = px(1.2 + 3.0 * (self.weight / largest).max(0.0).sqrt());
        let (title, line) = (&self.title, polyline(&[from, to], self.class));
        let hollow = self.is_foreign.then(|| circle(from, 2.8, "light hollow"));
        let mark = hollow.unwrap_or_default();
        Some(format!(
            "<g stroke-width=\"{width}\">\n<title>{title}</title>\n{line}{mark}</g>\n"
        ))
    }
}

/// A subpath in the drawing.
pub(super) struct Walk {
    class: &'static str,
    letter: char,
    pub(super) places: Vec<Place>,
    /// The direction in which the subpath leaves the scene.
    escape: Option<Vec3>,
}

impl Walk {
    pub(super) fn new(class: &'static str, letter: char, subpath: &SubpathReport) -> Self {
        Self {
            class,
            letter,
            places: subpath.vertices.iter().map(|v| v.place).collect(),
            escape: subpath.escape.map(Vec3::from),
        }
    }

    /// Returns the vertices on the page. A vertex at infinity is on the border, in its direction from the next vertex.
    fn points(&self, view: &View<'_>) -> Vec<Vec2> {
        let middle = view.near_point(view.corner + 0.5 * view.size());
        let point = |i: usize| {
            let next = self.places.get(i + 1).filter(|next| !next.is_infinite);
            view.seen_from(&self.places[i], next.map_or(middle, |next| next.point))
        };
        (0..self.places.len()).map(point).collect()
    }

    pub(super) fn draw(&self, view: &View<'_>) -> String {
        let (class, points) = (self.class, self.points(view));
        let track = polyline(&points, "track");
        let arrow = self.arrow(view).unwrap_or_default();
        let dots = points.iter().map(|at| circle(*at, 4.2, "vertex"));
        let marks: String = dots.collect();
        format!("<g class=\"{class}\">\n{track}{arrow}{marks}</g>\n")
    }

    /// Returns the arrow from the last vertex to the border. None: the walk does not leave the scene.
    fn arrow(&self, view: &View<'_>) -> Option<String> {
        let last = self.places.last().filter(|last| !last.is_infinite)?;
        let from = view.seen_from(last, last.point);
        let to = view.border(last.point, self.escape?);
        let along = (to - from).try_normalize()?;
        let (back, side) = (along * -9.0, along.perp() * 4.0);
        let line = [from, to, to + back + side, to, to + back - side];
        Some(polyline(&line, "track escape"))
    }

    /// Returns the names of the vertices, inside the panel. The two subpaths have their names on different sides,
    /// and successive vertices have theirs at different heights, as vertices may be close to each other.
    pub(super) fn names(&self, view: &View<'_>) -> String {
        let [min, max] = [view.corner + 12.0, view.corner + view.size() - 12.0];
        let side = if self.letter == 'z' { -14.0 } else { 14.0 };
        let points = self.points(view).into_iter().enumerate();
        let names = points.map(|(i, at)| {
            let at = (at + Vec2::new(side, [-5.0, 4.0, 15.0][i % 3])).clamp(min, max);
            let infinite = ["", " \u{221e}"][usize::from(self.places[i].is_infinite)];
            text(at, "name", &format!("{}{i}{infinite}", self.letter))
        });
        let (class, names) = (self.class, names.collect::<String>());
        format!("<g class=\"{class}\">\n{names}</g>\n")
    }
}
