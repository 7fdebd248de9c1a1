//! What a command has to say, and where it goes.
//!
//! The answer goes to standard output, or its JSON form in its place (`--json -`); remarks and
//! progress go to standard error, unless `--quiet`. Of a command that another program called, all of
//! it goes to the caller's desk.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use clap::Args;
use drivescope_recording::{ReadOptions, Recording, Report};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::call::Desk;
use crate::failure::Failure;
use crate::next::Next;
use crate::output;

/// What every command takes.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Common options")]
pub(crate) struct Common {
    /// Write the result as JSON to FILE, or with `-` to standard output in place of the text.
    #[arg(long, global = true, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
    /// Seed of everything random: the same seed gives the same bytes; 1 by default, and a fresh
    /// one for benchmarks.
    #[arg(long, global = true, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Say nothing but the answer and errors: no progress, no remarks; nothing at all where the
    /// result is in the file that was asked for.
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
}

/// The common options of a run.
#[derive(Debug)]
pub(crate) struct Session {
    json: Option<PathBuf>,
    /// Seed of everything random.
    pub(crate) seed: u64,
    /// The seed that was asked for.
    pub(crate) given_seed: Option<u64>,
    quiet: bool,
    /// How recordings are read, to be kept beside them once the answer is given: a command that is
    /// refused leaves nothing.
    to_keep: Mutex<Vec<(PathBuf, ReadOptions)>>,
    /// Of a command that another program called.
    desk: Option<Arc<Desk>>,
}

/// Seed where none is given.
pub(crate) const USUAL_SEED: u64 = 1;
/// What a bar of many equal things shows.
const RATES: &str = "{human_pos} of {human_len} {msg} {wide_bar} {per_sec:>10} {eta:>4}";
/// How often a progress bar is drawn.
const REDRAW: Duration = Duration::from_millis(100);

impl Session {
    pub(crate) fn new(common: &Common) -> Self {
        let (seed, given_seed) = (common.seed.unwrap_or(USUAL_SEED), common.seed);
        Self {
            json: common.json.clone(),
            seed,
            given_seed,
            quiet: common.quiet,
            to_keep: Mutex::default(),
            desk: None,
        }
    }

    /// The session of a command that another program called.
    pub(crate) fn of_call(common: &Common, desk: Arc<Desk>) -> Self {
        Self { desk: Some(desk), ..Self::new(common) }
    }

    /// The recording that the caller handed over under that name.
    pub(crate) fn recording(&self, name: &Path) -> Option<(Recording, Report)> {
        self.desk.as_ref()?.recording(name).cloned()
    }

    /// Writes a recording, or hands it back to the caller that named no file for it.
    ///
    /// # Errors
    /// As [`output::write_recording`].
    pub(crate) fn write_recording(&self, path: &Path, recording: Recording) -> miette::Result<()> {
        match self.desk.as_ref().filter(|desk| desk.is_scratch(path)) {
            Some(desk) => {
                desk.hand_back(path, recording);
                Ok(())
            }
            None => output::write_recording(path, &recording),
        }
    }

    /// The file as an answer names it: not where a caller named none.
    pub(crate) fn named(&self, path: &Path) -> Option<PathBuf> {
        let scratch = self.desk.as_ref().is_some_and(|desk| desk.is_scratch(path));
        (!scratch).then(|| path.to_owned())
    }

    /// One that says nothing, for work that the page asked for.
    pub(crate) fn silent(seed: u64) -> Self {
        let (json, to_keep) = Default::default();
        Self { json, seed, given_seed: Some(seed), quiet: true, to_keep, desk: None }
    }

    /// Finds out whether the answer can be written, before the work.
    ///
    /// # Errors
    /// The path that cannot be written.
    pub(crate) fn check_writable(&self, targets: &[&PathBuf]) -> Result<(), Failure> {
        let json = self.json.iter().filter(|path| path.as_os_str() != "-");
        targets.iter().copied().chain(json).try_for_each(|path| output::check_writable(path))
    }

