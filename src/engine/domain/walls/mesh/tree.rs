//! A tree of boxes over the facets of a mesh, by which those near a point are found.

use nalgebra::Vector3;

/// Largest number of facets in a leaf.
const LEAF: usize = 4;

/// A binary tree of boxes that hold facets. It is a function of the facets alone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    /// The root comes first, and the left child of a node directly after it.
    nodes: Vec<Node>,
    /// The numbers of the facets, those of a leaf side by side.
    facets: Vec<u32>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    lower: Vector3<f64>,
    upper: Vector3<f64>,
    content: Content,
}

#[derive(Clone, Debug, PartialEq)]
enum Content {
    /// The place of the right child.
    Branch(u32),
    /// A range of the list of facets.
    Leaf(u32, u32),
}

/// The box of a facet.
type Extent = [Vector3<f64>; 2];

impl Tree {
    /// The tree of facets with these corners.
    pub(super) fn of(corners: impl Iterator<Item = [Vector3<f64>; 3]>) -> Self {
        let extents: Vec<Extent> =
            corners.map(|[a, b, c]| [a.inf(&b).inf(&c), a.sup(&b).sup(&c)]).collect();
        let mut facets: Vec<u32> = (0..extents.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * extents.len());
        add_node(&mut nodes, &mut facets, 0, &extents);
        Self { nodes, facets }
    }

    /// The lowest and the highest coordinates.
    pub(super) fn extent(&self) -> Extent {
        [self.nodes[0].lower, self.nodes[0].upper]
    }

    /// All facets whose boxes are nearer to a point than this distance.
    pub(super) fn facets_near(
        &self,
        point: &Vector3<f64>,
        distance: f64,
    ) -> impl Iterator<Item = u32> {
        let mut open = vec![0];
        let next_leaf = move || {
            while let Some(place) = open.pop() {
                let node = &self.nodes[place as usize];
                if node.squared_distance(point) <= distance * distance {
                    match node.content {
                        Content::Branch(right) => open.extend([right, place + 1]),
                        Content::Leaf(first, end) => return Some(first as usize..end as usize),
                    }
                }
            }
            None
        };
        std::iter::from_fn(next_leaf).flat_map(|leaf| &self.facets[leaf]).copied()
    }

    /// The facet of least distance from a point, and of the lowest number among several.
    pub(super) fn nearest(&self, point: &Vector3<f64>, distance: impl Fn(u32) -> f64) -> u32 {
        let (mut nearest, mut found) = (f64::INFINITY, 0);
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let node = &self.nodes[place as usize];
            // The distance of a box is rounded: a facet may seem nearer than its box.
            if node.squared_distance(point) > nearest * nearest * (1.0 + ROUNDING) {
                continue;
            }
            match node.content {
                Content::Branch(right) => {
                    let left = place + 1;
                    let [of_left, of_right] = [left, right]
                        .map(|child| self.nodes[child as usize].squared_distance(point));
                    open.extend(if of_left <= of_right { [right, left] } else { [left, right] });
                }
                Content::Leaf(first, end) => {
                    for &facet in &self.facets[first as usize..end as usize] {
                        let here = distance(facet);
                        if here < nearest || (here == nearest && facet < found) {
                            (nearest, found) = (here, facet);
                        }
                    }
                }
            }
        }
        found
    }
}

/// Rounding of some ten operations.
const ROUNDING: f64 = 1.0e-14;

impl Node {
    /// Squared distance of a point from the box; zero inside.
    fn squared_distance(&self, point: &Vector3<f64>) -> f64 {
        let beyond = (self.lower - point).sup(&(point - self.upper)).sup(&Vector3::zeros());
        beyond.norm_squared()
    }
}

/// Adds the node of some facets and all below it. `first` is the place of these facets in the list of all.
fn add_node(nodes: &mut Vec<Node>, facets: &mut [u32], first: u32, extents: &[Extent]) {
    let of = |facet: &u32| extents[*facet as usize];
    let all = facets.iter().map(of).reduce(|[a, b], [c, d]| [a.inf(&c), b.sup(&d)]);
    let [lower, upper] = all.unwrap_or_default();
    let place = nodes.len();
    let end = first + facets.len() as u32;
    nodes.push(Node { lower, upper, content: Content::Leaf(first, end) });
    if facets.len() <= LEAF {
        return;
    }
    let axis = (upper - lower).imax();
    let middle = |facet: &u32| of(facet)[0][axis] + of(facet)[1][axis];
    let half = facets.len() / 2;
    facets.select_nth_unstable_by(half, |one, other| {
        middle(one).total_cmp(&middle(other)).then(one.cmp(other))
    });
    let (left, right) = facets.split_at_mut(half);
    add_node(nodes, left, first, extents);
    nodes[place].content = Content::Branch(nodes.len() as u32);
    add_node(nodes, right, first + half as u32, extents);
}
