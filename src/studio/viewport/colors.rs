//! Colours of the viewport by theme. Linear RGB for the shader, sRGB for what is painted over it.

/// Linear RGB.
type Linear = [f32; 3];

/// The colours of a theme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colors {
    pub(super) sky_low: Linear,
    pub(super) sky_high: Linear,
    pub(super) tile_light: Linear,
    pub(super) tile_dark: Linear,
    pub(super) shadow: Linear,
    pub(super) ambient_low: Linear,
    pub(super) ambient_high: Linear,
    pub(super) lamp: Linear,
    pub(super) ghost: Linear,
    /// sRGB of lines over the picture.
    pub(super) ink: [u8; 3],
    /// sRGB of what surrounds such a line.
    pub(super) halo: [u8; 3],
}

impl Colors {
    /// Of the light theme or the dark one.
    pub(super) fn of(dark: bool) -> Colors {
        if dark {
            Colors {
                sky_low: [0.022, 0.025, 0.030],
                sky_high: [0.009, 0.011, 0.015],
                tile_light: [0.062, 0.067, 0.074],
                tile_dark: [0.044, 0.048, 0.054],
                shadow: [0.002, 0.0025, 0.004],
                ambient_low: [0.11, 0.11, 0.12],
                ambient_high: [0.30, 0.33, 0.38],
                lamp: [0.86, 0.83, 0.78],
                ghost: [0.30, 0.52, 0.86],
                ink: [226, 230, 236],
                halo: [14, 16, 20],
            }
        } else {
            Colors {
                sky_low: [0.80, 0.84, 0.87],
                sky_high: [0.60, 0.68, 0.76],
                tile_light: [0.60, 0.63, 0.65],
                tile_dark: [0.50, 0.535, 0.56],
                shadow: [0.05, 0.065, 0.09],
                ambient_low: [0.24, 0.23, 0.22],
                ambient_high: [0.50, 0.55, 0.62],
                lamp: [0.80, 0.76, 0.70],
                ghost: [0.16, 0.34, 0.70],
                ink: [20, 22, 26],
                halo: [255, 255, 255],
            }
        }
    }

    /// In the order of the shader's `Scene`.
    pub(super) fn scene(&self) -> [Linear; 8] {
        [
            self.sky_low,
            self.sky_high,
            self.tile_light,
            self.tile_dark,
            self.shadow,
            self.ambient_low,
            self.ambient_high,
            self.lamp,
        ]
    }
}
