// Baked diffuse light by normal: the geometry of the cubemap and of the motif, and spherical harmonics.

#import "lib/ramp.wgsl"

// Cube faces are in the order +x -x +y -y +z -z. The centers of a face's edge texels lie exactly on the cube's edges,
// so that two faces share the texels there and bilinear lookups meet without a seam.

struct CubeCoordinate {
    face: i32,
    // Position on the face, -1..1.
    position: vec2f,
}

// Direction (not normalised) of a point on a face.
fn cube_direction(face: i32, position: vec2f) -> vec3f {
    switch face {
        case 0: { return vec3f(1.0, position.y, -position.x); }
        case 1: { return vec3f(-1.0, position.y, position.x); }
        case 2: { return vec3f(position.x, 1.0, -position.y); }
        case 3: { return vec3f(position.x, -1.0, position.y); }
        case 4: { return vec3f(position.x, position.y, 1.0); }
        default: { return vec3f(-position.x, position.y, -1.0); }
    }
}

// Face and point that a direction hits. The direction need not be normalised.
fn cube_coordinate(direction: vec3f) -> CubeCoordinate {
    let size = abs(direction);
    let largest = max(max(size.x, size.y), max(size.z, 1.0e-12));
    let d = direction / largest;
    if size.x >= size.y && size.x >= size.z {
        if d.x > 0.0 { return CubeCoordinate(0, vec2f(-d.z, d.y)); }
        return CubeCoordinate(1, vec2f(d.z, d.y));
    }
    if size.y >= size.z {
        if d.y > 0.0 { return CubeCoordinate(2, vec2f(d.x, -d.z)); }
        return CubeCoordinate(3, vec2f(d.x, d.z));
    }
    if d.z > 0.0 { return CubeCoordinate(4, vec2f(d.x, d.y)); }
    return CubeCoordinate(5, vec2f(-d.x, d.y));
}

// Normal seen at a point (-1..1) of an image of a sphere. Outside the disc it is the normal of the nearest rim point.
fn motif_normal(position: vec2f) -> vec3f {
    let square = dot(position, position);
    if square >= 1.0 {
        return vec3f(position * inverseSqrt(square), 0.0);
    }
    return vec3f(position, sqrt(1.0 - square));
}

// Position (-1..1) of a normal in an image of a sphere. Normals that face away map to the rim.
fn motif_position(normal: vec3f) -> vec2f {
    if normal.z >= 0.0 {
        return normal.xy;
    }
    return normal.xy * inverseSqrt(max(dot(normal.xy, normal.xy), 1.0e-12));
}

// Samples baked light. `position` is -1..1 on the face or motif; the first row is at -1.
fn sample_baked(baked: texture_2d_array<f32>, linear_sampler: sampler, position: vec2f, layer: i32) -> vec3f {
    let size = vec2f(textureDimensions(baked));
    let texel = saturate(position * 0.5 + 0.5) * (size - 1.0);
    if !EXACT_FILTERING {
        return textureSampleLevel(baked, linear_sampler, (texel + 0.5) / size, layer, 0.0).rgb;
    }
    let base = floor(texel);
    let fraction = texel - base;
    let low = vec2i(base);
    let high = min(low + 1, vec2i(size) - 1);
    let bottom = mix(
        textureLoad(baked, low, layer, 0),
        textureLoad(baked, vec2i(high.x, low.y), layer, 0),
        fraction.x,
    );
    let top = mix(
        textureLoad(baked, vec2i(low.x, high.y), layer, 0),
        textureLoad(baked, high, layer, 0),
        fraction.x,
    );
    return mix(bottom, top, fraction.y).rgb;
}

// Light on a normal from nine coefficients: the real spherical harmonics up to L2, with the constants of the basis.
fn spherical_harmonics(coefficients: array<vec4f, 9>, n: vec3f) -> vec3f {
    let c = coefficients;
    var light = 0.282094792 * c[0].rgb;
    light += 0.488602512 * (n.y * c[1].rgb + n.z * c[2].rgb + n.x * c[3].rgb);
    light += 1.092548431 * (n.x * n.y * c[4].rgb + n.y * n.z * c[5].rgb + n.x * n.z * c[7].rgb);
    light += 0.315391565 * (3.0 * n.z * n.z - 1.0) * c[6].rgb;
    light += 0.546274215 * (n.x * n.x - n.y * n.y) * c[8].rgb;
    // L2 overshoots with hard ramps; light must not be negative.
    return max(light, vec3f(0.0));
}
