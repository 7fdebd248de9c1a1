//! The answer where the signals of the recordings let nothing be judged: no fit, and never a name.

use drivescope_plant::drive::Drive;

use super::report::{Discovery, Verdict};
use crate::estimate::Evidence;
use crate::observer::Observer;
use crate::signals::{SignalFinding, What, findings};

/// What is wrong with the signals of both.
pub(super) fn signals(
    drive: &Drive,
    estimation: &Evidence,
    validation: &Evidence,
) -> Vec<SignalFinding> {
    let mut wrong = findings(drive, estimation);
    // To judge by, any motion will do, and none says nothing against it.
    let of_motion = [What::AtRest, What::OneSpeed, What::OneDirection];
    let judging = |it: &SignalFinding| !of_motion.contains(&it.what);
    let of_validation = findings(drive, validation).into_iter().filter(judging);
    // A recording that was parted says the same twice.
    let new: Vec<SignalFinding> = of_validation
        .filter(|it| {
            !wrong.iter().any(|one| {
                (one.what, &one.recording, &one.channel) == (it.what, &it.recording, &it.channel)
            })
        })
        .collect();
    wrong.extend(new);
    wrong.sort_by_key(|it| it.consequence);
    wrong
}

/// The answer: the drive as it is, and what is wrong.
pub(super) fn discovery(
    drive: &Drive,
    estimation: &Evidence,
    signals: Vec<SignalFinding>,
) -> Discovery {
    let observer = Observer::choose(drive, &estimation.recordings, &estimation.noise);
    Discovery { signals, ..Discovery::of(drive, Verdict::NotJudged, observer) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::{Unwatched, discover};
    use crate::measured::Measured;
    use crate::testing::{bench, dr300, gaussian, noisy};

    #[test]
    fn nothing_is_named_where_the_outputs_do_not_answer() {
        let drive = dr300();
        let good = noisy(bench(&drive, 4.0, 0.001), [0.02, 0.5], 3);
        let evidence = |spoil: &dyn Fn(&mut [f64])| {
            let mut recording = good.clone();
            recording.signals.retain(|it| it.name != "theta");
            let omega = recording.signals.iter_mut().find(|it| it.name == "omega");
            spoil(&mut omega.expect("it is there").values);
            let measured = Measured::new(&drive, &recording).expect("usable");
            Evidence { recordings: vec![measured], noise: vec![vec![0.02, 0.5]] }
        };
        let noise = evidence(&|omega| omega.copy_from_slice(&gaussian(4000, 9)));
        let negated = evidence(&|omega| omega.iter_mut().for_each(|it| *it = -*it));
        let right = evidence(&|_| {});
        // Whether what is wrong is fitted to or judged by.
        for (estimation, validation, what) in [
            (&noise, &right, What::NoAnswer),
            (&right, &noise, What::NoAnswer),
            (&right, &negated, What::Sign),
        ] {
            let found = discover(&drive, estimation, validation, &Unwatched).expect("an answer");
            assert_eq!((found.verdict, found.remaining), (Verdict::NotJudged, Verdict::NotJudged));
            assert!(found.named.is_empty() && found.ladder.is_empty());
            assert_eq!(found.signals[0].what, what, "{:?}", found.signals);
        }
        let found = signals(&drive, &right, &right);
        assert!(!found.iter().any(SignalFinding::forbids), "{found:?}");
    }
}
