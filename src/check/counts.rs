//! Promise `counts`: the sums of the index.

use crate::check::verdict::Promise;
use crate::chunk::reader::Mesh;

/// [`Mesh`] has compared each chunk with the index; here the index is compared with itself and the
/// frame.
pub(crate) fn check(mesh: &Mesh) -> Promise {
    let mut promise = Promise::new("counts");
    let index = mesh.index();
    let mut expect = |what: &str, said: u64, counted: u64| {
        if said != counted {
            promise.broken(None, || {
                format!("{what}: the index says {said}, not {counted}")
            });
        }
    };
    let patches = index.patch_subdomain.len();
    let (nodes, quads) = (index.patch_node_base, index.patch_quad_base);
    expect("first interior node", nodes[0], index.boundary_nodes);
    expect("first quad", quads[0], 0);
    expect("nodes", index.nodes, nodes[patches]);
    expect("quads", index.quads, quads[patches]);
    expect("patches", patches as u64, mesh.frame().subdomains() as u64);
    let mut times = vec![0_u64; mesh.frame().subdomains()];
    for &subdomain in index.patch_subdomain {
        times[subdomain as usize] += 1;
    }
    for (subdomain, &times) in times.iter().enumerate() {
        expect(&format!("patches of sub-domain {subdomain}"), times, 1);
    }
    promise.says(format!(
        "{} nodes, {} quads in {patches} sub-domains",
        index.nodes, index.quads
    ));
    promise
}
