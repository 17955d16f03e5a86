// Plays a flipbook that haze has exported, in three.js: frames are mixed along their motion vectors, and read from their own cell alone.
//
//     import { HazeFlipbook } from './haze_flipbook.js';
//     const smoke = await HazeFlipbook.load(); // the files beside this module, or those of a URL
//     scene.add(smoke);
//     smoke.update(seconds); // before each frame; any time, in any order
//
// The smoke is a square of one unit that faces the camera; `scale` sets its size. Its colors are as on the screen: it takes no light
// and no tonemapping. Opacity is that of linear light: render into half floats, as EffectComposer does, with OutputPass as the last
// pass. On a canvas, three.js blends codes, and thin smoke is too dark.
import {
    AddEquation,
    CustomBlending,
    LinearFilter,
    Mesh,
    NoColorSpace,
    NormalBlending,
    OneFactor,
    OneMinusSrcAlphaFactor,
    PlaneGeometry,
    ShaderMaterial,
    SRGBColorSpace,
    TextureLoader,
    Vector2,
} from 'three';

const VERTEX = `
varying vec2 hazeUv;

void main() {
    // Right and up of the camera, as sprites do.
    vec2 size = vec2(length(modelMatrix[0].xyz), length(modelMatrix[1].xyz));
    vec4 center = modelViewMatrix[3];
    gl_Position = projectionMatrix * (center + vec4(position.xy * size, 0.0, 0.0));
    hazeUv = vec2(uv.x, 1.0 - uv.y);
}`;

const FRAGMENT = `
HAZE_FLIPBOOK_GLSL
void main() {
    gl_FragColor = hazeSmoke();
    #include <colorspace_fragment>
}`;

/** Smoke of a flipbook: a mesh, whose `update(seconds)` shows it at a time. */
export class HazeFlipbook extends Mesh {
    /**
     * Loads `flipbook.json` and its sheets.
     * @param {string | URL} [folder] URL of the folder, with a slash at its end; that of this module if left out.
     */
    static async load(folder = new URL('./', import.meta.url)) {
        const response = await fetch(new URL('flipbook.json', folder));
        if (!response.ok) {
            throw new Error(`${response.url}: ${response.status} ${response.statusText}; expected the flipbook.json of an export`);
        }
        const numbers = await response.json();
        if (numbers.version !== 1 || numbers.motion_green !== 'down') {
            throw new Error(`${response.url}: expected version 1, exported with --engine three`);
        }
        if (numbers.emission === 'separate') {
            console.warn(`${response.url}: emission.png is not shown; with --emission contained, color.png has the fire`);
        }
        const loader = new TextureLoader();
        const sheet = async name => {
            const texture = await loader.loadAsync(new URL(name, folder).href);
            texture.flipY = false;
            texture.colorSpace = name === 'color.png' ? SRGBColorSpace : NoColorSpace;
            // Mipmaps would mix frames that are beside each other.
            texture.generateMipmaps = false;
            texture.minFilter = LinearFilter;
            texture.needsUpdate = true;
            return texture;
        };
        const [color, motion] = await Promise.all([sheet('color.png'), sheet('motion.png')]);
        return new HazeFlipbook(numbers, color, motion);
    }

    constructor(numbers, color, motion) {
        const isStraight = numbers.alpha === 'straight';
        const blending = isStraight
            ? { blending: NormalBlending }
            : { blending: CustomBlending, blendEquation: AddEquation, blendSrc: OneFactor, blendDst: OneMinusSrcAlphaFactor };
        const material = new ShaderMaterial({
            vertexShader: VERTEX,
            fragmentShader: FRAGMENT,
            defines: isStraight ? { HAZE_STRAIGHT: '' } : {},
            uniforms: {
                hazeColor: { value: color },
                hazeMotion: { value: motion },
                hazeCells: { value: new Vector2(numbers.columns, numbers.rows) },
                hazeInside: { value: new Vector2(0.5 / numbers.frame_width, 0.5 / numbers.frame_height) },
                hazeFrames: { value: new Vector2(0, 1) },
                hazeShare: { value: 0 },
                hazeMotionScale: { value: new Vector2(numbers.motion_scale, numbers.motion_scale) },
                hazeOpacity: { value: 1 },
            },
            transparent: true,
            depthWrite: false,
            toneMapped: false,
            ...blending,
        });
        super(new PlaneGeometry(numbers.frame_width / Math.max(numbers.frame_width, numbers.frame_height),
            numbers.frame_height / Math.max(numbers.frame_width, numbers.frame_height)), material);
        /** Content of flipbook.json. */
        this.numbers = numbers;
    }

    /** Seconds of the flipbook. */
    get duration() {
        return (this.numbers.frames - (this.numbers.loop ? 0 : 1)) / this.numbers.rate;
    }

    /** From 0, clear, to 1. */
    set opacity(opacity) {
        this.material.uniforms.hazeOpacity.value = opacity;
    }

    get opacity() {
        return this.material.uniforms.hazeOpacity.value;
    }

    /** Shows the smoke at a time. Flipbooks with a loop repeat; others stay at their first and last frame. */
    update(seconds) {
        const { frames, rate, loop } = this.numbers;
        const time = seconds * rate;
        const at = loop ? time - Math.floor(time / frames) * frames : Math.min(Math.max(time, 0), frames - 1);
        const frame = Math.min(Math.floor(at), frames - 1);
        this.material.uniforms.hazeFrames.value.set(frame, loop ? (frame + 1) % frames : Math.min(frame + 1, frames - 1));
        this.material.uniforms.hazeShare.value = at - frame;
    }

    /** Frees the sheets and the shader. */
    dispose() {
        this.material.uniforms.hazeColor.value.dispose();
        this.material.uniforms.hazeMotion.value.dispose();
        this.material.dispose();
        this.geometry.dispose();
    }
}
