//! Isolation (26): symptoms of every fault (Fig. 5), and what can be told apart.

use drivescope_scenarios::results::{Merge, Pair, StudyResults};

use super::matrix;
use crate::answer::block::{Block, Fact, HTML, Picture, Plot};
use crate::report::page::label;
use crate::report::plot::{Axis, Figure, Ink, Layer, Panel};
use crate::report::words::{count, percent};

const HEIGHT: f64 = 380.0;
const INKS: [Ink; 6] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Vermilion, Ink::Purple, Ink::Text];

/// The section.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let classifier = "Perceptron 2-15-10 and code bits, trained on 100 samples a fault of runs of \
                      their own, judged on every sample of the study's faulty runs from the earliest \
                      declaration on. \u{201c}Unknown\u{201d}: the symptom lies where none of the \
                      answered class was seen";
    let limits = format!(
        "What limits the recognition: a cubic in C_m alone explains {} % of the variance of r over all \
         symptoms: a symptom is essentially one number. A quadratic discriminant, a classifier of \
         another kind than the perceptron, answers to the same symptoms. Where the two agree, the \
         symptoms set the limit and not the classifier; two faults with the same symptoms share their \
         answers by chance",
        percent(study.separability.explained, 1)
    );
    let mut after = vec![Block::Note(limits)];
    after.extend(matrix::all(study));
    after.push(Block::Note(classifier.to_owned()));
    let mut before = vec![symptoms(study)];
    before.extend(separability(study));
    vec![Block::In(HTML, before), Block::Table(matrix::summary(study)), Block::In(HTML, after)]
}

fn symptoms(study: &StudyResults) -> Block {
    if study.symptoms.is_empty() {
        return Block::Note("No symptoms were gathered".to_owned());
    }
    let caption = "Fig. 5: 100 symptoms of every fault, control signal and residual while it stands \
                   declared. With integral action the loop holds T at its set point whatever fails, so \
                   C_m and r = T - y_m(C_m) move along one curve: a symptom is essentially one number, \
                   and faults that need the same C_m look alike. The paper finds that f_1^1, f_6^2 \
                   and f_2^1, f_5^2 overlap.";
    Block::Figure(Picture { plot: Plot::Figure(scatter(study)), caption: caption.to_owned() })
}

fn scatter(study: &StudyResults) -> Figure {
    let clouds = study.symptoms.iter().enumerate().map(|(place, of)| Layer::Cloud {
        name: label(&of.fault.label),
        points: of.points.iter().map(|[u, r]| (*u, *r)).collect(),
        ink: INKS[place % INKS.len()],
        below: of.fault.kind != "tacho",
    });
    let unit = &study.drive.tacho_unit;
    Figure {
        id: "figure-5-plot".into(),
        title: "Distribution of the symptoms of every fault".into(),
        description: "Residual over control signal, a cloud of points a fault, with the paper's \
                      label: f with raised 1 are tachometer faults, with raised 2 torque faults."
            .into(),
        x: Axis::new("control signal C_m", "V"),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new("residual r", unit),
            layers: clouds.collect(),
            strip: None,
        }],
    }
}

fn separability(study: &StudyResults) -> [Block; 2] {
    let found = &study.separability;
    let listed = |named: Vec<String>| match named.as_slice() {
        [] => "none".to_owned(),
        some => some.join(", "),
    };
    let merged = |classes: &[Vec<String>]| {
        let several = classes.iter().filter(|class| class.len() > 1);
        listed(several.map(|class| format!("{{{}}}", class.join(", "))).collect())
    };
    let pairs =
        |pairs: &[Pair]| listed(pairs.iter().map(|[a, b]| format!("{a} with {b}")).collect());
    let often = |merge: &Merge| {
        let [a, b] = &merge.faults;
        format!("{a} with {b}: {} of {}", merge.draws, found.draws)
    };
    let fact = |name: &str, value: String| Fact::new(HTML, name, value);
    let facts = vec![
        fact("Merged by our test", merged(&found.classes)),
        fact("Merged in draws of the noise", listed(found.merges.iter().map(often).collect())),
        fact("Merged in the paper", merged(&found.classes_paper)),
        fact("Merged only here", pairs(&found.merged_only_here)),
        fact("Merged only in the paper", pairs(&found.merged_only_in_paper)),
    ];
    let about = format!(
        "Our test: two faults share a class if a quadratic discriminant between the two, \
         cross-validated, takes more than {} % of the samples of either for the other, on average \
         over {} of the noise with 100 samples a fault each",
        percent(found.limit, 0),
        count(found.draws, "draw")
    );
    [Block::Facts(facts), Block::Note(about)]
}
