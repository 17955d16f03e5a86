//! Vectors of a glTF file, of any type of number.

use glam::{Vec3, Vec4};
use gltf::accessor::{DataType, Dimensions, Item, Iter};

/// Colors of an accessor, with alpha. Integers are parts of 1, also in files that do not say so.
///
/// # Errors
/// As [`vectors`].
pub fn colors(accessor: &gltf::Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<Vec4>, String> {
    if accessor.dimensions() == Dimensions::Vec3 {
        let colors = vectors::<3>(accessor, buffers, true)?;
        return Ok(colors.into_iter().map(|color| Vec3::from(color).extend(1.0)).collect());
    }
    Ok(vectors::<4>(accessor, buffers, true)?.into_iter().map(Vec4::from).collect())
}

/// Vectors of an accessor as floats. `is_normalized`: integers are parts of 1, not whole numbers.
///
/// # Errors
/// The reason, for vectors of another length and for data outside its buffer.
pub fn vectors<const N: usize>(
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
    is_normalized: bool,
) -> Result<Vec<[f32; N]>, String>
where
    [f32; N]: Item,
    [i8; N]: Item,
    [u8; N]: Item,
    [i16; N]: Item,
    [u16; N]: Item,
{
    let index = accessor.index();
    let length = accessor.dimensions().multiplicity();
    if length != N {
        return Err(format!("accessor {index} has {length} numbers per item; expected {N}"));
    }
    let scale = |most: f32| if is_normalized { 1.0 / most } else { 1.0 };
    let read = match accessor.data_type() {
        _ if accessor.count() == 0 => Some(Vec::new()),
        DataType::F32 => items::<[f32; N]>(accessor, buffers).map(Iterator::collect),
        DataType::I8 => items::<[i8; N]>(accessor, buffers).map(|items| scaled(items, scale(127.0))),
        DataType::U8 => items::<[u8; N]>(accessor, buffers).map(|items| scaled(items, scale(255.0))),
        DataType::I16 => items::<[i16; N]>(accessor, buffers).map(|items| scaled(items, scale(32767.0))),
        DataType::U16 => items::<[u16; N]>(accessor, buffers).map(|items| scaled(items, scale(65535.0))),
        DataType::U32 => return Err(format!("accessor {index} has numbers of 32 bits; expected floats")),
    };
    read.ok_or_else(|| format!("accessor {index} lies outside its buffer; expected a whole file"))
}

fn items<'s, T: Item>(accessor: &gltf::Accessor<'_>, buffers: &'s [Vec<u8>]) -> Option<Iter<'s, T>> {
    Iter::new(accessor.clone(), |buffer: gltf::Buffer<'_>| buffers.get(buffer.index()).map(Vec::as_slice))
}

fn scaled<T: Into<f32>, const N: usize>(items: impl Iterator<Item = [T; N]>, scale: f32) -> Vec<[f32; N]> {
    // The lowest code of signed integers lies one step below -1.
    let number = |number: T| (number.into() * scale).max(if scale < 1.0 { -1.0 } else { f32::MIN });
    items.map(|item| item.map(number)).collect()
}
