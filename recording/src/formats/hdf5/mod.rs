//! HDF5, and MAT files of version 7.3, which are HDF5 with marks of MATLAB's own.
//!
//! Datasets of numbers are series or constants under the path of their groups; the fields of a
//! compound dataset are columns. MATLAB stores matrices transposed and keeps what stands in cell
//! arrays and struct arrays in a group `#refs#`, to which references lead.

mod dataset;

use std::fs::File;
use std::sync::Arc;

use hdf5_reader::group::Group;
use hdf5_reader::{FileStorage, Hdf5File, OpenOptions};

use super::Format;
use super::tree::{KeyPath, Tree};
use crate::budget::{Budget, MOST_NUMBERS, NUMBER_BYTES};
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::table::Table;

pub(super) static FORMAT: Format = Format {
    name: "HDF5",
    extensions: &["h5", "hdf5", "hdf"],
    // A file may begin with a block of its writer's own: 512 bytes, or twice that, and so on.
    starts: |head| {
        let at = |from: usize| head.get(from..).is_some_and(|it| it.starts_with(SIGNATURE));
        at(0) || at(512) || at(1024) || at(2048)
    },
    read,
    write: None,
};

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Groups in groups; a link may lead back to where it stands.
const DEEPEST: usize = 16;
/// Groups and datasets that are looked at.
const MOST_OBJECTS: usize = 10_000;
/// A chunk is unpacked as a whole.
const LARGEST_CHUNK: usize = 256 << 20;
/// What an object costs beside its values, in numbers.
const OBJECT: usize = 256;

fn read(opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let mut budget = Budget::new(file);
    let mut walk =
        Walk { tree: Tree::default(), budget: &mut budget, objects: 0, references: None };
    let walked = walk.file(opened);
    let tree = walk.tree;
    walked.map_err(|broken| match broken {
        Broken::TooLarge(error) => error,
        Broken::Foreign(error) => {
            let (file, format) = (file.to_owned(), FORMAT.name);
            Error::Damaged { file, format, what: error.to_string() }
        }
    })?;
    tree.into_table(file, options, &mut budget)
}

/// Why reading ends early.
enum Broken {
    Foreign(hdf5_reader::error::Error),
    TooLarge(Error),
}

impl From<hdf5_reader::error::Error> for Broken {
    fn from(error: hdf5_reader::error::Error) -> Broken {
        Broken::Foreign(error)
    }
}

impl From<Error> for Broken {
    fn from(error: Error) -> Broken {
        Broken::TooLarge(error)
    }
}

/// Collects what the groups hold.
struct Walk<'a> {
    tree: Tree,
    budget: &'a mut Budget,
    objects: usize,
    /// MATLAB's group of what is referred to.
    references: Option<Group>,
}

impl Walk<'_> {
    fn file(&mut self, opened: File) -> Result<(), Broken> {
        let limits = OpenOptions::default()
            .with_max_read_bytes(MOST_NUMBERS * NUMBER_BYTES)
            .with_max_chunk_bytes(LARGEST_CHUNK);
        let storage = Arc::new(FileStorage::from_file(opened)?);
        let root = Hdf5File::from_storage_with_options(storage, limits)?.root_group()?;
        self.references = root.group("#refs#").ok();
        self.group(&root, &Vec::new())
    }

    /// A group's datasets, the groups in it, and the numbers among its attributes.
    fn group(&mut self, group: &Group, path: &KeyPath) -> Result<(), Broken> {
        if path.len() > DEEPEST {
            return Ok(());
        }
        self.attributes(group, path)?;
        let (groups, datasets) = group.members()?;
        for dataset in datasets {
            let path = beneath(path, last_of(dataset.name()));
            self.dataset(&dataset, path)?;
        }
        // What begins like that is MATLAB's own.
        for inner in groups.iter().filter(|it| !last_of(it.name()).starts_with('#')) {
            self.object()?;
            self.group(inner, &beneath(path, last_of(inner.name())))?;
        }
        Ok(())
    }

    /// Counts an object, so that links in a circle come to an end.
    fn object(&mut self) -> Result<(), Broken> {
        self.objects += 1;
        self.budget.take(OBJECT)?;
        if self.objects > MOST_OBJECTS { Err(self.budget.too_large().into()) } else { Ok(()) }
    }

    /// Single numbers, as loggers keep the parameters of a bench.
    fn attributes(&mut self, group: &Group, path: &KeyPath) -> Result<(), Broken> {
        // Attributes that cannot be read take nothing from the signals.
        for attribute in group.attributes().unwrap_or_default() {
            let ours = !attribute.name.starts_with("MATLAB_") && !attribute.name.starts_with('_');
            if ours
                && attribute.num_elements().is_ok_and(|count| count == 1)
                && let Ok(value) = attribute.read_as_f64()
            {
                self.tree.number(beneath(path, &attribute.name), value);
            }
        }
        Ok(())
    }
}

fn beneath(path: &KeyPath, name: &str) -> KeyPath {
    path.iter().map(String::as_str).chain([name]).map(str::to_owned).collect()
}

fn last_of(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}
