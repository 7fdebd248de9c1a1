//! What a user sees of an error in the program itself: one line, not a trace.

use std::io::Write;
use std::panic::{self, PanicHookInfo};

/// Replaces the standard message of a panic.
pub(crate) fn install() {
    install_with(|line| {
        let _ = writeln!(std::io::stderr(), "{line}");
    });
}

/// The same where the line goes elsewhere than to standard error.
pub(crate) fn install_with(say: impl Fn(String) + Send + Sync + 'static) {
    panic::set_hook(Box::new(move |info| {
        // A damaged recording that a foreign reader stumbles over becomes an error of its own.
        if drivescope_recording::is_reading() {
            return;
        }
        say(line(info));
    }));
}

fn line(info: &PanicHookInfo<'_>) -> String {
    let payload = info.payload();
    let said = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no reason given");
    let place =
        info.location().map_or(String::new(), |at| format!(" at {}:{}", at.file(), at.line()));
    let said = said.lines().next().unwrap_or_default();
    format!("drivescope: internal error{place}: {said}; please report it with the command you ran")
}
