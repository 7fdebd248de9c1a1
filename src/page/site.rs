//! All sessions of work of one run of the server.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use tempfile::TempDir;

use super::Served;
use super::bench::Bench;
use super::guard::{Guard, secret};
use super::study::FaultStudy;
use crate::failure::Failure;

/// Sessions that are kept; the one that was left longest goes first.
const MOST_BENCHES: usize = 12;

/// What the server knows.
#[derive(Debug)]
pub(super) struct Site {
    pub(super) guard: Arc<Guard>,
    /// Seed of everything random.
    pub(super) seed: u64,
    /// Greatest size of an uploaded file, bytes.
    pub(super) most_bytes: u64,
    /// Where uploaded files and exports lie; it goes with the server.
    pub(super) folder: TempDir,
    /// The faults view, of which there is one.
    pub(super) study: Arc<FaultStudy>,
    benches: Mutex<HashMap<String, (Arc<Bench>, Instant)>>,
    /// The session that the command line began, until somebody opens it.
    begun: Mutex<Option<String>>,
}

impl Site {
    pub(super) fn new(guard: Guard, seed: u64, most_bytes: u64) -> Result<Arc<Self>, Failure> {
        let unwritable = |source| Failure::Write { path: std::env::temp_dir(), source };
        let folder =
            tempfile::Builder::new().prefix("drivescope-").tempdir().map_err(unwritable)?;
        let (benches, begun) = Default::default();
        let (guard, study) = (Arc::new(guard), Arc::default());
        Ok(Arc::new(Self { guard, seed, most_bytes, folder, study, benches, begun }))
    }

    /// A session of the drive and the recordings of the command line, if there are any.
    ///
    /// # Errors
    /// What cannot be read.
    pub(super) fn begin_with(&self, served: &Served) -> miette::Result<()> {
        if served.drive.is_none() && served.recordings.is_empty() {
            return Ok(());
        }
        let bench = self.new_bench();
        if let Some(given) = &served.drive {
            bench.take_drive(given, &crate::drive_source::text(given)?)?;
        }
        for path in &served.recordings {
            bench.take_file(path)?;
        }
        bench.analyse();
        *self.begun.lock().unwrap_or_else(PoisonError::into_inner) = Some(bench.id.clone());
        Ok(())
    }

    /// A new session, or the one that the command line began.
    pub(super) fn opened(&self) -> String {
        let begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner).take();
        begun.unwrap_or_else(|| self.new_bench().id.clone())
    }

    fn new_bench(&self) -> Arc<Bench> {
        let bench = Arc::new(Bench::new(secret(), self.seed));
        let mut all = self.benches.lock().unwrap_or_else(PoisonError::into_inner);
        while all.len() >= MOST_BENCHES {
            let idle = all.iter().filter(|(_, (bench, _))| !bench.is_busy());
            let Some(oldest) = idle.min_by_key(|it| it.1.1).map(|it| it.0.clone()) else { break };
            all.remove(&oldest);
        }
        all.insert(bench.id.clone(), (Arc::clone(&bench), Instant::now()));
        bench
    }

    /// The session of that name.
    pub(super) fn bench(&self, id: &str) -> Option<Arc<Bench>> {
        let mut all = self.benches.lock().unwrap_or_else(PoisonError::into_inner);
        let (bench, used) = all.get_mut(id)?;
        *used = Instant::now();
        Some(Arc::clone(bench))
    }
}
