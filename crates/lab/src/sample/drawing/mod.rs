//! The picture of a sample, as SVG: from above and from the side, both subpaths, the connections that
//! were candidates, those that were chosen, and what was in their way; with a table of all.
//!
//! The scene is in it as outlines that rays find. The picture loads nothing, has no scripts, can be
//! read on light and dark pages, and is the same bytes for the same sample.

mod figure;
mod frame;
mod labels;
mod lines;
mod outline;
mod panel;
mod table;
mod view;

#[cfg(test)]
mod tests;

use super::SampleReport;
use crate::markup::{Element, element};
use bidir::math::{Vec2, Vec3};
use bidir::scene::Scene;
use figure::{Figure, light};
use frame::{Frame, px, rectangle, text};
use panel::panel;
use table::Column;
use view::{Extent, View};

/// The width of the picture. Unit: pixels, as of all lengths here.
const WIDTH: f32 = 1000.0;
/// Around everything.
const MARGIN: f32 = 24.0;
/// The widest view, and the highest.
const VIEW: Vec2 = Vec2::new(520.0, 480.0);
/// Where the table begins.
const TABLE: f32 = MARGIN + VIEW.x + 28.0;
/// The first baseline of what is below the title.
const TOP: f32 = 92.0;
/// Between the two views.
const GAP: f32 = 36.0;

impl SampleReport {
    /// The sample as a picture in the format SVG; `scene` is the one that it was taken in, and `name`
    /// what it is called.
    pub fn drawing(&self, scene: &Scene, name: &str) -> String {
        let figure = Figure::new(self, scene);
        let extent = shown(&figure, scene);
        let frames = frames(
            View::both(&scene.camera().pose(), &extent.paths),
            &extent.all,
        );
        let (column, bottom) = column(&figure);
        let last = &frames[1];
        let height = (last.corner.y + last.size().y).max(bottom) + MARGIN;
        let panels = frames.iter().map(|frame| {
            let near = nearest(frame, &extent);
            panel(&figure, scene, frame, near)
        });
        let style = element("style").code(include_str!("style.css"));
        let picture = element("svg")
            .with("xmlns", "http://www.w3.org/2000/svg")
            .with("viewBox", format!("0 0 {WIDTH} {}", px(height)))
            .with("width", WIDTH)
            .with("height", px(height))
            .child(element("title").text(format!("{} of {name}", self.title())))
            .child(element("desc").text(self.description()))
            .child(style)
            .child(rectangle(Vec2::ZERO, Vec2::new(WIDTH, height)).class("page"))
            .children(self.head(name))
            .children(panels)
            .child(column);
        format!("{}\n", picture.to_string().trim_start())
    }
}

impl SampleReport {
    fn title(&self) -> String {
        let [x, y] = self.pixel;
        format!("Sample of pixel {x},{y} in pass {}", self.pass)
    }

    /// The picture in words.
    fn description(&self) -> String {
        let traced = self.candidates.iter().filter(|c| c.is_chosen);
        let arrived = traced
            .clone()
            .filter(|c| c.is_visible && !c.term.is_dropped);
        format!(
            "Plan and elevation of a camera subpath of {} vertices and a light subpath of {}. \
             Candidates for shadow rays: {}; traced: {}; arrived: {}. Lights that the camera walk \
             found: {}. Splats of the light image: {}.",
            self.camera.vertices.len(),
            self.light.vertices.len(),
            self.candidates.len(),
            traced.count(),
            arrived.count(),
            self.hits.len(),
            self.light_image.len()
        )
    }

    /// What the picture is of.
    fn head(&self, name: &str) -> [Element; 2] {
        let names = ["integrator", "shadow-rays", "mis", "seed"];
        let settings = self.settings.line(&names);
        let about = format!("{name}: {settings}; {} rays", self.rays);
        [
            text(Vec2::new(MARGIN, 36.0), self.title()).class("title"),
            text(Vec2::new(MARGIN, 56.0), about).class("muted"),
        ]
    }

    /// The parts of what the sample added.
    fn sums(&self) -> [(&'static str, String); 4] {
        [
            ("added to the pixel", light(self.value)),
            ("by lights that were found", light(self.value_of_hits)),
            ("by candidates", light(self.value_of_candidates)),
            ("had all been traced", light(self.value_of_all_candidates)),
        ]
    }
}

/// What of the world is shown.
struct Shown {
    /// The box around the sample.
    paths: Extent,
    /// With what of the scene is near.
    all: Extent,
    /// The longest side of the sample, or where it has none, of the scene.
    size: f32,
}

fn shown(figure: &Figure<'_>, scene: &Scene) -> Shown {
    let bounds = scene.bvh().bounds();
    let around = Extent::of(&[bounds.min, bounds.max]);
    let nothing = Extent {
        min: Vec3::ZERO,
        max: Vec3::ZERO,
    };
    let paths = figure.extent().or(around).unwrap_or(nothing);
    let sizes = [Some(paths), around].into_iter().flatten();
    let mut sizes = sizes.map(|extent| extent.size().max_element());
    let size = sizes.find(|size| *size > 0.0).unwrap_or(1.0);
    let near = around.map_or(paths, |around| paths.grown_into(&around, 0.6 * size));
    Shown {
        paths,
        all: near.widened(0.05 * size),
        size,
    }
}

/// Both views below each other, of one scale.
fn frames(views: [View; 2], extent: &Extent) -> [Frame; 2] {
    let sizes = views.map(|view| {
        let [min, max] = view.window(extent);
        max - min
    });
    let scale = sizes.map(|size| (VIEW / size).min_element());
    let scale = scale[0].min(scale[1]);
    let below = TOP + sizes[0].y * scale + GAP;
    let [above, side] = views;
    [
        Frame::new(above, extent, scale, Vec2::new(MARGIN, TOP)),
        Frame::new(side, extent, scale, Vec2::new(MARGIN, below)),
    ]
}

/// The depth behind which a view is drawn: just behind the nearest point of the sample, so that a
/// ceiling or wall that it came to is cut away too.
fn nearest(frame: &Frame, shown: &Shown) -> f32 {
    let away = frame.view.away;
    let corners = [shown.paths.min, shown.paths.max].map(|corner| away.dot(corner));
    corners[0].min(corners[1]) + 1e-3 * shown.size
}

/// Legend, tables and sums; and where they end.
fn column(figure: &Figure<'_>) -> (Element, f32) {
    let mut column = Column::new(Vec2::new(TABLE, TOP - 8.0));
    column.legend(figure);
    column.tables(figure);
    column.sums(&figure.report.sums());
    let bottom = column.y;
    (column.draw(), bottom)
}
