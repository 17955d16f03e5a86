//! Serializes an image as its size and its bytes.

use image::RgbaImage;
use serde::de::{Deserialize, Deserializer, Error};
use serde::{Serialize, Serializer};

pub fn serialize<S: Serializer>(image: &RgbaImage, serializer: S) -> Result<S::Ok, S::Error> {
    (image.width(), image.height(), image.as_raw()).serialize(serializer)
}

pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<RgbaImage, D::Error> {
    let (width, height, bytes) = Deserialize::deserialize(deserializer)?;
    RgbaImage::from_raw(width, height, bytes).ok_or_else(|| D::Error::custom("too few bytes for the image's size"))
}
