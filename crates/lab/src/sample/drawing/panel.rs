//! One view: the scene faintly, then rays, subpaths and names.

use super::super::subpath::{Place, SubpathReport};
use super::figure::{Entry, Fate, Figure};
use super::frame::{Frame, line, path, px, rectangle, text};
use super::labels::Labels;
use super::outline::outlines;
use crate::markup::{Element, element};
use crate::report::number::number;
use bidir::math::Vec2;
use bidir::scene::Scene;

/// The half of a vertex's size.
const DOT: f32 = 4.2;

/// Draws a view of `figure`; what is nearer than `near` is cut away.
pub(super) fn panel(figure: &Figure<'_>, scene: &Scene, frame: &Frame, near: f32) -> Element {
    let seen = outlines(scene, &frame.view, frame.window, near);
    let lines: Vec<Vec<Vec2>> = seen
        .iter()
        .map(|line| line.iter().map(|place| frame.page(*place)).collect())
        .collect();
    let walks = [
        Walk::new(frame, &figure.report.light, "light", 'z', None),
        Walk::new(
            frame,
            &figure.report.camera,
            "camera",
            'y',
            Some(&figure.eye),
        ),
    ];
    let dots: Vec<Vec2> = walks.iter().flat_map(Walk::dots).collect();
    let mut labels = Labels::new(frame, &dots);
    let title = text(frame.corner - Vec2::new(0.0, 8.0), frame.view.title).class("heading");
    let outline = path(lines.iter().map(Vec::as_slice)).class("outline");
    // Those that were traced are drawn over the others, the largest last.
    let is_traced = |entry: &&Entry| matches!(entry.fate, Fate::Arrives | Fate::Blocked);
    let (traced, others): (Vec<_>, Vec<_>) = figure.rays().rev().partition(is_traced);
    let rays = others
        .into_iter()
        .chain(traced)
        .filter_map(|entry| ray(frame, entry));
    let names = walks.each_ref().map(|walk| walk.names(&mut labels));
    element("g")
        .child(title)
        .child(rectangle(frame.corner, frame.size()).class("paper"))
        .child(outline)
        .children(rays)
        .children(walks.iter().map(Walk::draw))
        .children(names)
        .children(axes(frame))
}

/// The shadow ray of a strategy, as wide as what it is worth.
fn ray(frame: &Frame, entry: &Entry) -> Option<Element> {
    let [light, camera] = entry.ends?;
    let segment = frame.segment(&light, &camera)?;
    let [width, opacity] = stroke(entry);
    let mut drawn = line(segment)
        .with("class", format!("ray {}", entry.fate.class()))
        .with("stroke-width", px(width))
        .with("stroke-opacity", px(opacity));
    if let Some(dashes) = entry.fate.dashes() {
        drawn = drawn.with("stroke-dasharray", dashes);
    }
    let mut group = element("g").child(element("title").text(entry.title()));
    group = group.child(drawn);
    if entry.is_foreign && !light.is_infinite {
        let mark = diamond(frame.at(light.point()), 0.7 * DOT).class("foreign");
        group = group.child(mark);
    }
    Some(group)
}

/// Width and opacity of a ray: by what it is worth, but those that were traced can always be seen, and
/// the light image, which is of other pixels, is never in front.
fn stroke(entry: &Entry) -> [f32; 2] {
    let part = entry.weight.sqrt();
    match entry.fate {
        Fate::Arrives | Fate::Blocked => [1.6 + 3.0 * part, 0.7 + 0.3 * part],
        Fate::Untraced | Fate::Found => [1.0 + 2.0 * part, 0.4 + 0.6 * part],
        Fate::Splat | Fate::HiddenSplat => [1.0 + 0.6 * part, 0.4 + 0.3 * part],
    }
}

/// A subpath on a view.
struct Walk<'a> {
    frame: &'a Frame,
    class: &'static str,
    letter: char,
    /// Each vertex, at the edge where it is at infinity.
    vertices: Vec<Vec2>,
    /// Which of them are real points.
    is_finite: Vec<bool>,
    /// Where it leaves.
    escape: Option<Vec2>,
}

