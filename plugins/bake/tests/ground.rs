//! Nothing of the ground is lost on the way from plan to packets.

use std::path::PathBuf;

use veduta_bake::{BakeSettings, Input, cut, plan};
use veduta_cells::cell_shells;
use veduta_growth::mesh::ground;

/// Area of the upward triangles of a mesh, square metres.
fn meshed_m2(mesh: &veduta_growth::mesh::MeshData) -> f64 {
    mesh.indices
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize].map(f64::from));
            let (u, v) = ([b[0] - a[0], b[2] - a[2]], [c[0] - a[0], c[2] - a[2]]);
            (u[1] * v[0] - u[0] * v[1]) / 2.0
        })
        .filter(|area| *area > 0.0)
        .sum()
}

#[test]
fn every_square_metre_of_the_sample_city_is_in_a_cell_and_in_a_mesh() {
    let scene = PathBuf::from("../../scenes/old_prague");
    let input = Input::of(&scene).unwrap_or_else(|e| panic!("{e}"));
    let settings = BakeSettings::default();
    let plan = plan(&input, &settings, &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
    let (cells, _) = cut(&plan, &[], &settings);
    let shells = cell_shells(&plan, &cells);
    let (mut told, mut meshed) = (0.0, 0.0);
    for (i, shell) in shells.iter().enumerate() {
        let area: f64 = shell.ground.iter().map(|p| p.outline.area_m2()).sum();
        let mesh = meshed_m2(&ground(shell));
        assert!((area - mesh).abs() <= 0.02 * area + 0.5, "cell {i}: {area:.1} m² of ground, {mesh:.1} m² of mesh");
        told += area;
        meshed += mesh;
    }
    let whole: f64 = plan.ground.iter().map(|p| p.outline.area_m2()).sum();
    let built: f64 = plan.houses.iter().flat_map(|h| &h.volumes).map(|v| v.footprint.area_m2()).sum();
    assert!(told >= whole - built - 0.01 * whole, "{told:.0} m² told of {whole:.0} m² less {built:.0} m² of houses");
    assert!(meshed > 0.98 * told);
}
