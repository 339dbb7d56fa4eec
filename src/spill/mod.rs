//! What is parked between phases, so that a run that was stopped goes on where it was.
//!
//! Between phase B (the whole city) and phase C (patch by patch) the plan of the city is parked as
//! one private file in the growing mesh folder. Together with the chunks that were finished it is
//! all that a resumed run needs; it is removed when the mesh is sealed.
//!
//! # Promises
//! 1. What is fetched is what was parked, bit for bit, or nothing: a file of another job, another
//!    input, another version, or one that was cut short is treated as if it were not there.
//! 2. The file is private scratch, never a format: it may change with every version.
//!
//! # Method
//! bincode 2 over private mirrors of the core types (`mirror`), behind a key that says whose plan
//! it is; written under another name and renamed, read through a memory map. bincode is
//! unmaintained: this is the only module that names it.
//!
//! # Cost
//! About 60 bytes an edge of the arrangement, once; some tens of megabytes for a large city.

mod mirror;

use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Tally;
use crate::domain::finding::Finding;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Arrangement;
use crate::parity::balance::Balance;
use crate::partition::subdomains::Partition;
use std::fs::File;
use std::io::BufWriter;
use std::io::Write;
use std::path::Path;

/// Name of the file in the growing mesh folder.
pub const NAME: &str = "plan.parked";

/// The results of phases A and B.
#[derive(Clone, Debug, PartialEq)]
pub struct Parked {
    /// Noded, clipped, cleaned, with seams.
    pub arrangement: Arrangement,
    /// Curves and sub-domains.
    pub partition: Partition,
    /// What sizes wish of each curve.
    pub goals: Goals,
    /// What each curve gets, and the proof.
    pub balance: Balance,
    /// Stretches of lines that are not in the mesh.
    pub dropped: Vec<Dropped>,
    /// Where clean-up changed the topology.
    pub changes: Vec<Change>,
    /// How often and how far.
    pub tally: Tally,
    /// What a user should know.
    pub findings: Vec<Finding>,
}

/// Parks `plan` in `folder`. `key` says whose it is: input, options and version.
pub fn park(folder: &Path, key: &str, plan: &Parked) -> std::io::Result<()> {
    let growing = folder.join("plan.growing");
    let mut to = BufWriter::new(File::create(&growing)?);
    let configuration = bincode::config::standard();
    bincode::encode_into_std_write(key, &mut to, configuration)
        .and_then(|_| {
            bincode::encode_into_std_write(mirror::Plan::of(plan), &mut to, configuration)
        })
        .map_err(std::io::Error::other)?;
    to.flush()?;
    to.get_ref().sync_all()?;
    std::fs::rename(growing, folder.join(NAME))
}

/// The plan that was parked in `folder` under `key`, if there is one.
pub fn fetch(folder: &Path, key: &str) -> Option<Parked> {
    let file = File::open(folder.join(NAME)).ok()?;
    // SAFETY: the file was renamed when complete and no run writes to it again; two runs on one
    // output folder are the user's mistake and end in a decoding error or a wrong key at worst.
    let bytes = unsafe { memmap2::Mmap::map(&file) }.ok()?;
    let configuration = bincode::config::standard();
    let (found, read): (String, usize) = bincode::decode_from_slice(&bytes, configuration).ok()?;
    if found != key {
        return None;
    }
    let (plan, _): (mirror::Plan, usize) =
        bincode::decode_from_slice(&bytes[read..], configuration).ok()?;
    plan.into_parked()
}

/// Removes what was parked in `folder`.
pub fn remove(folder: &Path) -> std::io::Result<()> {
    std::fs::remove_file(folder.join(NAME))
}
