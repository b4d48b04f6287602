use glam::{DMat2, DVec2};

/// The way from pixels to a plane: `origin + column * x + row * y`. Pixels are counted from the picture's upper left corner,
/// at their edges: (0, 0) is the corner itself, (0.5, 0.5) the middle of the first pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine {
    /// The plane's position of the upper left corner.
    pub origin: DVec2,
    /// From a column to the next, and from a row to the next below it.
    pub step: DMat2,
}

impl Affine {
    /// From the middle of the first pixel.
    pub(crate) fn of_first_middle(middle: DVec2, column: DVec2, row: DVec2) -> Self {
        Self { origin: middle - 0.5 * (column + row), step: DMat2::from_cols(column, row) }
    }

    pub(crate) fn pos(&self, pixel: DVec2) -> DVec2 {
        self.origin + self.step * pixel
    }

    /// The pixel position of a position of the plane. Check [`Self::is_sound`] first.
    pub(crate) fn pixel(&self, pos: DVec2) -> DVec2 {
        self.step.inverse() * (pos - self.origin)
    }

    /// Whether there is a way back.
    pub(crate) fn is_sound(&self) -> bool {
        let area = self.step.determinant();
        let sides = self.step.x_axis.length() * self.step.y_axis.length();
        self.origin.is_finite() && area.is_finite() && sides > 0.0 && sides.is_finite() && area.abs() > 1e-6 * sides
    }
}
