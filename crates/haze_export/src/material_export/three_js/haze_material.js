$NOTE$// Lights a sprite for each particle in three.js, by its WebGLRenderer. For WebGPURenderer: haze_material_webgpu.js.
import { LinearFilter, ShaderMaterial, SRGBColorSpace, TextureLoader, UniformsLib, UniformsUtils, Vector2 } from 'three';
import { CELLS, loadTextures } from './haze_textures.js';

const FUNCTIONS = `
$UNIFORMS$
$FUNCTIONS$`;

const VERTEX = `
#include <common>
#include <fog_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
$VERTEX_FUNCTIONS$uniform vec2 haze_cells;
uniform float haze_frames;
uniform float haze_frame;
uniform float haze_amount;
// Angle, age, frame and amount; 0, 0, 0 and 1 without the attribute.
attribute vec4 hazeParticle;
varying vec2 haze_uv;
varying vec2 haze_turn;
varying float haze_particle_amount;
$HEAT_PARAMETERS$varying vec3 vViewPosition;

void main() {
    mat4 model = modelMatrix;
    #ifdef USE_INSTANCING
        model = modelMatrix * instanceMatrix;
    #endif
    // Turns the square towards the camera.
    vec2 corner = position.xy * vec2(length(model[0].xyz), length(model[1].xyz));
    haze_turn = vec2(cos(hazeParticle.x), sin(hazeParticle.x));
    vec4 mvPosition = viewMatrix * model[3];
    mvPosition.xy += vec2(dot(corner, haze_turn), dot(corner.yx, haze_turn * vec2(1.0, -1.0)));
    gl_Position = projectionMatrix * mvPosition;
    vViewPosition = -mvPosition.xyz;
    float frame = mod(floor(haze_frame + hazeParticle.z * haze_frames), haze_frames);
    vec2 cell = vec2(mod(frame, haze_cells.x), floor(frame / haze_cells.x));
    haze_uv = (vec2(uv.x, 1.0 - uv.y) + cell) / haze_cells;
    haze_particle_amount = haze_amount * hazeParticle.w;
$HEAT$    // Names that the chunks of shadow read.
    vec4 worldPosition = inverse(viewMatrix) * mvPosition;
    vec3 transformedNormal = vec3(0.0, 0.0, 1.0);
    #include <shadowmap_vertex>
    #include <logdepthbuf_vertex>
    #include <fog_vertex>
}`;

const FRAGMENT = `
#include <common>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
${FUNCTIONS}uniform sampler2D haze_sprite;
varying vec2 haze_uv;
varying vec2 haze_turn;
varying float haze_particle_amount;
$HEAT_VARYING$varying vec3 vViewPosition;

// Called for each light. A surface of three.js sends back 1/pi of a light of intensity 1.
void haze_add(IncidentLight from, vec3 at, vec3 normal, vec3 to_viewer, vec3 coat, float amount, inout vec3 light) {
    light += $DIFFUSE$ * from.color * RECIPROCAL_PI;
}
#define RE_Direct haze_add

void main() {
    #include <logdepthbuf_fragment>
    vec4 texel = texture2D(haze_sprite, haze_uv);
    vec3 normal = normalize(texel.rgb * 2.0 - 1.0);
    normal.xy = vec2(dot(normal.xy, haze_turn), dot(normal.yx, haze_turn * vec2(1.0, -1.0)));
    // Names that the chunk of lights reads.
    float material = texel.a * haze_particle_amount;
    vec3 reflectedLight = $EVEN_LIGHT$;
    #include <lights_fragment_begin>
    gl_FragColor = vec4(reflectedLight, $COVERAGE$);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
    #include <fog_fragment>
}`;

/** Material of smoke for squares (PlaneGeometry), alone or as an InstancedMesh. README.md says how to use it. */
export class HazeMaterial extends ShaderMaterial {
    /** Loads the textures from a folder: a URL with a slash at its end, or that of this module. */
    static async load(folder) {
        return new HazeMaterial(await loadTextures({ LinearFilter, SRGBColorSpace, TextureLoader }, folder));
    }

    constructor(textures) {
        const numbers = { frame: { value: 0 }, amount: { value: 1 }$HEAT_VALUE$ };
        const { columns, rows, frames } = CELLS;
        const uniforms = {
            ...UniformsUtils.merge([UniformsLib.lights, UniformsLib.fog]),
            haze_cells: { value: new Vector2(columns, rows) },
            haze_frames: { value: frames },
        };
        for (const [name, number] of Object.entries(numbers)) uniforms[`haze_${name}`] = number;
        for (const [name, value] of Object.entries(textures)) uniforms[`haze_${name}`] = { value };
        super({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, depthWrite: false, lights: true, fog: true });
        this.defaultAttributeValues.hazeParticle = [0, 0, 0, 1];
        this.textures = textures;
        /** Values for all particles: first frame, amount, heat. */
        this.numbers = numbers;
    }

    /** Frees the shader and the textures. */
    dispose() {
        super.dispose();
        Object.values(this.textures).forEach(texture => texture.dispose());
    }
}
