//! Reliability of stated probabilities: whether they equal the observed frequencies.

use egui::Color32;
use tautline_workflow::plot::Colours;
use tautline_workflow::plot::draw::drawing;
use tautline_workflow::plot::figure::{Axis, Curve, Figure, Ink, Marker, Point, Series};

use crate::tables::counting::Share;
use crate::tables::hidden::Study;
use crate::tables::markdown::Table;

/// Class borders of stated probability: tenths, with a finer division where causes are named.
const BORDERS: [f64; 13] = [
    0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0,
];
/// Lower bound of probabilities in the logarithmic score.
const LEAST: f64 = 1e-6;
/// Size of the diagram (pt), and scale of its texts.
const SIZE: [f64; 2] = [360.0, 330.0];
const SCALE: f64 = 0.8;

const COLOURS: Colours = Colours {
    ground: Color32::WHITE,
    line: Color32::from_rgb(0xd9, 0xdd, 0xe2),
    text: Color32::from_rgb(0x1f, 0x24, 0x2b),
    muted: Color32::from_rgb(0x5b, 0x64, 0x70),
    accent: Color32::from_rgb(0x1f, 0x5f, 0xa8),
    good: Color32::from_rgb(0x1f, 0x5f, 0xa8),
    warning: Color32::from_rgb(0xc2, 0x41, 0x0c),
    diverging: [Color32::WHITE; 2],
    cables: [Color32::BLACK; 8],
};

/// Causes whose stated probability is in one class.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Class {
    /// Borders of the class.
    pub borders: [f64; 2],
    /// Sum of the stated probabilities.
    pub stated: f64,
    /// Causes that were hidden.
    pub right: Share,
}

impl Class {
    /// Mean of the stated probabilities.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.stated / self.right.whole.max(1) as f64
    }

    fn verdict(&self) -> &'static str {
        let [low, high] = self.right.interval();
        let (stated, observed) = (self.mean(), self.right.ratio());
        if (low..=high).contains(&stated) {
            "as stated"
        } else if (observed > stated) == (stated > 0.5) {
            "too cautious"
        } else {
            "too sure"
        }
    }
}

/// All stated probabilities, and whether the cause was hidden.
fn statements(study: &Study) -> impl Iterator<Item = (f64, bool)> + '_ {
    let outcomes = study.outcomes.iter();
    let candidates = outcomes.flat_map(|outcome| {
        let said = outcome.said.iter().flat_map(|said| &said.candidates);
        said.chain(&outcome.possible)
    });
    candidates.map(|candidate| (candidate.probability, candidate.right))
}

/// Classes of stated probability that have causes.
#[must_use]
pub fn classes(study: &Study) -> Vec<Class> {
    let mut classes: Vec<Class> = BORDERS
        .windows(2)
        .map(|pair| Class {
            borders: [pair[0], pair[1]],
            ..Class::default()
        })
        .collect();
    for (probability, right) in statements(study) {
        let at = classes
            .iter()
            .position(|class| probability < class.borders[1]);
        let last = classes.len() - 1;
        let class = &mut classes[at.unwrap_or(last)];
        class.stated += probability;
        class.right.count(right);
    }
    classes.retain(|class| class.right.whole > 0);
    classes
}

/// Mean logarithmic score of probabilities and whether it was so: negative log of the probability assigned to the truth.
pub fn logarithmic_score(statements: impl Iterator<Item = (f64, bool)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (probability, right) in statements {
        let given = if right {
            probability
        } else {
            1.0 - probability
        };
        sum -= given.clamp(LEAST, 1.0).ln();
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// The reliability table; empty if there are no statements.
pub(super) fn table(study: &Study) -> String {
    let classes = classes(study);
    if classes.is_empty() {
        return String::new();
    }
    let mut table = Table::new("stated | causes | mean stated | right | 95 % interval |");
    for class in classes {
        let [low, high] = class.right.interval().map(|p| 100.0 * p);
        let [from, to] = class.borders.map(|p| 100.0 * p);
        table.row(format_args!(
            "{from:.0} to {to:.0} % | {} | {:.1} % | {:.1} % | {low:.1} to {high:.1} % | {}",
            class.right.whole,
            100.0 * class.mean(),
            100.0 * class.right.ratio(),
            class.verdict(),
        ));
    }
    let score = logarithmic_score(statements(study));
    format!(
        "Stated probabilities, of all causes that are named, listed or said to be possible.\n\n{}\n\
         Logarithmic score {score:.3} per cause; all with 50 % would be 0.693.\n\n",
        table.text()
    )
}

/// Reliability diagram as an SVG file.
#[must_use]
pub fn diagram(study: &Study) -> String {
    let classes = classes(study);
    let points = classes
        .iter()
        .map(|c| Point::new(c.mean(), c.right.ratio()));
    let mut curves = vec![Curve {
        name: "as stated".to_owned(),
        ink: Ink::Muted,
        dashed: true,
        points: vec![[0.0, 0.0], [1.0, 1.0]],
    }];
    curves.extend(classes.iter().map(|class| {
        let [low, high] = class.right.interval();
        Curve {
            name: String::new(),
            ink: Ink::Accent,
            dashed: false,
            points: vec![[class.mean(), low], [class.mean(), high]],
        }
    }));
    let figure = Figure {
        x: Axis::new("Stated probability", ""),
        y: Axis::new("Share that was right, 95 % interval", ""),
        series: vec![Series::new(
            "",
            Ink::Accent,
            Marker::Circle,
            points.collect(),
        )],
        curves,
        ..Figure::default()
    };
    let label = "Reliability diagram: shares of causes that were right over stated probabilities";
    drawing(label, &figure, SIZE, SCALE, &COLOURS).svg_file()
}
