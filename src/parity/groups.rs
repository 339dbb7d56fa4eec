//! Union-find.

/// Groups of numbers; each is named by its least member.
pub struct Groups(Vec<u32>);

impl Groups {
    /// `n` groups of one.
    pub fn new(n: usize) -> Groups {
        Groups((0..n as u32).collect())
    }

    /// The least member of the group of `id`.
    pub fn first(&mut self, mut id: u32) -> u32 {
        while self.0[id as usize] != id {
            self.0[id as usize] = self.0[self.0[id as usize] as usize];
            id = self.0[id as usize];
        }
        id
    }

    /// Makes one group of two; true if they were two.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}
