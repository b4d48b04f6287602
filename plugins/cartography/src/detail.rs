use glam::DVec2;
use veduta_city::{CityPlan, ObjectKind, metres, ring_edges};

/// What of a plan maps on paper show beyond its overview.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detail {
    /// Trees: plan metres, and how far their crowns reach, metres.
    pub trees: Vec<(DVec2, f64)>,
    /// Lines along which covered walks open to the street, plan metres.
    pub arcades: Vec<Vec<DVec2>>,
}

/// Crowns reach so far, as a share of a tree's height.
const CROWN: f64 = 0.28;

impl Detail {
    /// Of a plan.
    #[must_use]
    pub fn of(plan: &CityPlan) -> Self {
        use ObjectKind::{Birch, Conifer, FruitTree, Palm, Poplar, Tree, Willow};
        let is_tree = |kind| matches!(kind, Tree | Conifer | Poplar | Birch | Willow | FruitTree | Palm);
        let trees = plan.objects.iter().filter(|object| is_tree(object.kind));
        let slender = |kind| if matches!(kind, Poplar | Conifer) { 0.5 } else { 1.0 };
        let trees = trees.map(|tree| (tree.pos.to_metres(), metres(tree.height) * CROWN * slender(tree.kind)));
        let mut arcades = Vec::new();
        for volume in plan.houses.iter().flat_map(|house| &house.volumes) {
            let edges: Vec<_> = volume.footprint.rings().flat_map(|ring| ring_edges(ring)).collect();
            for arcade in &volume.arcades {
                let Some(&(a, b)) = edges.get(usize::from(arcade.wall)) else { continue };
                let (a, b) = (a.to_metres(), b.to_metres());
                let along = (b - a).normalize_or_zero();
                let (from, to) = (metres(arcade.span.0), metres(arcade.span.1));
                arcades.push(vec![a + along * from, a + along * to]);
            }
        }
        Self { trees: trees.collect(), arcades }
    }
}
