//! The program's views of results: tables for the terminal, reports for the browser.

pub mod report;
pub mod tables;
