//! Sub-domains with three to six sides whose counts fit: one pattern for the whole.

use crate::meshing::contour::Contour;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::patterns;
use crate::meshing::sheet::Sheet;
use crate::meshing::visits::Visits;

/// A pattern may have this many times the quads that the size asks for: a grid carries a fine
/// side right across, which a splitting line would not.
const WASTE: f64 = 3.0;

/// The best pattern over the one walk, with positive corner Jacobians; `None` if there are several
/// walks, if it has no few clear sides, or if their counts fit no pattern.
pub(crate) fn mesh(visits: &Visits, loops: &Loops) -> Option<Draft> {
    if visits.walk_start.len() != 2 {
        return None;
    }
    let mut sheet = Sheet::over(visits);
    let contour = Contour::of(&sheet, (0..visits.len() as u32).collect());
    patterns::lay(&mut sheet, &contour)?;
    // Along the walk the quads are as wide as its edges, whatever the size.
    let wished = contour.area_m2() / (loops.size_m * loops.size_m) + visits.len() as f64;
    let many = sheet.quads.len() as f64 > WASTE * wished;
    (!many).then(|| sheet.into_draft(visits.len(), Method::Mapping))
}
