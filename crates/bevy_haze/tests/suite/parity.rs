//! Bevy's picture against that of haze alone.

use crate::alone;
use crate::host::host;

#[test]
fn smoke_in_bevy_is_smoke_by_haze_alone() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let bevy = host.picture();
    let alone = alone::picture(&host);
    host.app.world_mut().despawn(smoke);
    let empty = host.picture();
    let mask = bevy.mask_of_difference(&empty);
    let all = vec![true; mask.len()];
    let inside = bevy.psnr(&alone, &mask);
    let everywhere = bevy.psnr(&alone, &all);
    println!("{inside:.1} dB in smoke, {everywhere:.1} dB everywhere");
    // Both draw with the same shaders and nearly the same numbers: 94 dB with lavapipe.
    assert!(mask.iter().filter(|inside| **inside).count() > mask.len() / 20);
    assert!(inside > 60.0 && everywhere > 60.0);
}
