// Materials and scenes in Godot itself, in all of its renderers. scripts/test_engines prepares the folder that it runs in: `godot_NAME`,
// `wgsl_NAME` and `three_NAME`, `opacity_NAME_N.png`, and GODOT, the program.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { PNG } from 'pngjs';
import { mix, toCode, toLinear, unit, worst } from './arithmetic.mjs';
import { check, endOfChecks, folders } from './checks.mjs';
import { formula, GRID, MOST_OFF, spriteTexel } from './formula.mjs';

const RENDERERS = { forward_plus: 'Forward+', mobile: 'Mobile', gl_compatibility: 'Compatibility' };
// Materials that differ in their ramps.
const LIT = ['campfire', 'column', 'every_ramp_bilinear', 'every_ramp_nearest', 'wildfire_sky'];
const LIGHTS = [[0, 0, 1], [-0.6, 0.5, 0.62], [0.7, -0.2, -0.69]].map(unit);
// Side of the image, pixels.
const SIDE = 256;
// Distance of the camera from squares.
const FAR = 10;
const BACKGROUND = 0.5;
// Systems whose smoke is compared with haze's.
const SCENES = ['column', 'campfire', 'steam_vent'];
// Images of a scene, every half a second, and frames per second.
const IMAGES = 4;
const RATE = 10;
const PROJECT = path.resolve('godot_project');

fs.mkdirSync(PROJECT);
for (const folder of folders('godot_').filter(folder => folder !== 'godot_project')) {
    fs.cpSync(folder, `${PROJECT}/${folder}`, { recursive: true });
}
fs.copyFileSync('godot_shots.gd', `${PROJECT}/godot_shots.gd`);
fs.writeFileSync(`${PROJECT}/project.godot`, `config_version=5
[application]
run/main_scene="res://main.tscn"
[display]
window/size/viewport_width=${SIDE}
window/size/viewport_height=${SIDE}
`);
fs.writeFileSync(`${PROJECT}/main.tscn`, `[gd_scene format=3]
[ext_resource type="Script" path="res://godot_shots.gd" id="1"]
[node name="Main" type="Node3D"]
script = ExtResource("1")
`);

// Lines with which Godot reports problems; of its window, none is ours.
function problems(said) {
    return said.split('\n').filter(line => /\b(ERROR|WARNING)\b/.test(line) && !/V-Sync/.test(line));
}

function godot(...options) {
    const { stdout, stderr, status } = spawnSync('xvfb-run', [
        '--auto-servernum', '--server-args=-screen 0 640x480x24', process.env.GODOT, '--path', PROJECT, ...options,
    ], { encoding: 'utf8', timeout: 600000, maxBuffer: 1 << 26 });
    const said = stdout + stderr;
    if (process.env.VERBOSE) console.log(said);
    return { said, status };
}

const imported = godot('--headless', '--import');
check('Godot imports all materials', imported.status === 0 && problems(imported.said).length === 0, problems(imported.said)[0] ?? 'no errors');
for (const folder of folders('godot_').filter(folder => folder !== 'godot_project')) {
    for (const file of fs.readdirSync(folder).filter(file => file.endsWith('.png'))) {
        const settings = fs.readFileSync(`${PROJECT}/${folder}/${file}.import`, 'utf8');
        const isKept = settings.includes('compress/mode=0') && settings.includes('detect_3d/compress_to=0')
            && settings.includes(`mipmaps/generate=${file === 'sprite.png'}`);
        if (!isKept) check(`Godot keeps the import settings of ${folder}/${file}`, false, settings);
    }
}

// A square that fills the image, seen from afar.
const square = { camera: [0, 0, FAR], target: [0, 0, 0], fov: 2 * Math.atan(1 / FAR) * 180 / Math.PI, background: BACKGROUND, frames: 3 };

// Sprite of GRID by GRID cells, of so many texels.
const CELL = 16;
const grid = new PNG({ width: CELL * GRID, height: CELL * GRID });
for (let at = 0; at < grid.width * grid.height; at++) {
    grid.data.set(spriteTexel(Math.floor((at % grid.width) / CELL), Math.floor(at / grid.width / CELL)), 4 * at);
}
fs.writeFileSync('grid.png', PNG.sync.write(grid));
const gridParameters = { haze_sprite: path.resolve('grid.png'), haze_sprite_cells: [1, 1], haze_sprite_frames: 1, haze_heat: 0.3 };
const normalOf = texel => unit(texel.slice(0, 3).map(code => (code / 255) * 2 - 1));

