//! Embedded shader files.

/// Returns the embedded shader file with this path under `shaders/`; `None` if there is no such file.
pub fn source(file: &str) -> Option<&'static str> {
    SOURCES.iter().find(|(name, _)| *name == file).map(|(_, text)| *text)
}

/// Returns every embedded shader file: its path under `shaders/`, and its text.
pub fn sources() -> &'static [(&'static str, &'static str)] {
    SOURCES
}

macro_rules! embed {
    ($($file:literal,)+) => { &[$(($file, include_str!(concat!("../../../shaders/", $file))),)+] };
}

pub(super) const SOURCES: &[(&str, &str)] = embed![
    "accumulate.wgsl",
    "density_splat.wgsl",
    "depth_downsample.wgsl",
    "depth_resolve.wgsl",
    "depth_slopes.wgsl",
    "depth_sort.wgsl",
    "diffuse_bake.wgsl",
    "emit.wgsl",
    "forward.wgsl",
    "light_target.wgsl",
    "mark_cells.wgsl",
    "measure.wgsl",
    "screen_shadow.wgsl",
    "shadow_march.wgsl",
    "shadow_march_slice.wgsl",
    "shadow_visibility.wgsl",
    "shadow_visibility_slice.wgsl",
    "sort.wgsl",
    "specular_scatter.wgsl",
    "tile_accumulate.wgsl",
    "tile_bin.wgsl",
    "tile_gather.wgsl",
    "tile_project.wgsl",
    "tile_refine.wgsl",
    "transfer.wgsl",
    "transfer_lit.wgsl",
    "upsample_lit.wgsl",
    "lib/accumulated.wgsl",
    "lib/ambient.wgsl",
    "lib/attachments.wgsl",
    "lib/bindings.wgsl",
    "lib/blending.wgsl",
    "lib/bounding_box.wgsl",
    "lib/cells.wgsl",
    "lib/color.wgsl",
    "lib/coverage.wgsl",
    "lib/density_grid.wgsl",
    "lib/depth.wgsl",
    "lib/depth_moments.wgsl",
    "lib/diffuse.wgsl",
    "lib/diffuse_bake.wgsl",
    "lib/emission.wgsl",
    "lib/emitter.wgsl",
    "lib/fire.wgsl",
    "lib/flight.wgsl",
    "lib/flow.wgsl",
    "lib/hash.wgsl",
    "lib/haze_transmittance.wgsl",
    "lib/lighting.wgsl",
    "lib/lit_pixel.wgsl",
    "lib/lit_smoke.wgsl",
    "lib/lit_target.wgsl",
    "lib/curve.wgsl",
    "lib/glow.wgsl",
    "lib/grain.wgsl",
    "lib/noise_volume.wgsl",
    "lib/normal.wgsl",
    "lib/order.wgsl",
    "lib/particle.wgsl",
    "lib/ramp.wgsl",
    "lib/response.wgsl",
    "lib/scan.wgsl",
    "lib/scene_shadow.wgsl",
    "lib/screen_shadow.wgsl",
    "lib/shadow.wgsl",
    "lib/shadow_map.wgsl",
    "lib/shadow_map_lookup.wgsl",
    "lib/shadow_march.wgsl",
    "lib/shadow_views.wgsl",
    "lib/shadow_volume.wgsl",
    "lib/six_way.wgsl",
    "lib/smoke_extent.wgsl",
    "lib/smoke_tiles.wgsl",
    "lib/soft_fade.wgsl",
    "lib/sprite.wgsl",
    "lib/sprite_fragment.wgsl",
    "lib/sprite_vertex.wgsl",
    "lib/stretch.wgsl",
    "lib/swirl_noise.wgsl",
    "lib/system.wgsl",
    "lib/technique.wgsl",
    "lib/tile_sprite.wgsl",
    "lib/tiles.wgsl",
    "lib/tonemap.wgsl",
    "lib/upsample.wgsl",
    "lib/view.wgsl",
    "lib/volume_slice.wgsl",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shader_file_is_embedded() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let mut files = Vec::new();
        for folder in ["", "lib"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                let name = entry.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".wgsl") {
                    files.push(if folder.is_empty() { name } else { format!("{folder}/{name}") });
                }
            }
        }
        files.sort();
        let mut embedded: Vec<_> = SOURCES.iter().map(|(name, _)| (*name).to_owned()).collect();
        embedded.sort();
        assert_eq!(files, embedded);
    }
}
