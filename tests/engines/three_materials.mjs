// Materials in three.js.
import fs from 'node:fs';
import { PNG } from 'pngjs';
import { clamp, dot, minus, mix, smoothstep, unit, worst } from './arithmetic.mjs';
import { address, browser } from './browser.mjs';
import { check, folders } from './checks.mjs';
import { formula, GRID, MOST_OFF, spriteTexel } from './formula.mjs';

// Size of the modules of a material together, bytes.
const MOST_BYTES = 15000;

// Camera of the materials in three.js: at this distance, a square of two units fills the image.
const DISTANCE = 3;
const LIGHTS = [
    { kind: 'directional', at: [-0.8, 0.5, 0.4], color: [1, 0.7, 0.4], intensity: 0.9 * Math.PI },
    { kind: 'point', at: [1.2, 0.6, -1.5], color: [0.5, 0.8, 1], intensity: 3 * Math.PI },
    { kind: 'spot', at: [0.3, -2, 1.5], color: [1, 1, 1], intensity: 6 * Math.PI },
];
const SPOT_ANGLE = 0.6;
const PENUMBRA = 0.5;
// The second of these is an instance with an attribute, turned by a quarter.
const PARTICLES = [
    { isInstance: false, angle: 0, age: 0, frame: 0, amount: 1 },
    { isInstance: true, angle: Math.PI / 2, age: 0.4, frame: 1, amount: 0.8 },
];

// Preset with which further checks are made.
const COMPARED = 'column';
const FOG = { color: [0.1, 0.5, 0.9], near: 0.1, far: 1, depth: 0.5 };

// Direction to a light and its color, from a point in view space.
function lightAt({ kind, at, color, intensity }, point) {
    const center = minus(at, [0, 0, DISTANCE]);
    if (kind === 'directional') return { toLight: unit(at), light: color.map(channel => channel * intensity) };
    const way = minus(center, point);
    const toLight = unit(way);
    let share = intensity / Math.max(Math.hypot(...way) ** 2, 0.01);
    if (kind === 'spot') {
        const cosines = [Math.cos(SPOT_ANGLE), Math.cos(SPOT_ANGLE * (1 - PENUMBRA))];
        const x = clamp((dot(toLight, unit(at)) - cosines[0]) / (cosines[1] - cosines[0]));
        share *= smoothstep(x);
    }
    return { toLight, light: color.map(channel => channel * share) };
}

// Light and opacity of all pixels, rows from the top.
function expectedPixels({ diffuse, even, opacity }, light, particle) {
    const pixels = [];
    for (let y = 0; y < GRID; y++) {
        for (let x = 0; x < GRID; x++) {
            const place = [(2 * x + 1) / GRID - 1, 1 - (2 * y + 1) / GRID];
            const point = [...place, -DISTANCE];
            // A particle turned by a quarter: its right points down.
            const isTurned = particle.angle !== 0;
            const [column, row] = isTurned ? [y, GRID - 1 - x] : [x, y];
            const [r, g, b, a] = spriteTexel(column, row);
            const [nx, ny, nz] = unit([r, g, b].map(code => (code / 255) * 2 - 1));
            const normal = isTurned ? [ny, -nx, nz] : [nx, ny, nz];
            const amount = (a / 255) * particle.amount;
            const { toLight, light: color } = lightAt(light, point);
            const share = diffuse(normal, toLight, unit(point.map(axis => -axis)), amount);
            const sum = even(amount, particle.age);
            pixels.push(...share.map((channel, index) => (channel * color[index]) / Math.PI + sum[index]), opacity(amount));
        }
    }
    return pixels;
}

