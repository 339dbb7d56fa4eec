//! Records -> FlatBuffers, column by column: one file of code a file of the mesh.

pub(crate) mod chunk;
pub(crate) mod frame;
pub(crate) mod index;
pub(crate) mod lines;

use crate::chunk::error::Error;
use flatbuffers::FlatBufferBuilder;
use flatbuffers::ForwardsUOffset;
use flatbuffers::Vector;
use flatbuffers::WIPOffset;
use std::path::Path;

/// A FlatBuffer holds at most 2 GiB; some room for tables and padding.
const LARGEST: u64 = (1 << 31) - (1 << 16);

type Builder<'a> = FlatBufferBuilder<'a>;
type Strings<'a> = WIPOffset<Vector<'a, ForwardsUOffset<&'a str>>>;

/// A finished FlatBuffer. Builders fill from the end, so it is the rest of an allocation.
pub(crate) struct Encoded {
    allocation: Vec<u8>,
    head: usize,
}

impl From<Builder<'_>> for Encoded {
    fn from(builder: Builder<'_>) -> Encoded {
        let (allocation, head) = builder.collapse();
        Encoded { allocation, head }
    }
}

impl Encoded {
    /// What goes into the file.
    pub fn bytes(&self) -> &[u8] {
        &self.allocation[self.head..]
    }
}
/// A builder that does not grow by doubling: the whole size is known.
fn builder_for<'a>(bytes: usize, path: &Path) -> Result<Builder<'a>, Error> {
    if bytes as u64 > LARGEST {
        return Err(Error::TooLarge {
            path: path.to_path_buf(),
            bytes: bytes as u64,
        });
    }
    Ok(Builder::with_capacity(bytes + (1 << 12)))
}

fn strings<'a>(builder: &mut Builder<'a>, texts: &[impl AsRef<str>]) -> Strings<'a> {
    let made: Vec<_> = (texts.iter())
        .map(|text| builder.create_string(text.as_ref()))
        .collect();
    builder.create_vector(&made)
}

/// Offsets of consecutive groups: 0, then the running sum of `lengths`.
fn offsets(lengths: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut at = 0_usize;
    let mut starts = vec![0];
    for length in lengths {
        at += length;
        starts.push(u32::try_from(at).expect("fewer than 2^32 rows: a file holds 2 GiB"));
    }
    starts
}
