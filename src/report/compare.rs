//! The report of a comparison.

use maud::html;

use super::page::page;
use crate::answer::block::Block;
use crate::answer::compare::Setting;
use crate::answer::html::report;

/// One self-contained HTML page of what it says.
pub(crate) fn compare_html(setting: &Setting, blocks: &[Block]) -> String {
    let title = format!("Model against measurement: {}", setting.drive);
    let about = html! { "A drive's model compared with recordings of the drive." };
    let made = html! {
        "drivescope compare, seed " (setting.seed) ". The same files and seed give the same \
         figures."
    };
    page(&title, &about, &report(blocks), &made)
}
