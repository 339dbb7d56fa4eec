//! Operations that are tried together: all of them are done, or the graph is as it was.
//!
//! What failed must leave no trace: a node that was only tried would be looked at again in the next
//! round, and tried again.

use smallvec::SmallVec;

use crate::cleanup::graph::Graph;
use crate::cleanup::graph::Stand;
use crate::geometry::point::Point;

/// What an attempt did, to be taken back.
pub(super) enum Deed {
    /// The newest node.
    AddedNode,
    /// The newest edge.
    Added,
    Removed(u32),
    Shifted {
        node: u32,
        from: Point,
        stations: Stations,
    },
    /// The node had been settled.
    Woken(u32),
}

/// Stations as they were: edge, index of the piece, is it the end of the piece, metres.
pub(super) type Stations = SmallVec<[(u32, u32, bool, f64); 4]>;

impl Graph<'_> {
    /// Does what `tried` does, or nothing if it returns `None`. It may bend edges to new nodes and
    /// shift nodes; whatever changes edges that stay must come last, and succeed.
    pub(super) fn attempt<R>(&mut self, tried: impl FnOnce(&mut Self) -> Option<R>) -> Option<R> {
        assert!(self.deeds.is_none(), "attempts are not nested");
        let (touched, changed) = (self.touched.len(), self.changed.len());
        self.deeds = Some(Vec::new());
        let done = tried(self);
        let deeds = self.deeds.take().expect("an attempt is under way");
        if done.is_none() {
            for deed in deeds.into_iter().rev() {
                self.take_back(deed);
            }
            self.touched.truncate(touched);
            self.changed.truncate(changed);
        }
        done
    }

    fn take_back(&mut self, deed: Deed) {
        match deed {
            Deed::AddedNode => self.pop_node(),
            Deed::Added => {
                self.unlink(self.edges.len() as u32 - 1);
                self.edges.pop();
                self.pieces.pop();
            }
            Deed::Removed(edge) => {
                self.edges[edge as usize].alive = true;
                self.link(edge);
            }
            Deed::Shifted {
                node,
                from,
                stations,
            } => {
                self.place(node, from);
                self.set_stations(&stations);
            }
            Deed::Woken(node) => self.set_stand(node, Stand::Settled),
        }
    }

    pub(super) fn did(&mut self, deed: Deed) {
        if let Some(deeds) = &mut self.deeds {
            deeds.push(deed);
        }
    }
}
