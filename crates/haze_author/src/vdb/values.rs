//! Values of nodes: their types, their compression, and inactive values that are left out.

use std::borrow::Cow;

use half::f16;

use super::blosc;
use crate::bytes::{Bytes, inflate};

/// Bits of a grid's compression.
pub const ZIP: u32 = 1;
pub const ACTIVE_MASK: u32 = 2;
pub const BLOSC: u32 = 4;

/// Forms of the inactive values of a node. In all but the last only active values are stored.
pub mod inactive_form {
    /// All inactive values are minus the background. Form 0: the background.
    pub const MINUS_BACKGROUND: u8 = 1;
    /// All are one value, which is stored.
    pub const ONE: u8 = 2;
    /// A mask selects the background, else its negative.
    pub const MASK: u8 = 3;
    /// A mask selects the background, else the stored value.
    pub const MASK_AND_ONE: u8 = 4;
    /// A mask selects the second of two stored values.
    pub const MASK_AND_TWO: u8 = 5;
    /// All values are stored.
    pub const ALL: u8 = 6;
}

/// Type of a number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    Half,
    Float,
    Double,
}

impl Number {
    pub fn bytes(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// Returns the number that the bytes hold; 0 for one that is not finite.
    fn decode(self, bytes: &[u8]) -> f32 {
        let number = match (self, bytes) {
            (Self::Half, &[a, b]) => f16::from_le_bytes([a, b]).to_f32(),
            (Self::Float, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (Self::Double, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
            _ => 0.0,
        };
        if number.is_finite() { number } else { 0.0 }
    }
}

/// Storage of the values of a grid, each of `N` numbers.
#[derive(Clone, Copy, Debug)]
pub struct ValueFormat<const N: usize> {
    /// Type of single values.
    pub number: Number,
    /// Type in arrays.
    pub in_arrays: Number,
    /// Bits of the compression.
    pub compression: u32,
    /// Value of voxels that are not stored.
    pub background: [f32; N],
}

/// True if a bit of a mask is set.
pub fn is_set(mask: &[u8], index: usize) -> bool {
    mask.get(index / 8).is_some_and(|byte| byte >> (index % 8) & 1 != 0)
}

impl<const N: usize> ValueFormat<N> {
    /// Reads a single value.
    pub fn value(&self, bytes: &mut Bytes<'_>) -> Result<[f32; N], String> {
        let raw = bytes.take(N * self.number.bytes())?;
        Ok(decode(self.number, raw))
    }

    /// Reads the values of a node with a mask of active ones, one for each bit.
    pub fn array(&self, bytes: &mut Bytes<'_>, active: &[u8]) -> Result<Vec<[f32; N]>, String> {
        let count = active.len() * 8;
        let form = bytes.u8()?;
        if form > inactive_form::ALL {
            return Err(format!("values of a node in form {form}; expected 0 to {}", inactive_form::ALL));
        }
        let mut inactive = [self.background; 2];
        match form {
            inactive_form::MINUS_BACKGROUND | inactive_form::MASK => inactive[0] = self.background.map(|value| -value),
            inactive_form::ONE | inactive_form::MASK_AND_ONE => inactive[0] = self.value(bytes)?,
            inactive_form::MASK_AND_TWO => inactive = [self.value(bytes)?, self.value(bytes)?],
            _ => {}
        }
        let has_mask = [inactive_form::MASK, inactive_form::MASK_AND_ONE, inactive_form::MASK_AND_TWO].contains(&form);
        let second = bytes.take(if has_mask { active.len() } else { 0 })?;
        let is_packed = self.compression & ACTIVE_MASK != 0 && form != inactive_form::ALL;
        let stored = if is_packed { active.iter().map(|byte| byte.count_ones() as usize).sum() } else { count };
        let bytes_per_value = N * self.in_arrays.bytes();
        // OpenVDB writes nothing for no values that it converts to half floats, and a size of 0 for others.
        let is_left_out = stored == 0 && self.in_arrays != self.number;
        let raw = if is_left_out { Cow::default() } else { self.data(bytes, stored * bytes_per_value)? };
        let mut stored = raw.chunks_exact(bytes_per_value).map(|raw| decode(self.in_arrays, raw));
        let value = |index| {
            if is_packed && !is_set(active, index) {
                return Some(inactive[usize::from(is_set(second, index))]);
            }
            stored.next()
        };
        Ok((0..count).map_while(value).collect())
    }

    /// Reads and decompresses `size` bytes.
    fn data<'a>(&self, bytes: &mut Bytes<'a>, size: usize) -> Result<Cow<'a, [u8]>, String> {
        if self.compression & (ZIP | BLOSC) == 0 {
            return bytes.take(size).map(Cow::from);
        }
        // A number below 0 is that of bytes that are not compressed.
        let stored = bytes.i64()?;
        let Some(stored) = usize::try_from(stored).ok().filter(|stored| *stored > 0) else {
            if stored.unsigned_abs() != size as u64 {
                return Err(format!("{} bytes of values; expected {size}", stored.unsigned_abs()));
            }
            return bytes.take(size).map(Cow::from);
        };
        let packed = bytes.take(stored)?;
        let is_blosc = self.compression & BLOSC != 0;
        let data = if is_blosc { blosc::decompress(packed, size) } else { inflate(packed, size) };
        data.map(Cow::from)
    }
}

fn decode<const N: usize>(number: Number, raw: &[u8]) -> [f32; N] {
    let mut value = [0.0; N];
    for (value, raw) in value.iter_mut().zip(raw.chunks_exact(number.bytes())) {
        *value = number.decode(raw);
    }
    value
}
