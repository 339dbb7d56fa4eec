//! Sorting of what belongs to nodes: linear, as each node has only a few.

/// Sorts `items`, whose order begins with the number of their node, below `nodes`.
pub(crate) fn sorted_by_node<T: Copy + Ord>(
    items: &[T],
    nodes: usize,
    node: impl Fn(&T) -> usize,
) -> Vec<T> {
    let mut end = vec![0_u32; nodes];
    for item in items {
        end[node(item)] += 1;
    }
    let mut sum = 0;
    for count in &mut end {
        // The start of the bucket until it is filled.
        sum += std::mem::replace(count, sum);
    }
    let mut sorted = items.to_vec();
    for &item in items {
        let place = &mut end[node(&item)];
        sorted[*place as usize] = item;
        *place += 1;
    }
    let mut start = 0;
    for end in end {
        sorted[start as usize..end as usize].sort_unstable();
        start = end;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn order_is_that_of_a_plain_sort(
            items in prop::collection::vec((0_usize..9, 0_u32..50), 0..100),
        ) {
            let mut plain = items.clone();
            plain.sort_unstable();
            prop_assert_eq!(sorted_by_node(&items, 9, |item| item.0), plain);
        }
    }
}