// All materials, under three lights, as a mesh and as an instance.
export async function testThreeMaterials(renderer, { page: html, module, name: className }) {
    const page = await browser.newPage();
    const said = [];
    page.on('console', message => {
        if (['error', 'warn'].includes(message.type())) said.push(message.text());
    });
    page.on('pageerror', error => said.push(String(error)));
    const texels = Array.from({ length: GRID * GRID }, (_, at) => spriteTexel(at % GRID, Math.floor(at / GRID))).flat();
    const optionsOf = (name, light, particle, gray) =>
        ({ url: `/three_${name}/`, module, className, light, particle, gray, texels, GRID, DISTANCE, SPOT_ANGLE, PENUMBRA });
    await page.goto(`${address}/${html}`);
    await page.waitForFunction('window.three');
    for (const folder of folders('three_')) {
        const name = folder.slice('three_'.length);
        const modules = fs.readdirSync(folder).filter(file => file.endsWith('.js'));
        const size = modules.reduce((sum, file) => sum + fs.statSync(`${folder}/${file}`).size, 0);
        const expect = formula(name);
        let most = 0;
        let mostOfWrong = 0;
        for (const [index, light] of LIGHTS.entries()) {
            for (const particle of PARTICLES) {
                const found = await page.evaluate(drawMaterial, optionsOf(name, light, particle));
                const off = worst(found, expectedPixels(expect, light, particle));
                most = Math.max(most, off);
                const another = LIGHTS[(index + 1) % LIGHTS.length];
                mostOfWrong = Math.max(mostOfWrong, worst(found, expectedPixels(expect, another, particle)));
            }
        }
        const seen = `at most ${most.toFixed(5)} from the formula, ${(size / 1000).toFixed(1)} kB`;
        const isRight = most <= MOST_OFF && size <= MOST_BYTES && said.length === 0;
        check(`${renderer}, material of ${name}`, isRight, said[0] ?? seen);
        if (name === COMPARED) {
            check(`${renderer}: the comparison finds another light`, mostOfWrong > MOST_OFF, mostOfWrong.toFixed(2));
        }
    }
    const url = `/three_${COMPARED}/`;
    const over = await page.evaluate(drawMaterial, optionsOf(COMPARED, LIGHTS[0], PARTICLES[0], 0.7));
    const mixed = expectedPixels(formula(COMPARED), LIGHTS[0], PARTICLES[0]).map((channel, index, all) => {
        const alpha = all[index - (index % 4) + 3];
        return index % 4 < 3 ? channel * alpha + 0.7 * (1 - alpha) : 1;
    });
    const offOver = worst(over, mixed);
    check(`${renderer}, over gray`, offOver <= MOST_OFF, `${offOver.toFixed(5)} from the formula`);
    const { even } = formula(COMPARED);
    const pixel = await page.evaluate(drawInFogAndShadow, { url, module, className, fog: FOG, texel: spriteTexel(0, 0) });
    const expected = mix(even(spriteTexel(0, 0)[3] / 255, 0), FOG.color, smoothstep((FOG.depth - FOG.near) / (FOG.far - FOG.near)));
    const off = worst(pixel.slice(0, 3), expected);
    check(`${renderer}, in fog and shadow`, off <= MOST_OFF && said.length === 0, said[0] ?? `${off.toFixed(5)} from the formula`);
    const { side, frame, alphas } = await page.evaluate(drawSprite, { url, module, className });
    const sheet = PNG.sync.read(fs.readFileSync(`three_${COMPARED}/sprite.png`));
    const columns = sheet.width / side;
    const { opacity } = formula(COMPARED);
    const cut = alphas.map((_, at) => {
        const x = (frame % columns) * side + (at % side);
        const y = Math.floor(frame / columns) * side + Math.floor(at / side);
        return opacity(sheet.data[4 * (y * sheet.width + x) + 3] / 255);
    });
    const offSprite = worst(alphas, cut);
    check(`${renderer}, a frame of the sprite`, offSprite <= MOST_OFF && Math.max(...cut) > 0.5, `${offSprite.toFixed(5)} from sprite.png`);
    await page.close();
}

