// Curves over the life of a particle, or over an emission: straight lines between up to eight points, constant before the first
// and after the last.

// Points (x, value), two in each vector. The last is repeated.
struct Curve {
    points: array<vec4f, 4>,
}

const CURVE_POINTS: u32 = 8u;

// Returns a point.
fn curve_point(curve: Curve, index: u32) -> vec2f {
    let pair = curve.points[index / 2u];
    return select(pair.xy, pair.zw, index % 2u == 1u);
}

// Returns the value at an age.
fn curve_value(curve: Curve, age: f32) -> f32 {
    var last = curve_point(curve, 0u);
    var value = last.y;
    for (var index = 1u; index < CURVE_POINTS; index++) {
        let next = curve_point(curve, index);
        value += (next.y - last.y) * saturate((age - last.x) / max(next.x - last.x, 1.0e-6));
        last = next;
    }
    return value;
}

// Returns the integral of the values from birth to an age.
fn curve_integral(curve: Curve, age: f32) -> f32 {
    var last = curve_point(curve, 0u);
    var sum = min(age, last.x) * last.y;
    for (var index = 1u; index < CURVE_POINTS; index++) {
        let next = curve_point(curve, index);
        let width = next.x - last.x;
        let part = clamp(age - last.x, 0.0, width);
        sum += part * (last.y + 0.5 * (next.y - last.y) * part / max(width, 1.0e-6));
        last = next;
    }
    return sum + max(age - last.x, 0.0) * last.y;
}

// Smoothstep: 0..1 with slope 0 at both ends.
fn smoothstep_unit(x: f32) -> f32 {
    let s = saturate(x);
    return s * s * (3.0 - 2.0 * s);
}
