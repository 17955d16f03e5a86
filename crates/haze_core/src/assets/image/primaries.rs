//! Primaries of linear color spaces, and the matrices between them.

use glam::{DMat3, DVec2, DVec3};

/// xy chromaticities of white, red, green and blue.
pub type Primaries = [[f64; 2]; 4];

/// White of sRGB and Rec.709.
pub const D65: [f64; 2] = [0.3127, 0.329];
/// White of ACES.
pub const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];
/// Primaries of sRGB and Rec.709.
pub const SRGB: Primaries = [D65, [0.64, 0.33], [0.3, 0.6], [0.15, 0.06]];
/// Primaries of Display P3.
pub const DISPLAY_P3: Primaries = [D65, [0.68, 0.32], [0.265, 0.69], [0.15, 0.06]];
/// Primaries of Rec.2020.
pub const BT2020: Primaries = [D65, [0.708, 0.292], [0.17, 0.797], [0.131, 0.046]];

/// Cone responses in which whites are adapted. (Bradford; Lam 1985)
const BRADFORD: DMat3 = DMat3::from_cols_array(&[
    0.8951, -0.7502, 0.0389, //
    0.2664, 1.7135, -0.0685, //
    -0.1614, 0.0367, 1.0296,
]);

/// True if two positions differ by more than the rounding of files.
pub(super) fn differs(a: &[f64; 2], b: &[f64; 2]) -> bool {
    (DVec2::from(*a) - DVec2::from(*b)).abs().max_element() > 0.002
}

/// True for those of sRGB, within the rounding of files.
pub fn is_srgb(primaries: &Primaries) -> bool {
    !primaries.iter().zip(&SRGB).any(|(a, b)| differs(a, b))
}

/// Returns the matrix from linear light of these primaries to linear sRGB, with the white adapted; `None` if they span no
/// colors.
pub fn srgb_from_linear_of(primaries: Primaries) -> Option<DMat3> {
    let [from, to] = [primaries, SRGB].map(|[white, ..]| BRADFORD * xyz(white));
    let adapted = BRADFORD.inverse() * DMat3::from_diagonal(to / from) * BRADFORD;
    let matrix = xyz_from_linear(SRGB).inverse() * adapted * xyz_from_linear(primaries);
    matrix.is_finite().then_some(matrix)
}

pub(super) fn xyz_from_linear([white, red, green, blue]: Primaries) -> DMat3 {
    // Not divided by y, which may be 0.
    let direction = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
    let columns = DMat3::from_cols(direction(red), direction(green), direction(blue));
    columns * DMat3::from_diagonal(columns.inverse() * xyz(white))
}

/// Color of this chromaticity with Y = 1.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aces_primaries_are_converted_as_in_the_published_matrix() {
        let acescg = [ACES_WHITE, [0.713, 0.293], [0.165, 0.83], [0.128, 0.044]];
        // AP1 to Rec.709 with Bradford, as in the ACES configurations of OpenColorIO.
        let published = DMat3::from_cols_array(&[
            1.705_05, -0.130_26, -0.024_00, //
            -0.621_79, 1.140_80, -0.128_97, //
            -0.083_26, -0.010_55, 1.152_97,
        ]);
        let matrix = srgb_from_linear_of(acescg).unwrap();
        assert!(matrix.abs_diff_eq(published, 2e-4), "{matrix}");
        assert!(srgb_from_linear_of(SRGB).unwrap().abs_diff_eq(DMat3::IDENTITY, 1e-9));
        // XYZ itself: equal energy becomes white.
        let xyz = [[1.0 / 3.0; 2], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        let white = srgb_from_linear_of(xyz).unwrap() * DVec3::ONE;
        assert!(white.abs_diff_eq(DVec3::ONE, 1e-9), "{white}");
        assert!(srgb_from_linear_of([D65; 4]).is_none() && srgb_from_linear_of([[f64::NAN; 2]; 4]).is_none());
    }
}
