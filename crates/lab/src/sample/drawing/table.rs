//! What the lines mean, and what every strategy gave.

use super::figure::{Entry, Fate, Figure};
use super::frame::{line, text};
use crate::markup::{Element, element};
use crate::report::number::number;
use bidir::math::Vec2;

/// The height of a row.
const ROW: f32 = 18.0;
/// Where columns begin, or end where they have numbers. Unit: pixels from the left of the table.
const STRATEGY: f32 = 36.0;
const JOINS: f32 = 76.0;
const VALUE_END: f32 = 204.0;
const PROB_END: f32 = 276.0;
const OUTCOME: f32 = 288.0;

/// Rows from top to bottom.
pub(super) struct Column {
    left: f32,
    /// The baseline of the next row.
    pub(super) y: f32,
    rows: Vec<Element>,
}

impl Column {
    pub(super) fn new(corner: Vec2) -> Self {
        Self {
            left: corner.x,
            y: corner.y,
            rows: Vec::new(),
        }
    }

    pub(super) fn draw(self) -> Element {
        element("g").children(self.rows)
    }

    fn at(&self, x: f32) -> Vec2 {
        Vec2::new(self.left + x, self.y)
    }

    fn next(&mut self, row: Element) {
        self.rows.push(row);
        self.y += ROW;
    }

    fn gap(&mut self) {
        self.y += 0.6 * ROW;
    }

    /// A line as it is drawn in the views.
    fn swatch(&self, fate: Fate) -> Element {
        let middle = self.at(0.0) - Vec2::Y * 4.0;
        let drawn = line([middle, middle + Vec2::X * 26.0])
            .with("class", format!("ray {}", fate.class()))
            .with("stroke-width", "2.2");
        match fate.dashes() {
            Some(dashes) => drawn.with("stroke-dasharray", dashes),
            None => drawn,
        }
    }

    /// What lines mean, of those that there are.
    pub(super) fn legend(&mut self, figure: &Figure<'_>) {
        let has = |fate| figure.rays().any(|entry| entry.fate == fate);
        let walks = [("camera", "camera subpath y"), ("light", "light subpath z")];
        for (class, meaning) in walks {
            let middle = self.at(0.0) - Vec2::Y * 4.0;
            let drawn = line([middle, middle + Vec2::X * 26.0]).class("track");
            let row = element("g").class(class).child(drawn);
            self.next(row.child(text(self.at(STRATEGY), meaning)));
        }
        let rays = [
            (Fate::Arrives, "shadow ray that arrives"),
            (Fate::Blocked, "shadow ray that is blocked"),
            (Fate::Untraced, "connection that is not traced"),
            (Fate::Splat, "seen by the light image"),
            (Fate::HiddenSplat, "hidden from the light image"),
        ];
        for (fate, meaning) in rays.into_iter().filter(|(fate, _)| has(*fate)) {
            let row = element("g").child(self.swatch(fate));
            self.next(row.child(text(self.at(STRATEGY), meaning)));
        }
        if figure.rays().any(|entry| entry.is_foreign) {
            let meaning = "z\u{2032}  drawn for this connection alone";
            self.next(text(self.at(STRATEGY), meaning));
        }
        if !figure.candidates.is_empty() {
            let meaning = "The wider, the larger value times probability.";
            self.next(text(self.at(0.0), meaning).class("muted"));
        }
        self.gap();
    }

    /// All strategies with what they gave.
    pub(super) fn tables(&mut self, figure: &Figure<'_>) {
        let candidates = "Candidates for shadow rays";
        self.table(candidates, &figure.candidates);
        self.table("Lights that the camera walk found, s = 0", &figure.hits);
        self.table("Light image, t = 1", &figure.splats);
    }

    fn table(&mut self, title: &str, entries: &[Entry]) {
        let heading = match entries.len() {
            0 => format!("{title}: none"),
            count => format!("{title}: {count}"),
        };
        self.next(text(self.at(0.0), heading).class("heading"));
        if entries.is_empty() {
            return self.gap();
        }
        let has_probs = entries.iter().any(|entry| entry.prob.is_some());
        let head = element("g")
            .class("muted")
            .child(text(self.at(STRATEGY), "s, t"))
            .child(text(self.at(JOINS), "joins"))
            .child(text(self.at(VALUE_END), "value").class("end"))
            .children(has_probs.then(|| text(self.at(PROB_END), "prob.").class("end")));
        self.next(head);
        for entry in entries {
            let row = self.row(entry);
            self.next(row);
        }
        self.gap();
    }

    fn row(&self, entry: &Entry) -> Element {
        let prob = entry
            .prob
            .map(|prob| text(self.at(PROB_END), number(prob)).class("end"));
        let value = number(f64::from(entry.value));
        element("g")
            .child(self.swatch(entry.fate))
            .child(text(self.at(STRATEGY), entry.strategy))
            .child(text(self.at(JOINS), &entry.joins))
            .child(text(self.at(VALUE_END), value).class("end"))
            .children(prob)
            .child(text(self.at(OUTCOME), &entry.outcome))
    }

    /// What the sample adds up to.
    pub(super) fn sums(&mut self, sums: &[(&str, String)]) {
        self.next(text(self.at(0.0), "Luminance").class("heading"));
        for (name, value) in sums {
            let row = element("g")
                .child(text(self.at(0.0), name))
                .child(text(self.at(PROB_END), value).class("end"));
            self.next(row);
        }
    }
}
