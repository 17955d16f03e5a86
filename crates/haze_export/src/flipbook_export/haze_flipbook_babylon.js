// Plays a flipbook that haze has exported, in Babylon.js (WebGL 2): frames are mixed along their motion vectors, and read from their own
// cell alone.
//
//     import { HazeFlipbook } from './haze_flipbook.js';
//     // BABYLON: the global of babylon.js, or `import * as BABYLON from '@babylonjs/core'`.
//     const smoke = await HazeFlipbook.load(BABYLON, scene); // the files beside this module, or those of a URL
//     smoke.update(seconds); // before each frame; any time, in any order
//
// `smoke.mesh` is a square of one unit that faces the camera; its `scaling` sets its size. Its colors are as on the screen: it takes no
// light and no fog. Opacity is that of linear light: use a DefaultRenderingPipeline with `hdr`. On a canvas, Babylon.js blends codes, and
// thin smoke is too dark.
const VERTEX = `
precision highp float;
attribute vec3 position;
attribute vec2 uv;
uniform mat4 world;
uniform mat4 view;
uniform mat4 projection;
varying vec2 hazeUv;

void main() {
    // Right and up of the camera, as sprites do.
    vec2 size = vec2(length(world[0].xyz), length(world[1].xyz));
    vec4 center = view * world[3];
    gl_Position = projection * (center + vec4(position.xy * size, 0.0, 0.0));
    hazeUv = vec2(uv.x, 1.0 - uv.y);
}`;

const FRAGMENT = `
precision highp float;
uniform float hazeEncodes;
HAZE_FLIPBOOK_GLSL
void main() {
    gl_FragColor = hazeSmoke();
    if (hazeEncodes > 0.5) {
        vec3 high = 1.055 * pow(max(gl_FragColor.rgb, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
        gl_FragColor.rgb = mix(gl_FragColor.rgb * 12.92, high, step(vec3(0.0031308), gl_FragColor.rgb));
    }
}`;

const UNIFORMS = [
    'world', 'view', 'projection', 'hazeCells', 'hazeInside', 'hazeFrames', 'hazeShare', 'hazeMotionScale', 'hazeOpacity', 'hazeEncodes',
];

/** Smoke of a flipbook: a mesh, and `update(seconds)`, which shows it at a time. */
export class HazeFlipbook {
    /**
     * Loads `flipbook.json` and its sheets into a scene.
     * @param {string | URL} [folder] URL of the folder, with a slash at its end; that of this module if left out.
     */
    static async load(BABYLON, scene, folder = new URL('./', import.meta.url)) {
        const response = await fetch(new URL('flipbook.json', folder));
        if (!response.ok) {
            throw new Error(`${response.url}: ${response.status} ${response.statusText}; expected the flipbook.json of an export`);
        }
        const numbers = await response.json();
        if (numbers.version !== 1 || numbers.motion_green !== 'down') {
            throw new Error(`${response.url}: expected version 1, exported with --engine babylon`);
        }
        if (numbers.emission === 'separate') {
            console.warn(`${response.url}: emission.png is not shown; with --emission contained, color.png has the fire`);
        }
        const sheet = (name, useSRGBBuffer) => new Promise((resolve, reject) => {
            const { href } = new URL(name, folder);
            const texture = new BABYLON.Texture(href, scene, {
                // Mipmaps would mix frames that are beside each other.
                noMipmap: true,
                invertY: false,
                samplingMode: BABYLON.Texture.BILINEAR_SAMPLINGMODE,
                useSRGBBuffer,
                onLoad: () => {
                    // Without this, filters would mix codes.
                    if (useSRGBBuffer && texture.gammaSpace) reject(new Error(`${href}: sRGB textures need WebGL 2`));
                    resolve(texture);
                },
                onError: message => reject(new Error(`${href}: ${message ?? 'not loaded'}; expected a sheet of the export`)),
            });
            texture.wrapU = BABYLON.Texture.CLAMP_ADDRESSMODE;
            texture.wrapV = BABYLON.Texture.CLAMP_ADDRESSMODE;
            // Motion vectors differ from texel to texel. An anisotropic filter takes that for a slope, and blurs.
            texture.anisotropicFilteringLevel = 1;
        });
        const [color, motion] = await Promise.all([sheet('color.png', true), sheet('motion.png', false)]);
        return new HazeFlipbook(BABYLON, scene, numbers, color, motion);
    }

    constructor(BABYLON, scene, numbers, color, motion) {
        const isStraight = numbers.alpha === 'straight';
        const source = { vertexSource: VERTEX, fragmentSource: FRAGMENT };
        const material = new BABYLON.ShaderMaterial('haze', scene, source, {
            attributes: ['position', 'uv'],
            uniforms: UNIFORMS,
            samplers: ['hazeColor', 'hazeMotion'],
            defines: isStraight ? ['#define HAZE_STRAIGHT'] : [],
            needAlphaBlending: true,
        });
        const { ALPHA_COMBINE, ALPHA_PREMULTIPLIED_PORTERDUFF } = BABYLON.Constants;
        material.alphaMode = isStraight ? ALPHA_COMBINE : ALPHA_PREMULTIPLIED_PORTERDUFF;
        material.disableDepthWrite = true;
        material.backFaceCulling = false;
        material.setTexture('hazeColor', color);
        material.setTexture('hazeMotion', motion);
        material.setVector2('hazeCells', new BABYLON.Vector2(numbers.columns, numbers.rows));
        material.setVector2('hazeInside', new BABYLON.Vector2(0.5 / numbers.frame_width, 0.5 / numbers.frame_height));
        material.setVector2('hazeMotionScale', new BABYLON.Vector2(numbers.motion_scale, numbers.motion_scale));
        material.setFloat('hazeOpacity', 1);
        // A pipeline encodes colors itself.
        material.onBindObservable.add(() => {
            const isLinear = scene.imageProcessingConfiguration.applyByPostProcess;
            material.getEffect()?.setFloat('hazeEncodes', isLinear ? 0 : 1);
        });
        const side = Math.max(numbers.frame_width, numbers.frame_height);
        const size = { width: numbers.frame_width / side, height: numbers.frame_height / side };
        /** Square with the smoke. */
        this.mesh = BABYLON.MeshBuilder.CreatePlane('haze', size, scene);
        this.mesh.material = material;
        /** Content of flipbook.json. */
        this.numbers = numbers;
        this.frames = new BABYLON.Vector2(0, 0);
        this.update(0);
    }

    /** Seconds of the flipbook. */
    get duration() {
        return (this.numbers.frames - (this.numbers.loop ? 0 : 1)) / this.numbers.rate;
    }

    /** From 0, clear, to 1. */
    set opacity(opacity) {
        this.mesh.material.setFloat('hazeOpacity', opacity);
    }

    /** Shows the smoke at a time. Flipbooks with a loop repeat; others stay at their first and last frame. */
    update(seconds) {
        const { frames, rate, loop } = this.numbers;
        const time = seconds * rate;
        const at = loop ? time - Math.floor(time / frames) * frames : Math.min(Math.max(time, 0), frames - 1);
        const frame = Math.min(Math.floor(at), frames - 1);
        this.frames.set(frame, loop ? (frame + 1) % frames : Math.min(frame + 1, frames - 1));
        this.mesh.material.setVector2('hazeFrames', this.frames);
        this.mesh.material.setFloat('hazeShare', at - frame);
    }

    /** Frees the mesh, the sheets and the shader. */
    dispose() {
        this.mesh.dispose(false, true);
    }
}
