//! What the bank found of one scenario.

use drivescope_diagnoser::bank::{BaselineError, Cause, Judgement, Mechanism};
use drivescope_monitor::{STUCK, UNKNOWN};

use super::super::block::Found;

/// What became of the alarms of a scenario that named nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::campaign) enum Heard {
    /// There was none.
    #[default]
    Nothing,
    /// The run ended before the last was judged.
    Alarm,
    /// All were taken back: nothing had changed.
    Retracted,
}

/// What the bank found of one scenario.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::campaign) struct BankFound {
    /// Why no machine was learned.
    pub(in crate::campaign) refused: Option<BaselineError>,
    /// Alarms, and innovations outside their 95 % band.
    pub(in crate::campaign) counts: Found,
    /// Innovations in health, and in the fault.
    pub(in crate::campaign) measured: [u64; 2],
    /// What the alarms came to where nothing is named.
    pub(in crate::campaign) heard: Heard,
    /// The first judgement that names something: within the fault, or of a false alarm where nothing
    /// fails.
    pub(in crate::campaign) named: Option<Named>,
}

/// What a judgement names.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::campaign) struct Named {
    /// Sample at which it was told.
    pub(in crate::campaign) sample: u64,
    /// What failed, or `unknown`.
    pub(in crate::campaign) mechanism: String,
    /// The confusion set, the named first; empty where it is unknown.
    pub(in crate::campaign) set: Vec<String>,
    /// Size and the ends of its 95 % interval, in the unit of the mechanism.
    pub(in crate::campaign) size: Option<[f64; 3]>,
}

impl Named {
    /// What a judgement at sample `k` names among those mechanisms.
    pub(super) fn new(judgement: &Judgement, k: u64, mechanisms: &[Mechanism]) -> Self {
        let id = |j: usize| mechanisms[j].id.clone();
        let (mechanism, set, size) = match judgement.cause {
            Cause::Mechanism(j) => {
                let confused = judgement.confusion_set().iter();
                let set = confused.map(|it| id(it.mechanism)).collect();
                let size = judgement.named().map(|it| {
                    let [low, high] = it.interval();
                    [it.size, low, high]
                });
                (id(j), set, size)
            }
            Cause::Frozen(sensor) => {
                (STUCK[sensor].to_owned(), vec![STUCK[sensor].to_owned()], None)
            }
            Cause::Unknown | Cause::Healthy => (UNKNOWN.to_owned(), Vec::new(), None),
        };
        Self { sample: k, mechanism, set, size }
    }
}

/// What a row says where nothing is named.
const NO_ALARM: &str = "none";
const RETRACTED: &str = "retracted";
const UNDECIDED: &str = "undecided";
const NOT_LEARNED: &str = "not_learned";
/// What a row says of a machine that was learned.
pub(in crate::campaign) const LEARNED: &str = "learned";

impl BankFound {
    /// What is named, or a word for why nothing is.
    pub(in crate::campaign) fn told(&self) -> &str {
        match (&self.refused, &self.named, self.heard) {
            (Some(_), ..) => NOT_LEARNED,
            (None, Some(named), _) => &named.mechanism,
            (None, None, Heard::Nothing) => NO_ALARM,
            (None, None, Heard::Alarm) => UNDECIDED,
            (None, None, Heard::Retracted) => RETRACTED,
        }
    }

    /// Whether a machine was learned, or a word for why not.
    pub(in crate::campaign) fn baseline(&self) -> &'static str {
        match &self.refused {
            None => LEARNED,
            Some(BaselineError::TooShort { .. }) => "too_short",
            Some(BaselineError::NothingMeasured) => "nothing_measured",
            Some(BaselineError::AtRest) => "at_rest",
            Some(BaselineError::OutOfTolerance { .. }) => "out_of_tolerance",
            Some(BaselineError::NotThisMachine { .. }) => "not_this_machine",
            Some(BaselineError::Changes { .. }) => "changes",
        }
    }
}
