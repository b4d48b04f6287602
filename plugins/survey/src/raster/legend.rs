use veduta_city::StreetClass;

/// What a colour on a map stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapClass {
    /// A street, of a class where the colour tells it.
    Street(Option<StreetClass>),
    /// A square.
    Square,
    /// Houses.
    Built,
    /// Green.
    Park,
    /// Water.
    Water,
    /// Rails.
    Railway,
    /// Names and symbols printed over the rest.
    Label,
}

/// What the colours of a map stand for.
#[derive(Debug, Clone, Default)]
pub struct Legend {
    /// Size of a pixel.
    pub metres_per_pixel: Option<f64>,
    /// The colours.
    pub colours: Vec<LegendColour>,
}

/// A colour of a map.
#[derive(Debug, Clone, Copy)]
pub struct LegendColour {
    /// What it stands for.
    pub class: MapClass,
    /// Red, green, blue.
    pub colour: [u8; 3],
}
