// Light of a material, computed from its numbers and textures, and a sprite to compare it on.
import fs from 'node:fs';
import { PNG } from 'pngjs';
import { clamp, dot, mix, toCode, toLinear, unit } from './arithmetic.mjs';

// Light and opacity of a material, from those of the formula, as a share of them where they are above 1. Ramps have 8 bits: half a
// code is up to 0.0045 of the range, and engines filter codes or light.
export const MOST_OFF = 0.02;

// The formula of a material, from the numbers of its WGSL and its textures.
export function formula(name) {
    const numbers = {};
    const wgsl = fs.readFileSync(`wgsl_${name}/haze_material.wgsl`, 'utf8');
    for (const [, constant, value] of wgsl.matchAll(/const HAZE_(\w+): \w+ = (.*);/g)) {
        const found = value.replace('vec3f', '').match(/-?[\d.]+(e-?\d+)?/g);
        numbers[constant] = found?.length === 3 ? found.map(Number) : Number(found?.[0]);
    }
    const images = {};
    for (const file of fs.readdirSync(`three_${name}`).filter(file => file.endsWith('_ramp.png'))) {
        images[file.slice(0, -'.png'.length)] = PNG.sync.read(fs.readFileSync(`three_${name}/${file}`));
    }
    // Row 0 is at the top. Coordinates lead from the center of the first texel to that of the last.
    const ramp = (image, ...coordinates) => {
        const sizes = [image.width, image.height];
        const at = sizes.map((size, axis) => clamp(coordinates[axis] ?? 0) * (size - 1));
        const texel = (x, y) => [0, 1, 2].map(channel => toLinear(image.data[4 * (y * image.width + x) + channel] / 255));
        if (numbers.LIB_RAMP_FILTER === 1) return texel(...at.map(Math.round));
        const low = at.map(Math.floor);
        const high = low.map((value, axis) => Math.min(value + 1, sizes[axis] - 1));
        const row = y => mix(texel(low[0], y), texel(high[0], y), at[0] - low[0]);
        return mix(row(low[1]), row(high[1]), at[1] - low[1]);
    };
    const painted = color => toCode(clamp(dot(color, [0.2126, 0.7152, 0.0722]))) / 255;
    return {
        // Share of a light that the smoke sends to the viewer.
        diffuse(normal, toLight, toViewer, amount) {
            const at = [dot(normal, toLight) / 2 + 0.5, amount * numbers.BOOST];
            const against = numbers.LIB_BACKLIGHT === 1 ? clamp(0.5 - dot(toLight, toViewer) / 2) ** 3 : 0;
            const share = ramp(images.diffuse_ramp, ...at);
            const all = against > 0 ? mix(share, ramp(images.backlight_ramp, ...at), against) : share;
            return all.map(channel => channel * numbers.DIFFUSE_INTENSITY);
        },
        // Light of all directions, and of fire.
        even(amount, age, heatByAge = 1) {
            const x = clamp((amount - numbers.SCATTER_AMOUNT) / Math.max(numbers.SCATTER_SMOOTH, 1e-4));
            const scatter = images.soft_scatter_ramp
                ? ramp(images.soft_scatter_ramp, amount)
                : mix(numbers.SCATTER_COLOR, numbers.AMBIENT_COLOR, x * x * (3 - 2 * x));
            const heat = images.fire_ramp ? heatByAge * painted(ramp(images.heat_ramp, age)) : 0;
            const fire = images.fire_ramp ? ramp(images.fire_ramp, heat, amount * numbers.BOOST) : [0, 0, 0];
            return scatter.map((channel, index) =>
                channel * numbers.SOFT_SCATTER_INTENSITY + fire[index] * (numbers.FIRE_INTENSITY ?? 0));
        },
        opacity(amount) {
            const covered = clamp(amount * numbers.BOOST);
            return images.coverage_ramp ? painted(ramp(images.coverage_ramp, covered)) : covered;
        },
    };
}

// Sprite of 8 by 8 texels: normals from left to right, amounts from the top down.
export const GRID = 8;
export function spriteTexel(x, y) {
    const angle = 2.4 * x;
    const slope = 0.3 + 0.09 * x;
    const normal = unit([Math.sin(slope) * Math.cos(angle), Math.sin(slope) * Math.sin(angle), Math.cos(slope)]);
    return [...normal.map(axis => Math.round((axis / 2 + 0.5) * 255)), Math.round(((y + 0.5) / GRID) * 255)];
}