// Particles whose angles, ages and frames are known.
const FRAMES = 4;
const PARTICLES = 16;
const RADIUS = 0.16;
const TINT = [0.9, 0.6, 0.4];
const particle = index => ({
    at: [((index % 4) - 1.5) / 2, (1.5 - Math.floor(index / 4)) / 2],
    angle: 0.7 * index,
    age: (index + 0.5) / PARTICLES,
    death: 0.55 + 0.1 * (index % 5),
    frame: (0.37 * index) % 1,
    amount: 1 - 0.04 * (index % 3),
});
const processShader = () => {
    const list = (type, value) => `${type}[](${Array.from({ length: PARTICLES }, (_, index) => value(particle(index))).join(', ')})`;
    return `shader_type particles;
const vec4 CUSTOMS[${PARTICLES}] = ${list('vec4', p => `vec4(${[p.angle, p.age * p.death, p.frame, p.death].map(n => n.toFixed(6))})`)};
const vec3 PLACES[${PARTICLES}] = ${list('vec3', p => `vec3(${[...p.at, p.amount].map(n => n.toFixed(6))})`)};
void process() {
    CUSTOM = CUSTOMS[int(NUMBER) % ${PARTICLES}];
    vec3 place = PLACES[int(NUMBER) % ${PARTICLES}];
    TRANSFORM = mat4(vec4(${RADIUS}, 0.0, 0.0, 0.0), vec4(0.0, ${RADIUS}, 0.0, 0.0), vec4(0.0, 0.0, ${RADIUS}, 0.0), vec4(place.xy, 0.0, 1.0));
    COLOR = vec4(${TINT.join(', ')}, place.z);
}
`;
};
// Four frames of four quarters each, from the top left.
const quarter = (frame, x, y) => {
    const turn = 1.3 * frame + 1.6 * (x + 2 * y);
    const normal = unit([0.6 * Math.cos(turn), 0.6 * Math.sin(turn), 0.8]);
    return [...normal.map(axis => Math.round((axis / 2 + 0.5) * 255)), 30 + 56 * ((frame + x + 2 * y) % 4)];
};
const sheet = new PNG({ width: 64, height: 64 });
for (let y = 0; y < 64; y++) {
    for (let x = 0; x < 64; x++) {
        const frame = (y >> 5) * 2 + (x >> 5);
        sheet.data.set(quarter(frame, (x >> 4) & 1, (y >> 4) & 1), 4 * (64 * y + x));
    }
}
fs.writeFileSync('quarters.png', PNG.sync.write(sheet));

const shots = [];
const file = name => path.resolve(`shot_${name}.png`);
for (const name of LIT) {
    LIGHTS.forEach((to_light, index) => {
        for (const [alpha, kind] of [['1.0', 'opaque'], [undefined, 'blended']]) {
            shots.push({
                ...square, kind: 'quad', folder: `godot_${name}`, parameters: gridParameters, to_light, energy: 1, alpha,
                files: [file(`${name}_${index}_${kind}`)],
            });
        }
    });
}
for (const name of ['campfire', 'column']) {
    shots.push({
        ...square, kind: 'known particles', folder: `godot_${name}`, to_light: LIGHTS[1], energy: 1, alpha: '1.0', amount: PARTICLES,
        process: processShader(), files: [file(`${name}_particles`)], frames: 6,
        parameters: { haze_sprite: path.resolve('quarters.png'), haze_sprite_cells: [2, 2], haze_sprite_frames: FRAMES, haze_heat: 0.25 },
    });
}
const presets = folders('godot_').filter(folder => folder !== 'godot_project' && !folder.includes('every_ramp')).map(folder => folder.slice('godot_'.length));
for (const name of presets) {
    const isCompared = SCENES.includes(name);
    const cameraOf = JSON.parse(fs.readFileSync(`preset_${name}.json`, 'utf8')).camera;
    shots.push({
        kind: 'scene', folder: `godot_${name}`, camera: cameraOf.position, target: cameraOf.target, fov: cameraOf.fov, background: 1,
        parameters: { haze_heat: 0 }, frames: isCompared ? RATE / 2 : 2,
        files: Array.from({ length: isCompared ? IMAGES : 1 }, (_, index) => file(`${name}_scene_${index}`)),
    });
}
fs.writeFileSync(`${PROJECT}/scenario.json`, JSON.stringify(shots));