// Runs in the page. Returns light and opacity, rows from the top.
async function drawMaterial({ url, module, className, light, particle, gray, texels, GRID, DISTANCE, SPOT_ANGLE, PENUMBRA }) {
    const three = window.three;
    const { [className]: Material } = await import(`${url}${module}`);
    const { CELLS } = await import(`${url}haze_textures.js`);
    window.loadedMaterials ??= {};
    const loaded = (window.loadedMaterials[url] ??= await Material.load());
    // The sprite in the cell of the particle's frame; all others stay clear.
    const { columns, rows, frames } = CELLS;
    const data = new Uint8Array(4 * GRID * GRID * columns * rows);
    const [left, top] = [particle.frame % columns, Math.floor(particle.frame / columns)].map(cell => cell * GRID);
    for (let y = 0; y < GRID; y++) {
        data.set(texels.slice(4 * GRID * y, 4 * GRID * (y + 1)), 4 * ((top + y) * GRID * columns + left));
    }
    const sprite = new three.DataTexture(data, GRID * columns, GRID * rows);
    sprite.needsUpdate = true;
    const material = new Material({ ...loaded.textures, sprite });
    // Without a background, light and opacity themselves.
    if (gray === undefined) material.blending = three.NoBlending;
    const geometry = new three.PlaneGeometry(2, 2);
    let mesh = new three.Mesh(geometry, material);
    if (particle.isInstance) {
        mesh = new three.InstancedMesh(geometry, material, 1);
        mesh.setMatrixAt(0, new three.Matrix4().makeScale(0.5, 0.5, 0.5));
        mesh.scale.setScalar(2);
        const numbers = new Float32Array([particle.angle, particle.age, (particle.frame + 0.5) / frames, particle.amount]);
        geometry.setAttribute('hazeParticle', new three.InstancedBufferAttribute(numbers, 4));
    }
    const scene = new three.Scene();
    if (gray !== undefined) scene.background = new three.Color(gray, gray, gray);
    scene.add(mesh);
    const color = new three.Color(...light.color);
    const lamp = {
        directional: () => new three.DirectionalLight(color, light.intensity),
        point: () => new three.PointLight(color, light.intensity),
        spot: () => new three.SpotLight(color, light.intensity, 0, SPOT_ANGLE, PENUMBRA),
    }[light.kind]();
    lamp.position.set(...light.at);
    // The material of smoke has no ambient light.
    scene.add(lamp, new three.AmbientLight());
    const camera = new three.PerspectiveCamera((2 * Math.atan(1 / DISTANCE) * 180) / Math.PI, 1, 0.1, 10);
    camera.position.z = DISTANCE;
    const found = await window.readPixels(scene, camera, GRID);
    sprite.dispose();
    return found;
}

// Runs in the page. Returns the middle pixel of smoke with one normal and amount, in fog, in the shadow of a wall behind the
// camera.
async function drawInFogAndShadow({ url, module, className, fog, texel }) {
    const three = window.three;
    const { [className]: Material } = await import(`${url}${module}`);
    const loaded = await Material.load();
    const sprite = new three.DataTexture(new Uint8Array(texel), 1, 1);
    sprite.needsUpdate = true;
    const material = new Material({ ...loaded.textures, sprite });
    material.blending = three.NoBlending;
    const smoke = new three.Mesh(new three.PlaneGeometry(2, 2), material);
    smoke.receiveShadow = true;
    const wall = new three.Mesh(new three.BoxGeometry(8, 8, 0.1), new three.MeshBasicMaterial());
    wall.position.z = 1;
    wall.castShadow = true;
    const scene = new three.Scene();
    scene.fog = new three.Fog(0, fog.near, fog.far);
    scene.fog.color.setRGB(...fog.color);
    for (const lamp of [new three.DirectionalLight(), new three.PointLight('white', 9), new three.SpotLight('white', 9)]) {
        lamp.position.set(0, 0, 2);
        lamp.castShadow = true;
        scene.add(lamp);
    }
    scene.add(smoke, wall);
    const camera = new three.PerspectiveCamera(20, 1, 0.1, 10);
    camera.position.z = fog.depth;
    const pixels = await window.readPixels(scene, camera, 3);
    return pixels.slice(16, 20);
}

// Runs in the page. Returns the opacity of a frame, texel by texel.
async function drawSprite({ url, module, className }) {
    const three = window.three;
    const { [className]: Material } = await import(`${url}${module}`);
    const { CELLS } = await import(`${url}haze_textures.js`);
    const material = await Material.load();
    const side = material.textures.sprite.image.width / CELLS.columns;
    const frame = CELLS.columns;
    material.numbers.frame.value = frame;
    material.blending = three.NoBlending;
    const scene = new three.Scene();
    scene.add(new three.Mesh(new three.PlaneGeometry(2, 2), material));
    const pixels = await window.readPixels(scene, new three.OrthographicCamera(-1, 1, 1, -1, -1, 1), side);
    return { side, frame, alphas: pixels.filter((_, index) => index % 4 === 3) };
}
