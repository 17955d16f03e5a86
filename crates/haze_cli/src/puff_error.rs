//! Prints the errors of ramps and six-way maps against path-traced smoke.

use haze_author::ramp::response::{DiffuseRamps, LIGHTS, Puff, Response, light_angle};
use haze_core::error::Error;

use haze_bench::flip::flips;
use haze_export::output::print_line;
use haze_export::puff_sheet::{ComparedImages, image_pairs};

/// Prints how far ramps are from path-traced smoke, in total and light by light.
pub fn print_ramp_error(name: &str, puff: &Puff, ramps: DiffuseRamps<'_>) -> Result<(), Error> {
    let response = puff.response(ramps);
    let shown = ComparedImages { light: &|light| puff.shown(ramps, light), exposure: response.exposure };
    print_response_error(name, puff, &shown, &response)
}

/// Prints how far compared images are from path-traced smoke, in total and light by light.
pub fn print_response_error(
    name: &str,
    puff: &Puff,
    shown: &ComparedImages<'_>,
    response: &Response,
) -> Result<(), Error> {
    let percent = |fraction: f32| 100.0 * fraction;
    print_line!(
        "{name}: brightness {:.1} % off on average, pixels {:.0} % off, FLIP {:.3}, at intensity {:.2}",
        percent(response.error),
        percent(response.pixel_error),
        mean_flip(puff, shown),
        response.exposure,
    )?;
    for (index, light) in response.lights.iter().enumerate() {
        let off = percent(light.shown / light.truth.max(f32::MIN_POSITIVE) - 1.0);
        print_line!("{:7.1}°  traced {:.4}  shown {:.4}  {off:+.0} %", light_angle(index), light.truth, light.shown)?;
    }
    Ok(())
}

/// Mean FLIP over all lights.
fn mean_flip(puff: &Puff, shown: &ComparedImages<'_>) -> f64 {
    let pairs = image_pairs(puff, shown);
    let pairs: Vec<_> = pairs.iter().map(|[truth, ours]| [truth, ours]).collect();
    flips(&pairs).iter().sum::<f64>() / f64::from(LIGHTS)
}