const read = name => PNG.sync.read(fs.readFileSync(name));
// Color at a point of the square, from -1 to 1, up.
function colorAt({ data, width, height }, x, y) {
    const at = 4 * (Math.floor((0.5 - y / 2) * height) * width + Math.floor((0.5 + x / 2) * width));
    return [...data.subarray(at, at + 3)].map(code => code / 255);
}
const shown = light => light.map(channel => Math.min(channel, 1));
const codes = light => light.map(channel => toCode(channel) / 255);
const toViewer = (x, y) => unit([-x, -y, FAR]);

function testMaterial(renderer, name) {
    const { diffuse, even, opacity } = formula(name);
    let [most, mostMixed, mostOfWrong] = [0, 0, 0];
    LIGHTS.forEach((toLight, index) => {
        const opaque = read(file(`${name}_${index}_opaque`));
        const blended = read(file(`${name}_${index}_blended`));
        for (let cell = 0; cell < GRID * GRID; cell++) {
            const [column, row] = [cell % GRID, Math.floor(cell / GRID)];
            const [x, y] = [(column + 0.5) / GRID * 2 - 1, 1 - (row + 0.5) / GRID * 2];
            const texel = spriteTexel(column, row);
            const amount = texel[3] / 255;
            const sum = even(amount, 0, 0.3);
            const light = normal => diffuse(normal, toLight, toViewer(x, y), amount).map((share, channel) => share + sum[channel]);
            const normal = normalOf(texel);
            const expected = light(normal);
            most = Math.max(most, worst(colorAt(opaque, x, y).map(toLinear), shown(expected)));
            mostOfWrong = Math.max(mostOfWrong, worst(colorAt(opaque, x, y).map(toLinear), shown(light([normal[0], -normal[1], normal[2]]))));
            const found = colorAt(blended, x, y);
            const gray = [BACKGROUND, BACKGROUND, BACKGROUND];
            const off = renderer === 'gl_compatibility'
                ? worst(found, mix(gray, codes(shown(expected)), opacity(amount)))
                : worst(found.map(toLinear), shown(mix(gray.map(toLinear), renderer === 'mobile' ? expected.map(light => Math.min(light, 2)) : expected, opacity(amount))));
            mostMixed = Math.max(mostMixed, off);
        }
    });
    const seen = `at most ${most.toFixed(4)} from the formula, ${mostMixed.toFixed(4)} blended over gray`;
    check(`Godot ${RENDERERS[renderer]}, material of ${name}`, most <= MOST_OFF && mostMixed <= MOST_OFF, seen);
    return mostOfWrong;
}

function testParticles(renderer, name) {
    const { diffuse, even } = formula(name);
    const image = read(file(`${name}_particles`));
    // Largest difference under a change of what particles have.
    const off = change => {
        let most = 0;
        for (let index = 0; index < PARTICLES; index++) {
            const { at, angle, age, frame, amount } = { ...particle(index), ...change(particle(index)) };
            const first = Math.floor(frame * FRAMES + 1e-3);
            for (const [x, y] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
                const place = [x - 0.5, 0.5 - y];
                const turned = ([x, y]) => [x * Math.cos(angle) + y * Math.sin(angle), y * Math.cos(angle) - x * Math.sin(angle)];
                const texel = mix(quarter(first % FRAMES, x, y), quarter((first + 1) % FRAMES, x, y), frame * FRAMES - first);
                const flat = normalOf(texel);
                const normal = [...turned(flat), flat[2]];
                const found = turned(place).map((part, axis) => at[axis] + part * RADIUS);
                const covered = texel[3] / 255 * amount;
                const share = diffuse(normal, LIGHTS[1], toViewer(...found), covered);
                const sum = even(covered, age, 0.25);
                const light = share.map((channel, index) => channel * TINT[index] + sum[index]);
                const seen = turnedBy(particle(index).angle, place).map((part, axis) => particle(index).at[axis] + part * RADIUS);
                most = Math.max(most, worst(colorAt(image, ...seen).map(toLinear), shown(light)));
            }
        }
        return most;
    };
    const most = off(() => ({}));
    const wrong = {
        angle: off(({ angle }) => ({ angle: -angle })),
        frame: off(({ frame }) => ({ frame: Math.floor(frame * FRAMES) / FRAMES })),
    };
    if (name === 'campfire') wrong.age = off(({ age, death }) => ({ age: age * death }));
    const isSeen = Object.values(wrong).every(off => off > 2 * MOST_OFF);
    const others = Object.entries(wrong).map(([what, off]) => `${off.toFixed(2)} by another ${what}`).join(', ');
    check(`Godot ${RENDERERS[renderer]}, particles of ${name}`, most <= MOST_OFF && isSeen, `at most ${most.toFixed(4)} from the formula, ${others}`);
}
function turnedBy(angle, [x, y]) {
    return [x * Math.cos(angle) + y * Math.sin(angle), y * Math.cos(angle) - x * Math.sin(angle)];
}

