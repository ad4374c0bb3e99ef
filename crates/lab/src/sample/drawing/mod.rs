//! The drawing of a sample, as SVG, in plan and elevation: both subpaths, the candidates, the traced shadow
//! rays (arriving or blocked), and the splats of the light image.
//!
//! Outlines, found by a grid of rays, show the scene. The drawing loads nothing, has no scripts, is readable on
//! light and dark pages, and has the same bytes for the same sample.

mod figure;
mod outline;
mod shapes;
mod view;

#[cfg(test)]
mod tests;

use super::SampleReport;
use crate::markup::escaped;
use crate::number::number;
use bidir::driver::Session;
use bidir::math::{Vec2, Vec3};
use bidir::spectrum::luminance;
use figure::{Ray, Walk};
use shapes::{circle, polyline, px, rectangle, text};
use view::{LARGEST, View};

/// The width of the drawing. Unit: pixels, as for all lengths here.
const WIDTH: f32 = 1000.0;
/// The margin around everything.
const MARGIN: f32 = 24.0;
/// The upper left corner of the plan.
const PLAN: Vec2 = Vec2::new(MARGIN, 108.0);
/// The left end of the first row of the legend.
const LEGEND: Vec2 = Vec2::new(PLAN.x + LARGEST.x + 28.0, PLAN.y + 8.0);
/// The distance between rows of the legend.
const ROW: f32 = 20.0;

/// The class of each kind of line, and its meaning. Later kinds are drawn over earlier ones.
const KINDS: [[&str; 2]; 5] = [
    ["untraced", "candidates, not traced"],
    ["splat", "splats of the light image"],
    ["splat hidden", "splats, blocked"],
    ["arrives", "shadow rays that arrive"],
    ["blocked", "shadow rays, blocked"],
];

/// The lines of a sample.
struct Figure {
    rays: Vec<Ray>,
    /// The light subpath and the camera subpath.
    walks: [Walk; 2],
}

impl Figure {
    fn new(report: &SampleReport) -> Self {
        let mut camera = Walk::new("camera", 'y', &report.camera);
        if camera.places.is_empty() {
            camera.places.push(report.eye);
        }
        Self {
            rays: Ray::all(report),
            walks: [Walk::new("light", 'z', &report.light), camera],
        }
    }

    /// Returns all points that are not at infinity.
    fn points(&self) -> Vec<Vec3> {
        let vertices = self.walks.iter().flat_map(|walk| &walk.places);
        let places = vertices.chain(self.rays.iter().map(|ray| &ray.light_end));
        let finite = places.filter(|place| !place.is_infinite);
        finite.map(|place| place.point).collect()
    }

    fn of_class(&self, class: &str) -> impl Iterator<Item = &Ray> {
        self.rays.iter().filter(move |ray| ray.class == class)
    }

    fn draw(&self, title: &str, view: &View<'_>) -> String {
        let weights = self.rays.iter().map(|ray| ray.weight);
        let largest = weights.fold(f32::MIN_POSITIVE, f32::max);
        let ordered = KINDS.iter().flat_map(|[class, _]| self.of_class(class));
        let rays: String = ordered.filter_map(|ray| ray.draw(view, largest)).collect();
        let walks: String = self.walks.iter().map(|walk| walk.draw(view)).collect();
        let names: String = self.walks.iter().map(|walk| walk.names(view)).collect();
        let (panel, outline) = (view.panel(title), view.outline());
        format!("<g>\n{panel}{outline}{rays}{walks}{names}</g>\n")
    }

    /// Returns the legend beside the panels: the meaning of lines and marks, and their number.
    fn legend(&self) -> String {
        let line = |class: &str| polyline(&[Vec2::ZERO, Vec2::X * 26.0], class);
        let dot = circle(Vec2::X * 13.0, 2.8, "light hollow");
        let [z, y] = self.walks.each_ref().map(|walk| walk.places.len());
        let foreign = self.rays.iter().filter(|ray| ray.is_foreign).count();
        let marks = [
            (line("camera track"), format!("camera vertices y: {y}")),
            (line("light track"), format!("light vertices z: {z}")),
            (dot, format!("light points off this subpath: {foreign}")),
        ];
        let lines = KINDS.iter().rev().map(|[class, meaning]| {
            let count = self.of_class(class).count();
            (line(class), format!("{meaning}: {count}"))
        });
        let texts = [
            "width: w C times probability of candidates",
            "an arrow leaves the scene",
        ];
        let notes = texts.map(|note| (String::new(), note.to_owned()));
        let pairs = marks.into_iter().chain(lines).chain(notes).enumerate();
        let drawn = pairs.map(|(i, (sample, meaning))| {
            let [x, y] = [LEGEND.x, LEGEND.y + ROW * i as f32].map(px);
            let meaning = text(Vec2::new(36.0, 4.0), "meaning", &meaning);
            format!("<g transform=\"translate({x} {y})\">\n{sample}{meaning}</g>\n")
        });
        let rows: String = drawn.collect();
        format!("<g stroke-width=\"2.2\">\n{rows}</g>\n")
    }
}

impl SampleReport {
    /// Returns the drawing of the sample as SVG. `session` took the sample; `name` is the title of the scene.
    pub fn drawing(&self, session: &Session<'_>, name: &str) -> String {
        let figure = Figure::new(self);
        let views = View::both(session, &figure.points(), PLAN);
        let below = views[1].corner + views[1].size();
        let height = below.y.max(LEGEND.y + 10.0 * ROW) + MARGIN;
        let content = [
            rectangle(Vec2::ZERO, Vec2::new(WIDTH, height), "page"),
            self.head(name),
            figure.draw("Plan", &views[0]),
            figure.draw("Elevation", &views[1]),
            figure.legend(),
        ];
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {}\">\n\
             <title>{} of {}</title>\n<style>{}</style>\n{}</svg>\n",
            px(height),
            self.title(),
            escaped(name),
            include_str!("style.css"),
            content.concat()
        )
    }

    fn title(&self) -> String {
        let [x, y] = self.pixel;
        format!("Sample of pixel {x},{y} in pass {}", self.pass)
    }

    /// Returns the heading, with lines for settings and results below.
    fn head(&self, name: &str) -> String {
        let names = ["integrator", "shadow-rays", "mis", "seed"];
        let settings = format!("{name}: {}", self.settings.line(&names));
        let value = number(f64::from(luminance(self.value)));
        let (rays, hits) = (self.rays, self.hits.len());
        let results = format!("{rays} rays, {hits} hits of lights, luminance {value}");
        let at = |line: f32| Vec2::new(MARGIN, 36.0 + 18.0 * line);
        [
            text(at(0.0), "title", &self.title()),
            text(at(1.0), "muted", &settings),
            text(at(2.0), "muted", &results),
        ]
        .concat()
    }
}
