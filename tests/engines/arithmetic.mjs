// Colors, vectors and differences.
export const toLinear = code => (code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4);
// Codes are from 0 to 255.
export function toCode(light) {
    const shown = Math.min(light, 1);
    return 255 * (shown <= 0.0031308 ? 12.92 * shown : 1.055 * shown ** (1 / 2.4) - 0.055);
}

// Codes of an image over a background, blended in linear light.
export function over({ data, isStraight }, background) {
    const codes = [];
    for (let at = 0; at < data.length; at += 4) {
        const alpha = data[at + 3] / 255;
        for (let channel = 0; channel < 3; channel++) {
            const light = toLinear(data[at + channel] / 255) * (isStraight ? alpha : 1);
            codes.push(toCode(light + background * (1 - alpha)));
        }
    }
    return codes;
}

export function squaredError(a, b) {
    return a.reduce((sum, value, index) => sum + (value - b[index]) ** 2, 0);
}

export function psnr(a, b) {
    return 10 * Math.log10((255 * 255 * a.length) / squaredError(a, b));
}

export const clamp = value => Math.min(Math.max(value, 0), 1);
export const dot = (a, b) => a.reduce((sum, value, index) => sum + value * b[index], 0);
export const mix = (a, b, share) => a.map((value, index) => value + (b[index] - value) * share);
export const minus = (a, b) => a.map((value, index) => value - b[index]);
export const unit = a => a.map(value => value / Math.hypot(...a));

export function smoothstep(x) {
    return clamp(x) ** 2 * (3 - 2 * clamp(x));
}

// Largest difference of two lists, as a share of what was expected where that is above 1.
export function worst(found, expected) {
    return found.reduce((most, value, index) => {
        const off = Math.abs(value - expected[index]) / Math.max(1, Math.abs(expected[index]));
        return Number.isFinite(off) ? Math.max(most, off) : Infinity;
    }, 0);
}
