//! The list of detectors of the residual, and the dispatch from a detector at work to its test.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::law::{Info, Refusal, ResidualDetector};
use super::running::{Judged, ResidualTest};
use crate::data::{Data, DataError};
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::memory::{Memory, MemoryError, Walk};
use crate::model::ModelRun;
use crate::parts::Parts;
use crate::threshold::{Band, Confidence};

/// A registered detector, as the lists of the program see it.
struct Entry {
    info: &'static Info,
    start: fn(&Parts<'_>, &Stored, Confidence) -> Option<Started>,
    settles: fn(&Parts<'_>, &Stored) -> usize,
    refusal: fn(&Parts<'_>, &Stored) -> Option<Refusal>,
    is_held: fn(&Parts<'_>, &Stored) -> bool,
    check: fn(&Parts<'_>, &Stored) -> Result<(), Flaw>,
    designed: fn(&Parts<'_>, &Stored) -> Option<String>,
}

/// The model whose residual is watched, and the test of it.
type Started = Result<(ModelRun, DetectorRun), DetectorError>;

macro_rules! registry {
    ($($detector:ident in $module:ident),+ $(,)?) => {
        /// Which detector of the residual.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum DetectorKind {
            $($detector,)+
        }

        impl DetectorKind {
            /// Every detector, in the order of tables and lists.
            pub const ALL: [Self; [$(stringify!($module)),+].len()] = [$(Self::$detector),+];

            const fn entry(self) -> &'static Entry {
                const ENTRIES: &[Entry] = &[$({
                    type Of = super::$module::$detector;

                    fn held<'a>(
                        parts: &Parts<'a>,
                        stored: &'a Stored,
                    ) -> Option<&'a <Of as ResidualDetector>::Held> {
                        Of::held(parts, stored.$module.as_ref())
                    }

                    Entry {
                        info: &Of::INFO,
                        start: |parts, stored, confidence| {
                            let held = held(parts, stored)?;
                            Some(Of::start(held, confidence).map(|run| {
                                (Of::process(held, parts), DetectorRun::$detector(run))
                            }))
                        },
                        settles: |parts, stored| held(parts, stored).map_or(0, Of::settles),
                        refusal: |parts, stored| Of::refusal(held(parts, stored)?, parts),
                        is_held: |parts, stored| held(parts, stored).is_some(),
                        check: |parts, stored| {
                            let inputs = parts.interface.inputs.len();
                            held(parts, stored).map_or(Ok(()), |held| Of::check(held, inputs))
                        },
                        designed: |parts, stored| {
                            Of::designed(held(parts, stored)?, &parts.interface.output.unit)
                        },
                    }
                }),+];
                &ENTRIES[self as usize]
            }
        }

        /// What the diagnoser file holds of those detectors that have no key of their own there.
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Stored {
            $(
                #[serde(skip_serializing_if = "Option::is_none")]
                pub(crate) $module: Option<<super::$module::$detector as ResidualDetector>::Stored>,
            )+
        }

        impl Stored {
            /// Whether there is nothing.
            pub fn is_empty(&self) -> bool {
                true $(&& self.$module.is_none())+
            }

            /// Designs every detector on a healthy residual, the output of `healthy`.
            pub(crate) fn design(
                healthy: &Data,
                run_up: usize,
                confidence: Confidence,
            ) -> Result<Self, DataError> {
                Ok(Self {
                    $($module: super::$module::$detector::design(healthy, run_up, confidence)?,)+
                })
            }
        }

        /// A detector at work.
        #[derive(Debug, Clone)]
        pub enum DetectorRun {
            $(
                $detector(<super::$module::$detector as ResidualDetector>::Run),
            )+
        }

        impl ResidualTest for DetectorRun {
            fn reset(&mut self) {
                match self { $(Self::$detector(run) => ResidualTest::reset(run),)+ }
            }

            fn settle(&mut self, u: &[f64]) {
                match self { $(Self::$detector(run) => ResidualTest::settle(run, u),)+ }
            }

            #[inline]
            fn step(&mut self, u: &[f64], residual: f64) -> Judged {
                match self { $(Self::$detector(run) => run.step(u, residual),)+ }
            }

            #[inline]
            fn disregard(&mut self) {
                match self { $(Self::$detector(run) => run.disregard(),)+ }
            }

            #[inline]
            fn middle(&self, band: Band) -> f64 {
                match self { $(Self::$detector(run) => run.middle(band),)+ }
            }
        }

        impl Memory for DetectorRun {
            fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
                match self { $(Self::$detector(run) => run.walk(walk),)+ }
            }
        }
    };
}

registry! {
    Mem in mem,
    MemRecurrent in mem_recurrent,
    Constant in constant,
    Gmdh in gmdh,
}

impl DetectorKind {
    /// What it is called and how it decides.
    pub fn info(self) -> &'static Info {
        self.entry().info
    }

    /// Name in files and options.
    pub fn id(self) -> &'static str {
        self.info().id
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        self.info().label
    }

    /// The detector of that name.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Whether a diagnoser of these parts holds what it rests on.
    pub(crate) fn is_held(self, parts: &Parts<'_>, stored: &Stored) -> bool {
        (self.entry().is_held)(parts, stored)
    }

    /// What was designed, in a line for people; nothing if that is told elsewhere.
    pub(crate) fn designed(self, parts: &Parts<'_>, stored: &Stored) -> Option<String> {
        (self.entry().designed)(parts, stored)
    }

    /// Samples that its models need to settle.
    pub(crate) fn settles(self, parts: &Parts<'_>, stored: &Stored) -> usize {
        (self.entry().settles)(parts, stored)
    }

    /// Why it is not to be used, though it is there.
    pub(crate) fn refusal(self, parts: &Parts<'_>, stored: &Stored) -> Option<Refusal> {
        (self.entry().refusal)(parts, stored)
    }

    /// Refuses what cannot run.
    pub(crate) fn check(self, parts: &Parts<'_>, stored: &Stored) -> Result<(), Flaw> {
        (self.entry().check)(parts, stored)
    }

    /// The model whose residual it watches, and the test of it, at their start.
    pub(crate) fn start(
        self,
        parts: &Parts<'_>,
        stored: &Stored,
        confidence: Confidence,
    ) -> Started {
        let missing = DetectorError::Missing { part: self.info().part };
        (self.entry().start)(parts, stored, confidence).unwrap_or(Err(missing))
    }
}

/// Its id.
impl Serialize for DetectorKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

impl<'de> Deserialize<'de> for DetectorKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let id = String::deserialize(deserializer)?;
        let known = Self::ALL.map(Self::id).join(", ");
        let unknown = || D::Error::custom(format!("no detector `{id}`; known are {known}"));
        Self::find(&id).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found_and_those_of_the_paper_are_in_files() {
        for (k, kind) in DetectorKind::ALL.into_iter().enumerate() {
            let Info { id, label, about, part, .. } = kind.info();
            assert!(DetectorKind::ALL[..k].iter().all(|it| it.id() != *id && it.label() != *label));
            assert_eq!(DetectorKind::find(id), Some(kind));
            assert!(!about.is_empty() && !part.is_empty(), "{id}");
        }
        let ids = ["mem", "mem_recurrent", "constant", "gmdh"];
        assert!(ids.into_iter().all(|id| DetectorKind::find(id).is_some()));
        assert!(DetectorKind::find("bank").is_none());
    }
}