    /// Gives the answer and names the command to type next.
    ///
    /// # Errors
    /// The file or standard output cannot be written.
    pub(crate) fn say(
        &self,
        text: &str,
        json: &impl Serialize,
        next: &Next,
    ) -> Result<(), Failure> {
        match self.printed(text, json) {
            // Who has gone away types nothing next.
            Err(Failure::Unread) => {}
            done => {
                done?;
                // A caller types nothing into a shell.
                if self.desk.is_none() {
                    self.remark(next);
                }
            }
        }
        Ok(())
    }

    /// The same where the result is in a file that was asked for: the text tells of it only, and
    /// `--quiet` leaves it out.
    ///
    /// # Errors
    /// As [`Session::say`].
    pub(crate) fn wrote(
        &self,
        text: &str,
        json: &impl Serialize,
        next: &Next,
    ) -> Result<(), Failure> {
        self.say(if self.quiet { "" } else { text }, json, next)
    }

    /// Gives the answer: the text for a person, and its JSON form where it was asked for. Whether
    /// anybody reads standard output changes nothing.
    ///
    /// # Errors
    /// The file or standard output cannot be written.
    pub(crate) fn answer(&self, text: &str, json: &impl Serialize) -> Result<(), Failure> {
        match self.printed(text, json) {
            Err(Failure::Unread) => Ok(()),
            done => done,
        }
    }

    fn printed(&self, text: &str, json: &impl Serialize) -> Result<(), Failure> {
        if let Some(desk) = &self.desk {
            desk.answer(text, output::json(json)?);
            return Ok(());
        }
        self.keep();
        match &self.json {
            Some(path) if path.as_os_str() == "-" => return output::print(&output::json(json)?),
            Some(path) => {
                let json = output::json(json)?;
                output::write_file(path, |out| out.write_all(json.as_bytes()))?;
            }
            None => {}
        }
        let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        output::print(&format!("{text}{end}"))
    }

    /// Keeps how a recording is read beside it, once the answer is given.
    pub(crate) fn keep_later(&self, recording: &Path, options: ReadOptions) {
        let mut to_keep = self.to_keep.lock().unwrap_or_else(PoisonError::into_inner);
        to_keep.push((recording.to_owned(), options));
    }

    fn keep(&self) {
        let mut to_keep = self.to_keep.lock().unwrap_or_else(PoisonError::into_inner);
        for (recording, options) in to_keep.drain(..) {
            // A folder that cannot be written to is no reason not to answer.
            match options.keep(&recording) {
                Ok(kept) => self.remark(format_args!("columns kept in {}", kept.display())),
                Err(error) => self.remark(format_args!("columns not kept for later: {error}")),
            }
        }
    }

    /// Whether standard output is for JSON alone.
    pub(crate) fn prints_json(&self) -> bool {
        self.json.as_ref().is_some_and(|path| path.as_os_str() == "-")
    }

    /// Whether JSON goes to a file.
    pub(crate) fn writes_json(&self) -> bool {
        self.json.is_some() && !self.prints_json()
    }

    /// Says something beside the answer.
    pub(crate) fn remark(&self, text: impl std::fmt::Display) {
        if self.quiet {
            return;
        }
        if let Some(desk) = &self.desk {
            desk.remark(text.to_string());
        } else {
            // Standard error that cannot be written to leaves nobody to tell.
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }

    /// Progress without a known end; hidden when quiet or not on a terminal.
    pub(crate) fn spinner(&self) -> ProgressBar {
        if let Some(desk) = &self.desk {
            return desk.bar(None, "");
        }
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let spinner = ProgressBar::new_spinner();
        spinner.enable_steady_tick(REDRAW);
        spinner
    }

    /// A progress bar with the rate; hidden when quiet or not on a terminal.
    pub(crate) fn rates(&self, steps: u64, what: &'static str) -> ProgressBar {
        let bar = self.progress(steps, what);
        if let Ok(style) = ProgressStyle::with_template(RATES) {
            bar.set_style(style);
        }
        bar
    }

    /// A progress bar over that many steps; hidden when quiet or not on a terminal.
    pub(crate) fn progress(&self, steps: u64, what: &'static str) -> ProgressBar {
        if let Some(desk) = &self.desk {
            return desk.bar(Some(steps), what);
        }
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new(steps).with_message(what);
        let style = "{msg} {wide_bar} {percent:>3} % {eta:>4}";
        bar.set_style(
            ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.enable_steady_tick(REDRAW);
        bar
    }
}
