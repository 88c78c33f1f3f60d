//! Where an angle lies among increasing nodes.

/// The nodes on both sides of x, and the place between them, 0 to 1; outside, the end.
pub(crate) fn interval(nodes: &[f64], x: f64) -> ([usize; 2], f64) {
    if nodes.len() < 2 {
        return ([0, 0], 0.0);
    }
    let k = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
    ([k, k + 1], ((x - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
}

/// The same where the nodes go round, in so many degrees.
pub(crate) fn around(nodes: &[f64], x: f64, turn: f64) -> ([usize; 2], f64) {
    let (count, above) = (nodes.len(), nodes.partition_point(|&node| node <= x));
    let (low, high) = ((above + count - 1) % count, above % count);
    let gap = (nodes[high] - nodes[low]).rem_euclid(turn);
    ([low, high], if gap == 0.0 { 0.0 } else { (x - nodes[low]).rem_euclid(turn) / gap })
}
