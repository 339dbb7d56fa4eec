//! The steps of clean-up by name, so that each can be left out and its worth measured.

/// One step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Nodes on a nearly straight way go.
    Simplify,
    /// Short edges are contracted, near misses joined.
    Separate,
    /// Acute wedges share their way.
    Zip,
    /// Long arms of wedges that could not be zipped get nodes.
    Divide,
    /// Thin faces and small triangles are closed.
    Collapse,
    /// Nodes and edges push each other apart.
    Relax,
    /// Tips of strips and wedges get an edge across.
    Blunt,
    /// Small faces with an odd number of edges get an even one.
    Even,
}

impl Step {
    /// All steps and their names.
    pub const NAMED: [(&'static str, Step); 8] = [
        ("simplify", Step::Simplify),
        ("separate", Step::Separate),
        ("zip", Step::Zip),
        ("divide", Step::Divide),
        ("collapse", Step::Collapse),
        ("relax", Step::Relax),
        ("blunt", Step::Blunt),
        ("even", Step::Even),
    ];

    /// The step of that name.
    pub fn named(name: &str) -> Option<Step> {
        (Step::NAMED.iter())
            .find(|it| it.0 == name)
            .map(|&(_, step)| step)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Step::NAMED[self as usize].0
    }
}
