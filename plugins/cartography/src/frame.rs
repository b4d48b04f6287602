use glam::DVec2;

/// A rectangle on a drawing, in its units: y downwards.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Area {
    /// Its corner at the top left.
    pub min: DVec2,
    /// Its corner at the bottom right.
    pub max: DVec2,
}

impl Area {
    /// One with a corner at the top left and a size.
    #[must_use]
    pub fn new(min: DVec2, size: DVec2) -> Self {
        Self { min, max: min + size }
    }

    /// Its middle.
    #[must_use]
    pub fn middle(&self) -> DVec2 {
        (self.min + self.max) / 2.0
    }

    /// Its width and height.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    /// Whether a position lies in it.
    #[must_use]
    pub fn contains(&self, p: DVec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// The same, so much larger on each side.
    #[must_use]
    pub fn grown(&self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }
}

/// How plan metres lie on a drawing: turned, scaled and moved. The drawing's unit is a millimetre on paper, a point on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Plan position that lies in the middle.
    pub middle: DVec2,
    /// Where that is on the drawing.
    pub at: DVec2,
    /// Units a metre.
    pub scale: f64,
    /// Heading that points up, degrees clockwise from north.
    pub up_deg: f64,
    turn: DVec2,
}

impl Frame {
    /// Plan metres about a middle, at a place of the drawing.
    #[must_use]
    pub fn new(middle: DVec2, at: DVec2, scale: f64, up_deg: f64) -> Self {
        let up = up_deg.to_radians();
        Self { middle, at, scale, up_deg, turn: DVec2::new(libm::cos(up), libm::sin(up)) }
    }

    /// Where a plan position lies on the drawing.
    #[must_use]
    pub fn project(&self, plan_pos: DVec2) -> DVec2 {
        self.at + self.project_offset(plan_pos - self.middle)
    }

    /// Where an offset in plan leads on the drawing.
    #[must_use]
    pub fn project_offset(&self, d: DVec2) -> DVec2 {
        let DVec2 { x: cos, y: sin } = self.turn;
        DVec2::new(d.x * cos - d.y * sin, -(d.x * sin + d.y * cos)) * self.scale
    }

    /// The plan position that lies at a place of the drawing.
    #[must_use]
    pub fn plan(&self, at: DVec2) -> DVec2 {
        let d = (at - self.at) / self.scale;
        let DVec2 { x: cos, y: sin } = self.turn;
        self.middle + DVec2::new(d.x * cos - d.y * sin, -d.x * sin - d.y * cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ahead_is_up_when_the_heading_is() {
        let east_up = Frame::new(DVec2::ZERO, DVec2::splat(100.0), 1.0, 90.0);
        assert!(east_up.project(DVec2::new(50.0, 0.0)).distance(DVec2::new(100.0, 50.0)) < 1e-9);
        let north_up = Frame::new(DVec2::ZERO, DVec2::splat(100.0), 1.0, 0.0);
        assert!(north_up.project(DVec2::new(50.0, 0.0)).distance(DVec2::new(150.0, 100.0)) < 1e-9);
    }

    #[test]
    fn a_place_on_the_drawing_is_found_again_in_plan() {
        let frame = Frame::new(DVec2::new(-300.0, 40.0), DVec2::new(7.0, 9.0), 0.4, 137.0);
        for plan in [DVec2::new(-290.0, 60.0), DVec2::new(-400.0, -20.0)] {
            assert!(frame.plan(frame.project(plan)).distance(plan) < 1e-9);
        }
    }
}
