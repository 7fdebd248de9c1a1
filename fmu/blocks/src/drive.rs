//! A simulation unit of the plant behind the FMI trait.

use std::path::{Path, PathBuf};

use drivescope_fmu::description::ModelDescription;
use drivescope_fmu::export::{Continuous, DiscreteUpdate, Model};
use drivescope_plant::drive::Drive;
use drivescope_plant::file::DriveFileError;
use drivescope_plant::unit::{MemoryError, Unit, UnitError};
use thiserror::Error;

use crate::description::describe;
use crate::reference::place;

/// Name of the drive file among the FMU's resources.
pub const DRIVE_FILE: &str = "drive.toml";
/// A resource of this name says that the loop is open: u is an input.
pub const OPEN_LOOP_FILE: &str = "open_loop";

/// What can go wrong inside an exported drive.
#[derive(Debug, Error)]
pub enum DriveError {
    /// There is no resources folder.
    #[error(
        "the FMU has no `resources` folder, where its drive file `{DRIVE_FILE}` belongs: unpack it whole"
    )]
    NoResources,
    /// The drive file cannot be read.
    #[error("cannot read the drive file {}", path.display())]
    Read {
        /// Where it should be.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// The drive file is wrong.
    #[error(transparent)]
    File(#[from] DriveFileError),
    /// A value is not possible.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// Bytes that are no saved state.
    #[error("a saved state holds whole numbers of eight bytes, not {bytes} bytes")]
    Bytes {
        /// How many there are.
        bytes: usize,
    },
    /// Numbers that are no saved state of this drive.
    #[error(transparent)]
    Memory(#[from] MemoryError),
}

/// A drive as an FMI model. Value reference k + 1 is the unit's variable k.
#[derive(Debug, Clone)]
pub struct DriveModel(Unit);

impl DriveModel {
    /// The FMI model of a drive; `open_loop` makes u an input.
    pub fn new(drive: Drive, open_loop: bool) -> Self {
        Self(Unit::new(drive, open_loop))
    }
}

impl Model for DriveModel {
    type Error = DriveError;

    fn instantiate(resources: Option<&Path>) -> Result<Self, DriveError> {
        let resources = resources.ok_or(DriveError::NoResources)?;
        let path = resources.join(DRIVE_FILE);
        let text =
            std::fs::read_to_string(&path).map_err(|source| DriveError::Read { path, source })?;
        let drive = Drive::parse(&text, DRIVE_FILE)?;
        Ok(Self::new(drive, resources.join(OPEN_LOOP_FILE).exists()))
    }

    fn description(&self) -> ModelDescription {
        describe(&self.0)
    }

    fn get(&self, reference: u32) -> Option<f64> {
        self.0.get(place(reference))
    }

    fn set(&mut self, reference: u32, value: f64) -> Result<(), DriveError> {
        Ok(self.0.set(place(reference), value)?)
    }

    fn initialize(&mut self, start: f64) -> Result<(), DriveError> {
        self.0.initialize(start);
        Ok(())
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), DriveError> {
        self.0.set_time(t);
        Ok(self.0.step(h)?)
    }

    fn serialize(&self) -> Vec<u8> {
        self.0.memory().into_iter().flat_map(f64::to_le_bytes).collect()
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), DriveError> {
        let (numbers, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(DriveError::Bytes { bytes: bytes.len() });
        }
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        Ok(self.0.restore(&numbers)?)
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous<Error = DriveError>> {
        Some(self)
    }

    fn directional(&self, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Option<Vec<f64>> {
        let places = |references: &[u32]| references.iter().map(|r| place(*r)).collect::<Vec<_>>();
        self.0.directional(&places(unknowns), &places(knowns), seed)
    }
}

impl Continuous for DriveModel {
    type Error = DriveError;

    fn set_time(&mut self, t: f64) {
        self.0.set_time(t);
    }

    fn states(&self) -> &[f64] {
        self.0.continuous_states()
    }

    fn set_states(&mut self, states: &[f64]) {
        self.0.set_continuous_states(states);
    }

    fn derivatives(&mut self) -> Result<&[f64], DriveError> {
        Ok(self.0.derivatives())
    }

    fn event_indicators(&mut self) -> Result<&[f64], DriveError> {
        Ok(self.0.event_indicators())
    }

    fn update_discrete(&mut self) -> Result<DiscreteUpdate, DriveError> {
        let update = self.0.update_discrete();
        Ok(DiscreteUpdate {
            again: false,
            states_changed: update.states_changed,
            next_event: update.next_event,
        })
    }
}
