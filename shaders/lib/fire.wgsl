// Fire: light of hot smoke.

// Heat at a position of a sprite. `thickness`: alpha of the sprite's image there, 0 to 1. `facing`: cosine between its normal
// and the direction to the viewer. `core`: fraction by which a thin edge is cooler than the middle. `crust`: fraction by which
// the side that faces the viewer is cooler than the creases.
fn heat_at(heat: f32, thickness: f32, facing: f32, core: f32, crust: f32) -> f32 {
    let front = saturate(facing);
    return heat * (1.0 - core * (1.0 - thickness)) * (1.0 - crust * front * front);
}

// Mean heat of the smoke that burns at a point, and its fraction of all visible smoke there. `moments`: means of heat and of
// its square over that smoke.
//
// Heat itself is the weight of the mean. Cold smoke in front of a fire then takes from the fraction, not from the heat: the
// fire grows dim and keeps its color.
fn fire_from_moments(moments: vec2f) -> vec2f {
    let burns = moments.x > 1.0e-4 && moments.y > 1.0e-8;
    if !burns {
        return vec2f(0.0);
    }
    return min(vec2f(moments.y / moments.x, moments.x * moments.x / moments.y), vec2f(1.0));
}
