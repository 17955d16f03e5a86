// Textures of the accumulation target by role. The first, normal and amount, is always there; a system has those of the
// others that its settings use. The table is in src/renderer/targets/attachments.rs.

const MAX_TARGET_ATTACHMENTS: u32 = 4u;

// Number of textures of this system.
override ATTACHMENT_COUNT: u32 = 1u;
// Index of each role's texture among them. 0: the system does not have it.
override SIX_WAY_SLOT: u32 = 0u;
override WEIGHTS_SLOT: u32 = 0u;
override OPTICAL_DEPTHS_SLOT: u32 = 0u;
override DEPTH_SLOT: u32 = 0u;
override HEAT_SLOT: u32 = 0u;
override TINT_SLOT: u32 = 0u;

// Values of a fragment or a texel, by role.
struct Attachments {
    // Light from left, bottom and back in rgb, sum of weights in a.
    six_way: vec4f,
    // Sum of the normals' weights.
    weights: f32,
    // Weighted optical depths towards the lights with shadow in rgb, sum of weights in a.
    optical_depths: vec4f,
    // Weighted depth_moments() in rg, sum of weights in a.
    depth: vec4f,
    // Weighted heat, and its square, in rg, sum of weights in a.
    heat: vec4f,
    // Weighted color of particles in rgb, sum of weights in a.
    tint: vec4f,
}

fn add_attachments(sum: Attachments, next: Attachments) -> Attachments {
    var total = sum;
    if SIX_WAY_SLOT != 0u {
        total.six_way += next.six_way;
    }
    if WEIGHTS_SLOT != 0u {
        total.weights += next.weights;
    }
    if OPTICAL_DEPTHS_SLOT != 0u {
        total.optical_depths += next.optical_depths;
    }
    if DEPTH_SLOT != 0u {
        total.depth += next.depth;
    }
    if HEAT_SLOT != 0u {
        total.heat += next.heat;
    }
    if TINT_SLOT != 0u {
        total.tint += next.tint;
    }
    return total;
}

// Values to write, by texture. `first`: normal and amount.
fn slots_from_attachments(first: vec4f, values: Attachments) -> array<vec4f, MAX_TARGET_ATTACHMENTS> {
    var slots: array<vec4f, MAX_TARGET_ATTACHMENTS>;
    slots[0] = first;
    if SIX_WAY_SLOT != 0u {
        slots[SIX_WAY_SLOT] = values.six_way;
    }
    if WEIGHTS_SLOT != 0u {
        slots[WEIGHTS_SLOT] = vec4f(values.weights);
    }
    if OPTICAL_DEPTHS_SLOT != 0u {
        slots[OPTICAL_DEPTHS_SLOT] = values.optical_depths;
    }
    if DEPTH_SLOT != 0u {
        slots[DEPTH_SLOT] = values.depth;
    }
    if HEAT_SLOT != 0u {
        slots[HEAT_SLOT] = values.heat;
    }
    if TINT_SLOT != 0u {
        slots[TINT_SLOT] = values.tint;
    }
    return slots;
}

// Values by role, from those read of each texture.
fn attachments_from_slots(read: array<vec4f, MAX_TARGET_ATTACHMENTS>) -> Attachments {
    // A variable, because WGSL's back ends index only variables by an override.
    var slots = read;
    var values: Attachments;
    if SIX_WAY_SLOT != 0u {
        values.six_way = slots[SIX_WAY_SLOT];
    }
    if WEIGHTS_SLOT != 0u {
        values.weights = slots[WEIGHTS_SLOT].r;
    }
    if OPTICAL_DEPTHS_SLOT != 0u {
        values.optical_depths = slots[OPTICAL_DEPTHS_SLOT];
    }
    if DEPTH_SLOT != 0u {
        values.depth = slots[DEPTH_SLOT];
    }
    if HEAT_SLOT != 0u {
        values.heat = slots[HEAT_SLOT];
    }
    if TINT_SLOT != 0u {
        values.tint = slots[TINT_SLOT];
    }
    return values;
}