// Mean opacity over images of black smoke over white, or of alpha.
function meanOpacity(names, opacityOf) {
    const images = names.map(read);
    return Array.from({ length: images[0].width * images[0].height }, (_, at) =>
        images.reduce((sum, image) => sum + opacityOf(image.data.subarray(4 * at, 4 * at + 4)), 0) / images.length);
}
function middle(opacity) {
    const sum = opacity.reduce((sum, value) => sum + value, 0);
    const mean = of => opacity.reduce((total, value, at) => total + value * of(at), 0) / sum;
    const x = mean(at => at % SIDE);
    const y = mean(at => Math.floor(at / SIDE));
    const wide = Math.sqrt(mean(at => ((at % SIDE) - x) ** 2));
    const high = Math.sqrt(mean(at => (Math.floor(at / SIDE) - y) ** 2));
    return { sum: sum / opacity.length, x: x / SIDE, y: y / SIDE, wide: wide / SIDE, high: high / SIDE };
}
function testScene(renderer, name) {
    const decode = renderer === 'gl_compatibility' ? code => code : toLinear;
    const found = middle(meanOpacity(Array.from({ length: IMAGES }, (_, index) => file(`${name}_scene_${index}`)), texel => 1 - decode(texel[0] / 255)));
    const expected = middle(meanOpacity(Array.from({ length: IMAGES }, (_, index) => `opacity_${name}_${index}.png`), texel => texel[3] / 255));
    const numbers = ({ sum, x, y, wide, high }) => `middle (${x.toFixed(3)}, ${y.toFixed(3)}), deviation (${wide.toFixed(3)}, ${high.toFixed(3)}), opacity ${sum.toFixed(3)}`;
    // Godot's turbulence scatters less, and its sprites are not blended before they are lit.
    const isNear = Math.hypot(found.x - expected.x, found.y - expected.y) < 0.06
        && Math.abs(found.wide / expected.wide - 1) < 0.45 && Math.abs(found.high / expected.high - 1) < 0.45
        && Math.abs(found.sum / expected.sum - 1) < 0.5;
    check(`Godot ${RENDERERS[renderer]}, scene of ${name}`, isNear, `${numbers(found)}; in haze ${numbers(expected)}`);
}

for (const renderer of Object.keys(RENDERERS)) {
    const { said } = godot('--rendering-method', renderer, '--fixed-fps', RATE);
    const isRun = said.includes(`renderer ${renderer}`) && said.includes(`drawn ${shots.length}`);
    const found = problems(said);
    check(`Godot ${RENDERERS[renderer]} draws all materials and scenes`, isRun && found.length === 0, found[0] ?? (isRun ? 'no errors' : said.slice(-500)));
    if (!isRun) continue;
    const wrong = LIT.map(name => testMaterial(renderer, name));
    check(`Godot ${RENDERERS[renderer]}: the comparison finds another normal`, Math.max(...wrong) > 2 * MOST_OFF, Math.max(...wrong).toFixed(2));
    for (const name of ['campfire', 'column']) testParticles(renderer, name);
    for (const name of SCENES) testScene(renderer, name);
    for (const line of said.split('\n').filter(line => line.startsWith('box '))) {
        const { folder, min, max } = JSON.parse(line.slice('box '.length));
        const scene = fs.readFileSync(`${folder}/haze_particles.tscn`, 'utf8');
        const box = scene.match(/visibility_aabb = AABB\((.*)\)/)[1].split(', ').map(Number);
        // Godot has grown the box of the centers by the size of the mesh.
        const isInside = min.every((value, axis) => value + 2 >= box[axis]) && max.every((value, axis) => value - 2 <= box[axis] + box[axis + 3]);
        if (!isInside) check(`Godot ${RENDERERS[renderer]}: particles of ${folder} are in their box`, false, `${min}..${max} of ${box}`);
    }
}
endOfChecks();
