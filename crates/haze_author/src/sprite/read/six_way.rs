//! Sides that the channels of two light maps hold.
//!
//! Smoke is brighter on the side that the light comes from. The outline gives a rough shape, a dome: its normals tell
//! right, left, top and bottom. Light from the front is brightest where the smoke is thick and faces the viewer, light
//! from the back where it is thin.

use std::str::FromStr;

use glam::{IVec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::formula::six_way::SixWay;

use super::super::height::{dome_heights, map_pixels, normal_of};
use super::answer::Answer;
use super::file_name::NamedSides;
use super::side::Side;
use super::small_frames::SmallFrames;

/// Sides in red, green and blue of the first light map, and of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SideOrder([Side; 6]);

impl SideOrder {
    /// Returns the order if every side is there once.
    pub fn new(sides: [Side; 6]) -> Option<Self> {
        Side::ALL.iter().all(|side| sides.contains(side)).then_some(Self(sides))
    }

    /// Returns all 720 orders.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..720_usize).map(|number| {
            let mut left = Side::ALL.to_vec();
            let mut rest = number;
            Self(std::array::from_fn(|index| {
                let count = 6 - index;
                let side = left.remove(rest % count);
                rest /= count;
                side
            }))
        })
    }

    /// Sides of the channels.
    pub fn sides(self) -> [Side; 6] {
        self.0
    }

    /// Names of the sides: `right, left, top, bottom, back, front`.
    pub fn name(self) -> String {
        self.0.map(Side::name).join(", ")
    }

    /// Assigns the light of two texels to its sides.
    pub fn six_way(self, first: Vec3, second: Vec3) -> SixWay {
        let mut light = SixWay::default();
        for (side, value) in self.0.into_iter().zip(first.to_array().into_iter().chain(second.to_array())) {
            match side {
                Side::Right => light.positive.x = value,
                Side::Top => light.positive.y = value,
                Side::Front => light.positive.z = value,
                Side::Left => light.negative.x = value,
                Side::Bottom => light.negative.y = value,
                Side::Back => light.negative.z = value,
            }
        }
        light
    }

    /// Arranges light in the order of the channels.
    pub fn texels(self, SixWay { positive, negative }: SixWay) -> [Vec3; 2] {
        let [a, b, c, d, e, f] = self.0.map(|side| match side {
            Side::Right => positive.x,
            Side::Top => positive.y,
            Side::Front => positive.z,
            Side::Left => negative.x,
            Side::Bottom => negative.y,
            Side::Back => negative.z,
        });
        [Vec3::new(a, b, c), Vec3::new(d, e, f)]
    }
}

impl FromStr for SideOrder {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            let sides = Side::NAMES.join(",");
            format!(
                "{text:?} is no order; expected each of {sides} once, in the order of red, green, blue of both maps"
            )
        };
        let sides: Option<Vec<Side>> = text.split(',').map(|name| name.trim().parse().ok()).collect();
        let sides: Option<[Side; 6]> = sides.and_then(|sides| sides.try_into().ok());
        sides.and_then(Self::new).ok_or_else(expected)
    }
}

/// Frames that are examined.
const MAX_EXAMINED: usize = 12;
/// Smallest amount of a texel that is examined.
const MIN_AMOUNT: f32 = 0.1;
/// Gain of an order whose sides are those in the names of the files.
const NAMED: f32 = 0.25;

/// Light maps, reduced, with straight light in red, green and blue; and the amount in alpha.
pub(super) struct SmallLight<'a> {
    pub first: &'a SmallFrames,
    pub second: &'a SmallFrames,
    pub amount: &'a SmallFrames,
}

/// Finds the side of every channel: of all 720 orders, the one in which sides lean to their lights most.
pub(super) fn find_sides(light: &SmallLight<'_>, named: [Option<NamedSides>; 2]) -> Answer<SideOrder> {
    let leans = leans(light);
    let named: Vec<_> = named.into_iter().flat_map(|sides| sides.map_or_else(|| vec![vec![]; 3], Vec::from)).collect();
    let score = |order: SideOrder| {
        let of_channel = |(channel, side): (usize, Side)| {
            let lean = leans[channel];
            let is_named = named.get(channel).is_some_and(|sides| sides.contains(&side));
            let of_name = if is_named { NAMED } else { 0.0 };
            of_name
                + match side {
                    Side::Right => lean.x,
                    Side::Left => -lean.x,
                    Side::Top => lean.y,
                    Side::Bottom => -lean.y,
                    Side::Front => lean.z,
                    Side::Back => -lean.z,
                }
        };
        order.sides().into_iter().enumerate().map(of_channel).sum::<f32>()
    };
    let mut best: Option<(SideOrder, f32)> = None;
    let mut second = 0.0_f32;
    for order in SideOrder::all() {
        let score = score(order);
        match best {
            Some((_, most)) if score <= most => second = second.max(score),
            _ => {
                second = best.map_or(0.0, |(_, most)| most);
                best = Some((order, score));
            }
        }
    }
    let Some((order, most)) = best else { return Answer::found(SideOrder(Side::ALL_SIX), 0.0) };
    // Two sides that are swapped change the sum by twice the difference of their leans.
    Answer::found(order, (most - second) / 0.5)
}

