// Plays a flipbook that haze has exported, in PlayCanvas (WebGL 2): frames are mixed along their motion vectors, and read from their own
// cell alone.
//
//     import * as pc from 'playcanvas';
//     import { HazeFlipbook } from './haze_flipbook.js';
//     const smoke = await HazeFlipbook.load(pc, app); // the files beside this module, or those of a URL
//     app.root.addChild(smoke.entity);
//     smoke.update(seconds); // before each frame; any time, in any order
//
// `smoke.entity` is a square of one unit that faces the camera; its scale sets its size. Its colors are as on the screen: it takes no
// light, no fog and no tonemapping. Opacity is that of linear light: use a CameraFrame. On a canvas, PlayCanvas blends codes, and thin
// smoke is too dark.
const VERTEX = `
attribute vec3 vertex_position;
attribute vec2 vertex_texCoord0;
uniform mat4 matrix_model;
uniform mat4 matrix_view;
uniform mat4 matrix_projection;
varying vec2 hazeUv;

void main() {
    // Right and up of the camera, as sprites do.
    vec2 size = vec2(length(matrix_model[0].xyz), length(matrix_model[1].xyz));
    vec4 center = matrix_view * matrix_model[3];
    gl_Position = matrix_projection * (center + vec4(vertex_position.xy * size, 0.0, 0.0));
    hazeUv = vertex_texCoord0;
}`;

const FRAGMENT = `
HAZE_FLIPBOOK_GLSL
void main() {
    gl_FragColor = hazeSmoke();
    // As a camera asks for it. The engine's own function is a power of 2.2, whose codes are not those of the sheet.
    #if (GAMMA == SRGB)
        vec3 high = 1.055 * pow(max(gl_FragColor.rgb, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
        gl_FragColor.rgb = mix(gl_FragColor.rgb * 12.92, high, step(vec3(0.0031308), gl_FragColor.rgb));
    #endif
}`;

/** Smoke of a flipbook: an entity, and `update(seconds)`, which shows it at a time. */
export class HazeFlipbook {
    /**
     * Loads `flipbook.json` and its sheets.
     * @param {string | URL} [folder] URL of the folder, with a slash at its end; that of this module if left out.
     */
    static async load(pc, app, folder = new URL('./', import.meta.url)) {
        const get = async name => {
            const response = await fetch(new URL(name, folder));
            if (!response.ok) {
                throw new Error(`${response.url}: ${response.status} ${response.statusText}; expected the ${name} of an export`);
            }
            return response;
        };
        const response = await get('flipbook.json');
        const numbers = await response.json();
        if (numbers.version !== 1 || numbers.motion_green !== 'down') {
            throw new Error(`${response.url}: expected version 1, exported with --engine playcanvas`);
        }
        if (numbers.emission === 'separate') {
            console.warn(`${response.url}: emission.png is not shown; with --emission contained, color.png has the fire`);
        }
        const sheet = async (name, format) => {
            const blob = await (await get(name)).blob();
            const image = await createImageBitmap(blob, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
            const texture = new pc.Texture(app.graphicsDevice, {
                name,
                width: image.width,
                height: image.height,
                format,
                // Mipmaps would mix frames that are beside each other.
                mipmaps: false,
                minFilter: pc.FILTER_LINEAR,
                magFilter: pc.FILTER_LINEAR,
                addressU: pc.ADDRESS_CLAMP_TO_EDGE,
                addressV: pc.ADDRESS_CLAMP_TO_EDGE,
            });
            texture.setSource(image);
            return texture;
        };
        const sheets = [sheet('color.png', pc.PIXELFORMAT_SRGBA8), sheet('motion.png', pc.PIXELFORMAT_RGBA8)];
        return new HazeFlipbook(pc, app, numbers, ...await Promise.all(sheets));
    }

    constructor(pc, app, numbers, color, motion) {
        const isStraight = numbers.alpha === 'straight';
        const material = new pc.ShaderMaterial({
            uniqueName: `HazeFlipbook ${numbers.alpha}`,
            vertexGLSL: VERTEX,
            fragmentGLSL: FRAGMENT,
            attributes: { vertex_position: pc.SEMANTIC_POSITION, vertex_texCoord0: pc.SEMANTIC_TEXCOORD0 },
        });
        if (isStraight) material.setDefine('HAZE_STRAIGHT', true);
        material.blendType = isStraight ? pc.BLEND_NORMAL : pc.BLEND_PREMULTIPLIED;
        material.depthWrite = false;
        material.cull = pc.CULLFACE_NONE;
        material.setParameter('hazeColor', color);
        material.setParameter('hazeMotion', motion);
        material.setParameter('hazeCells', [numbers.columns, numbers.rows]);
        material.setParameter('hazeInside', [0.5 / numbers.frame_width, 0.5 / numbers.frame_height]);
        material.setParameter('hazeMotionScale', [numbers.motion_scale, numbers.motion_scale]);
        material.setParameter('hazeOpacity', 1);
        material.update();
        const side = 2 * Math.max(numbers.frame_width, numbers.frame_height);
        const [x, y] = [numbers.frame_width / side, numbers.frame_height / side];
        const mesh = new pc.Mesh(app.graphicsDevice);
        mesh.setPositions([-x, -y, 0, x, -y, 0, x, y, 0, -x, y, 0]);
        mesh.setUvs(0, [0, 1, 1, 1, 1, 0, 0, 0]);
        mesh.setIndices([0, 1, 2, 0, 2, 3]);
        mesh.update();
        /** Square with the smoke. */
        this.entity = new pc.Entity('haze');
        this.entity.addComponent('render', {
            meshInstances: [new pc.MeshInstance(mesh, material)],
            castShadows: false,
            receiveShadows: false,
        });
        this.material = material;
        this.sheets = [color, motion];
        /** Content of flipbook.json. */
        this.numbers = numbers;
        this.update(0);
    }

    /** Seconds of the flipbook. */
    get duration() {
        return (this.numbers.frames - (this.numbers.loop ? 0 : 1)) / this.numbers.rate;
    }

    /** From 0, clear, to 1. */
    set opacity(opacity) {
        this.material.setParameter('hazeOpacity', opacity);
    }

    /** Shows the smoke at a time. Flipbooks with a loop repeat; others stay at their first and last frame. */
    update(seconds) {
        const { frames, rate, loop } = this.numbers;
        const time = seconds * rate;
        const at = loop ? time - Math.floor(time / frames) * frames : Math.min(Math.max(time, 0), frames - 1);
        const frame = Math.min(Math.floor(at), frames - 1);
        this.material.setParameter('hazeFrames', [frame, loop ? (frame + 1) % frames : Math.min(frame + 1, frames - 1)]);
        this.material.setParameter('hazeShare', at - frame);
    }

    /** Frees the entity, the sheets and the shader. */
    dispose() {
        this.entity.destroy();
        this.material.destroy();
        this.sheets.forEach(sheet => sheet.destroy());
    }
}