impl<'a> Walk<'a> {
    /// The walk of `subpath`; one without vertices is drawn as its `start`, if it has one.
    fn new(
        frame: &'a Frame,
        subpath: &SubpathReport,
        class: &'static str,
        letter: char,
        start: Option<&Place>,
    ) -> Self {
        let mut places: Vec<Place> = subpath.vertices.iter().map(|v| v.place).collect();
        if places.is_empty() {
            places.extend(start);
        }
        let middle = Place::finite(
            frame
                .view
                .place(frame.window[0].midpoint(frame.window[1]), 0.0),
        );
        let at = |i: usize| {
            let place = &places[i];
            // What is at infinity is seen from the next vertex, or else from the middle.
            let next = places.get(i + 1).filter(|next| !next.is_infinite);
            let from = next.unwrap_or(&middle).point();
            if place.is_infinite {
                frame.edge(from, place.point())
            } else {
                frame.at(place.point())
            }
        };
        let last = places.last().filter(|last| !last.is_infinite);
        let escape = subpath.escape.zip(last);
        Self {
            frame,
            class,
            letter,
            vertices: (0..places.len()).map(at).collect(),
            is_finite: places.iter().map(|place| !place.is_infinite).collect(),
            escape: escape.map(|(direction, last)| frame.edge(last.point(), direction.into())),
        }
    }

    fn dots(&self) -> impl Iterator<Item = Vec2> {
        self.vertices.iter().copied()
    }

    fn draw(&self) -> Element {
        let track = path(std::iter::once(&self.vertices[..])).class("track");
        let dots = self.vertices.iter().enumerate().map(|(i, at)| {
            let mark = if self.letter == 'z' {
                diamond(*at, 1.2 * DOT)
            } else {
                circle(*at, DOT)
            };
            let is_hollow = !self.is_finite[i] || i == 0 && self.letter == 'y';
            mark.class(if is_hollow { "hollow" } else { "vertex" })
        });
        let escape = self.vertices.last().zip(self.escape);
        let arrow = escape.and_then(|(from, to)| arrow([*from, to]));
        element("g")
            .class(self.class)
            .child(track)
            .children(arrow.into_iter().flatten())
            .children(dots)
    }

    fn names(&self, labels: &mut Labels) -> Element {
        let names = self.vertices.iter().enumerate().map(|(i, at)| {
            let infinite = if self.is_finite[i] { "" } else { " \u{221e}" };
            labels.write(*at, &format!("{}{i}{infinite}", self.letter))
        });
        let group = element("g").with("class", format!("{} names", self.class));
        let mut group = group.children(names);
        if let Some(at) = self.escape {
            let inside = at.clamp(
                self.frame.corner + 8.0,
                self.frame.corner + self.frame.size() - 8.0,
            );
            group = group.child(labels.write(inside, "escapes"));
        }
        group
    }
}

fn circle(at: Vec2, radius: f32) -> Element {
    element("circle")
        .with("cx", px(at.x))
        .with("cy", px(at.y))
        .with("r", px(radius))
}

fn diamond(at: Vec2, radius: f32) -> Element {
    let corners = [Vec2::Y, Vec2::X, -Vec2::Y, -Vec2::X].map(|d| at + d * radius);
    let points: Vec<_> = corners
        .iter()
        .map(|c| format!("{},{}", px(c.x), px(c.y)))
        .collect();
    element("polygon").with("points", points.join(" "))
}

/// A line with a head at its second end. None: it has no length.
fn arrow([from, to]: [Vec2; 2]) -> Option<[Element; 2]> {
    let along = (to - from).try_normalize()?;
    let (back, side) = (along * -9.0, along.perp() * 3.6);
    let head = [to + back + side, to, to + back - side];
    let track = line([from, to]).class("track");
    Some([track, path(std::iter::once(&head[..])).class("track")])
}

/// The names of the axes, and a length.
fn axes(frame: &Frame) -> [Element; 3] {
    let (corner, size) = (frame.corner, frame.size());
    let bottom = corner.y + size.y;
    let right = frame.view.right.label(["\u{2192}", "\u{2190}"]);
    let up = frame.view.up.label(["\u{2191}", "\u{2193}"]);
    // The largest of 1, 2 and 5 times a power of ten that takes a quarter of the width.
    let most = 0.25 * size.x / frame.scale;
    let power = libm::exp10f(libm::log10f(most).floor());
    let unit = [5.0, 2.0, 1.0].into_iter().find(|n| n * power <= most);
    let length = unit.unwrap_or(1.0) * power;
    let bar = Vec2::new(corner.x + size.x - 12.0, bottom - 12.0);
    let start = bar - Vec2::new(length * frame.scale, 0.0);
    let scale = element("g")
        .class("scale")
        .child(path(std::iter::once(
            &[start - Vec2::Y * 3.0, start, bar, bar - Vec2::Y * 3.0][..],
        )))
        .child(
            text(
                start.midpoint(bar) - Vec2::Y * 5.0,
                number(f64::from(length)),
            )
            .class("middle"),
        );
    [
        text(Vec2::new(corner.x + 8.0, bottom - 8.0), right).class("axis"),
        text(Vec2::new(corner.x + 8.0, corner.y + 16.0), up).class("axis"),
        scale,
    ]
}
