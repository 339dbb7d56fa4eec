//! SMS .2dm: nodes, quads, and a node string for each chain of mesh edges of each constraint line.

use crate::chunk::chains::LineEdges;
use crate::chunk::chains::Step;
use crate::chunk::reader::Mesh;
use crate::export::Stats;
use crate::export::destination::Destination;
use crate::export::error::Error;
use std::io;
use std::io::Write;

/// Ids that a line of a node string holds.
const STRING_WIDTH: usize = 10;

pub(crate) fn write(mesh: &Mesh, to: &mut Destination) -> Result<Stats, Error> {
    let index = mesh.index();
    if index.nodes.max(index.quads) > i32::MAX as u64 {
        return Err(Error::TooLarge {
            what: "nodes or quads",
            found: index.nodes.max(index.quads),
        });
    }
    // Readers look for this word first.
    to.write(|file| writeln!(file, "MESH2D\nMESHNAME \"mesh2d\""))?;
    let mut quad = 0_u64;
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        for (row, patch) in (chunk.first_patch()..).zip(chunk.view().patches()) {
            let base = index.patch_node_base[row];
            to.write(|file| {
                for corners in patch.quads {
                    quad += 1;
                    let [a, b, c, d] = corners.map(|node| patch.global(node, base) + 1);
                    // The last number is the material. One for all: a modeller divides the mesh by
                    // land use, which is no matter of ours.
                    writeln!(file, "E4Q {quad} {a} {b} {c} {d} 1")?;
                }
                Ok(())
            })?;
        }
    }
    let [ox, oy] = index.grid.origin_m;
    let mut node = 0_u64;
    let mut place = |file: &mut dyn Write, [x, y]: [f64; 2]| {
        node += 1;
        // The shortest numbers that read back as the same bits: rounded, thin cells could fold.
        writeln!(file, "ND {node} {:?} {:?} 0.0", x + ox, y + oy)
    };
    to.write(|file| mesh.frame().nodes.iter().try_for_each(|&p| place(file, p)))?;
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        let interior = chunk.view().interior;
        to.write(|file| interior.iter().try_for_each(|&p| place(file, p)))?;
    }
    let features = strings(mesh, to)?;
    Ok(Stats {
        nodes: index.nodes,
        quads: index.quads,
        features,
        bytes: 0,
    })
}

/// Node strings in the order of the lines. Their number says how many there are.
fn strings(mesh: &Mesh, to: &mut Destination) -> Result<u64, Error> {
    let lines = mesh.lines();
    let edges = LineEdges::of(mesh);
    let mut number = 0;
    for line in (0..lines.lines()).filter(|&line| lines.role[line] == 0) {
        for chain in edges.chains_of(line) {
            number += 1;
            to.write(|file| string(file, &chain, number))?;
        }
    }
    Ok(number)
}

fn string(file: &mut dyn Write, chain: &[Step], number: u64) -> io::Result<()> {
    let first = chain.first().map(|step| step.from);
    let nodes: Vec<u32> = first
        .into_iter()
        .chain(chain.iter().map(|step| step.to))
        .collect();
    for (k, row) in nodes.chunks(STRING_WIDTH).enumerate() {
        write!(file, "NS")?;
        let last = (k + 1) * STRING_WIDTH >= nodes.len();
        let (end, inner) = row.split_last().expect("chunks are not empty");
        for node in inner {
            write!(file, " {}", node + 1)?;
        }
        if last {
            // A negative id closes the string; its number follows.
            writeln!(file, " -{} {number}", end + 1)?;
        } else {
            writeln!(file, " {}", end + 1)?;
        }
    }
    Ok(())
}
