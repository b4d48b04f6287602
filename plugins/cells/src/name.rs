//! Names of cells: of their square or street.

use rstar::PointDistance;
use rstar::{
    AABB, RTree,
    primitives::{GeomWithData, Line, Rectangle},
};
use veduta_city::{Cells, CityPlan, GRID_PER_METRE, Place, PlaceKind};

use crate::patches::corner;

/// How far beyond a street's own width its name still reaches, metres.
const REACH_M: f64 = 15.0;

/// Names each cell after the nearest square whose radius holds its centroid, else after the street whose line, taken with its
/// width, is nearest to the centroid; leaves it empty where there is neither.
pub(crate) fn name_cells(plan: &CityPlan, cells: &mut Cells) {
    let step = f64::from(GRID_PER_METRE);
    let named: Vec<_> = plan.streets.iter().filter(|street| !street.name.is_empty() && street.layer >= 0).collect();
    let lines = named.iter().enumerate().flat_map(|(i, street)| {
        street.line.windows(2).map(move |pair| GeomWithData::new(Line::new(corner(pair[0]), corner(pair[1])), i))
    });
    let lines = RTree::bulk_load(lines.collect());
    let widest = named.iter().map(|street| f64::from(street.width.max(0))).fold(0.0, f64::max);
    let square = |(i, Place { kind, pos, radius_m, .. }): (usize, &Place)| {
        let (lo, hi) = (*pos - *radius_m, *pos + *radius_m);
        let is_square = *kind == PlaceKind::Square && lo.is_finite() && hi.is_finite();
        is_square.then(|| GeomWithData::new(Rectangle::from_corners(lo.to_array(), hi.to_array()), i))
    };
    let squares = RTree::bulk_load(plan.places.iter().enumerate().filter_map(square).collect());
    for cell in &mut cells.cells {
        let centroid = cell.outline.centroid();
        let square = squares
            .locate_all_at_point(&centroid.to_array())
            .map(|square| (plan.places[square.data].pos.distance_squared(centroid), square.data))
            .filter(|&(distance, i)| distance <= plan.places[i].radius_m * plan.places[i].radius_m)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((_, i)) = square {
            cell.name.clone_from(&plan.places[i].name);
            continue;
        }
        let [x, y] = [centroid.x * step, centroid.y * step];
        let reach = REACH_M * step + widest / 2.0;
        let around = AABB::from_corners([x - reach, y - reach], [x + reach, y + reach]);
        let street = lines
            .locate_in_envelope_intersecting(&around)
            .map(|line| (libm::sqrt(line.distance_2(&[x, y])) - f64::from(named[line.data].width) / 2.0, line.data))
            .filter(|&(distance, _)| distance <= REACH_M * step)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((_, i)) = street {
            cell.name.clone_from(&named[i].name);
        }
    }
}
