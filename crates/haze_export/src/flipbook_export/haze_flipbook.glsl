uniform sampler2D hazeColor;
uniform sampler2D hazeMotion;
uniform vec2 hazeCells;
uniform vec2 hazeInside;
uniform vec2 hazeFrames;
uniform float hazeShare;
uniform vec2 hazeMotionScale;
uniform float hazeOpacity;
varying vec2 hazeUv;

// Coordinate in the sheet. Half a texel inside the frame: the sheet has another frame beside it.
vec2 hazeSheet(vec2 uv, float frame) {
    vec2 cell = vec2(mod(frame, hazeCells.x), floor(frame / hazeCells.x));
    return (cell + clamp(uv, hazeInside, 1.0 - hazeInside)) / hazeCells;
}

vec2 hazeWay(float frame) {
    return (texture2D(hazeMotion, hazeSheet(hazeUv, frame)).rg * 2.0 - 1.0) * hazeMotionScale;
}

// Color at this place of the square, as the sheet has it: straight or premultiplied.
vec4 hazeSmoke() {
    vec2 before = hazeUv - hazeWay(hazeFrames.x) * hazeShare;
    vec2 after = hazeUv + hazeWay(hazeFrames.y) * (1.0 - hazeShare);
    vec4 first = texture2D(hazeColor, hazeSheet(before, hazeFrames.x));
    vec4 second = texture2D(hazeColor, hazeSheet(after, hazeFrames.y));
    #ifdef HAZE_STRAIGHT
        // Colors count as much as they cover.
        vec4 mixed = mix(vec4(first.rgb * first.a, first.a), vec4(second.rgb * second.a, second.a), hazeShare);
        return vec4(mixed.rgb / max(mixed.a, 1.0e-4), mixed.a * hazeOpacity);
    #else
        return mix(first, second, hazeShare) * hazeOpacity;
    #endif
}