impl Side {
    const ALL_SIX: [Self; 6] = [Self::Right, Self::Left, Self::Top, Self::Bottom, Self::Back, Self::Front];
}

/// Correlation of the light of each channel with the normals of a dome over the outline: x, y up, z. Light is relative to
/// the mean of all channels, which leaves the side.
fn leans(light: &SmallLight<'_>) -> [Vec3; 6] {
    let mut sums = [LeanSums::default(); 6];
    let count = light.amount.frames.len();
    for index in (0..count).step_by(count.div_ceil(MAX_EXAMINED).max(1)) {
        let amount = &light.amount.frames[index];
        let amounts = map_pixels(amount.size, |at| amount.load(at.as_ivec2()).w);
        let heights = dome_heights(&amounts);
        let [first, second] = [light.first, light.second].map(|frames| &frames.frames[index]);
        let channels = |at: IVec2| {
            let [a, b] = [first, second].map(|image: &Image<_>| image.load(at).truncate());
            [a.x, a.y, a.z, b.x, b.y, b.z]
        };
        // Mean light of every channel in this frame: sides differ in brightness.
        let mut means = [0.0; 6];
        let mut total = 0.0;
        let texels = || {
            let width = amount.size.x;
            (0..amount.size.element_product())
                .map(move |index| IVec2::new((index % width) as i32, (index / width) as i32))
        };
        for at in texels() {
            let weight = amounts.load(at);
            if weight >= MIN_AMOUNT {
                channels(at).into_iter().zip(&mut means).for_each(|(value, mean)| *mean += value * weight);
                total += weight;
            }
        }
        means.iter_mut().for_each(|mean| *mean = (*mean / f32::max(total, 1.0e-6)).max(1.0e-3));
        for at in texels() {
            let weight = amounts.load(at);
            if weight >= MIN_AMOUNT {
                let relative: [f32; 6] = std::array::from_fn(|channel| channels(at)[channel] / means[channel]);
                let middle = relative.iter().sum::<f32>() / 6.0;
                let normal = normal_of(&heights, at, 1.0).normalize_or(Vec3::Z);
                for (sums, relative) in sums.iter_mut().zip(relative) {
                    sums.add(normal, relative - middle, weight);
                }
            }
        }
    }
    sums.map(LeanSums::correlation)
}

/// Weighted sums for correlations.
#[derive(Clone, Copy, Default)]
struct LeanSums {
    weight: f64,
    value: f64,
    square: f64,
    normal: glam::DVec3,
    normal_square: glam::DVec3,
    product: glam::DVec3,
}

impl LeanSums {
    fn add(&mut self, normal: Vec3, value: f32, weight: f32) {
        let normal = normal.as_dvec3();
        let value = f64::from(value);
        let weight = f64::from(weight);
        self.weight += weight;
        self.value += value * weight;
        self.square += value * value * weight;
        self.normal += normal * weight;
        self.normal_square += normal * normal * weight;
        self.product += normal * value * weight;
    }

    fn correlation(self) -> Vec3 {
        let weight = self.weight.max(1.0e-9);
        let mean = self.value / weight;
        let normal = self.normal / weight;
        let covariance = self.product / weight - normal * mean;
        let spread = (self.square / weight - mean * mean).max(0.0);
        let spreads = (self.normal_square / weight - normal * normal).max(glam::DVec3::ZERO);
        let scale = (spreads * spread).to_array().map(|product| product.sqrt().max(1.0e-9));
        (covariance / glam::DVec3::from(scale)).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_a_name_that_is_read_back() {
        let mut names: Vec<_> = SideOrder::all().map(SideOrder::name).collect();
        assert!(SideOrder::all().all(|order| order.name().parse() == Ok(order)));
        names.sort();
        names.dedup();
        assert_eq!(names.len(), 720);
        let light = SixWay { positive: Vec3::new(1.0, 2.0, 3.0), negative: Vec3::new(4.0, 5.0, 6.0) };
        for order in SideOrder::all() {
            let [first, second] = order.texels(light);
            assert_eq!(order.six_way(first, second), light);
        }
        for bad in ["right,left,top,bottom,back", "right,left,top,bottom,back,back", "up,left,top,bottom,back,front"] {
            assert!(bad.parse::<SideOrder>().unwrap_err().contains("expected each of right,left,"), "{bad}");
        }
    }
}
