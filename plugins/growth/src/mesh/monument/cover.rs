use glam::{DVec2, DVec3};
use veduta_city::monument::PathPoint;
use veduta_city::{Gable, GridPolygon, GridPos, PlanRoof, Rgb, RoofShape, VolumeShell};

use super::Mason;
use super::path::line;
use crate::mesh::data::{MeshData, Paint};
use crate::mesh::outline::{area, wall_count, wall_edge};

impl Mason<'_> {
    /// A roof over an outline whose eaves lie at the origin's height.
    pub(super) fn cover(
        &mut self,
        outline: &[PathPoint<i32>],
        shape: RoofShape,
        height: i32,
        direction: i32,
        infill: Option<Paint>,
    ) {
        let mut ring = line(outline, true, self.detail.within_m);
        if ring.len() < 3 || area(&ring).abs() < 1e-6 {
            return;
        }
        if area(&ring) < 0.0 {
            ring.reverse();
        }
        let footprint = GridPolygon::simple(ring.iter().map(|&p| GridPos::from_metres(p)).collect());
        let direction = ((direction + 50).rem_euclid(36_000) / 100) as u16;
        let roof = PlanRoof { shape, height: height.max(0), direction, colour: Rgb::default() };
        let volume = VolumeShell {
            footprint,
            bottom: 0,
            eaves: 0,
            colour: Rgb::default(),
            trim: Rgb::default(),
            roof,
            gable: Gable::Plain,
            has_roof: true,
            walls: Vec::new(),
            arcades: Vec::new(),
        };
        let mut covering = MeshData::default();
        let mut roofer = core::mem::take(&mut self.roofer);
        let form = roofer.start(&volume);
        if let Some(form) = &form {
            roofer.cover(form, &mut covering);
        }
        // Made in the engine's axes.
        let local = |p: [f32; 3]| DVec3::new(f64::from(p[0]), -f64::from(p[2]), f64::from(p[1]));
        for t in covering.indices.chunks_exact(3) {
            self.face(&[t[0], t[1], t[2]].map(|i| local(covering.positions[i as usize])));
        }
        if let (Some(form), Some(infill)) = (form, infill) {
            let mut along = Vec::new();
            for wall in 0..wall_count(&volume.footprint) {
                form.along_wall(wall, &mut along);
                let Some(edge) = wall_edge(&volume.footprint, wall) else { continue };
                let at = |p: DVec2, up: f64| p.extend(up);
                for pair in along.windows(2).filter(|pair| pair[0].1.max(pair[1].1) > 1e-6) {
                    let (a, b) = (edge.at(pair[0].0), edge.at(pair[1].0));
                    self.face_of(&[at(a, 0.0), at(b, 0.0), at(b, pair[1].1), at(a, pair[0].1)], infill);
                }
            }
        }
        self.roofer = roofer;
    }
}
