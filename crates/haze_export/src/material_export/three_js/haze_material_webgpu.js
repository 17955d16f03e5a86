$NOTE$// Lights a sprite for each particle in three.js, by its WebGPURenderer. For WebGLRenderer: haze_material.js.
import { LightingModel, LinearFilter, NodeMaterial, SRGBColorSpace, TextureLoader } from 'three/webgpu';
import * as tsl from 'three/tsl';
import { CELLS, loadTextures } from './haze_textures.js';

const { float, mix, texture, uniform, varying, vec2, vec3 } = tsl;
const { columns, rows, frames } = CELLS;
$CONSTANTS$
// Coordinates lead from the center of the first texel to that of the last.
function sampleRamp(ramp, u, v = 0) {
    const size = vec2(ramp.image.width, ramp.image.height);
    const texel = vec2(u, v).saturate().mul(size.sub(1));
    return $SAMPLE$.rgb;
}

$PAINTED$// Angle, age, frame and amount; 0, 0, 0 and 1 without the attribute.
const particle = tsl.Fn((_, builder) =>
    builder.hasGeometryAttribute('hazeParticle') ? tsl.attribute('hazeParticle', 'vec4') : tsl.vec4(0, 0, 0, 1))();
const turn = vec2(particle.x.cos(), particle.x.sin());
const turned = (at, turn) => vec2(at.dot(turn), at.yx.dot(turn.mul(vec2(1, -1))));

class HazeLight extends LightingModel {
    constructor(smoke) {
        super();
        this.smoke = smoke;
    }

    // A surface of three.js sends back 1/pi of a light of intensity 1.
    direct({ lightDirection, lightColor, reflectedLight }) {
        reflectedLight.directDiffuse.addAssign(this.smoke.diffuse(lightDirection).mul(lightColor).div(Math.PI));
    }
}

/** Material of smoke for squares (PlaneGeometry), alone or as an InstancedMesh. README.md says how to use it. */
export class HazeNodeMaterial extends NodeMaterial {
    /** Loads the textures from a folder: a URL with a slash at its end, or that of this module. */
    static async load(folder) {
        return new HazeNodeMaterial(await loadTextures({ LinearFilter, SRGBColorSpace, TextureLoader }, folder));
    }

    constructor(textures) {
        super();
        this.textures = textures;
        Object.assign(this, { lights: true, transparent: true, depthWrite: false });
        /** Values for all particles: first frame, amount, heat. */
        this.numbers = { frame: uniform(0), amount: uniform(1)$HEAT_UNIFORM$ };
        const frame = this.numbers.frame.add(particle.z.mul(frames)).floor().mod(frames);
        const cell = vec2(frame.mod(columns), frame.div(columns).floor());
        const texel = texture(textures.sprite, varying(vec2(tsl.uv().x, tsl.uv().y.oneMinus()).add(cell).div(vec2(columns, rows))));
        const sprite = texel.rgb.mul(2).sub(1).normalize();
        const normal = vec3(turned(sprite.xy, varying(turn)), sprite.z);
        const amount = texel.a.mul(varying(particle.w.mul(this.numbers.amount)));
        const covered = amount.mul(BOOST).saturate();
$HEAT$        this.colorNode = vec3(1);
        this.opacityNode = $COVERAGE$;
        this.emissiveNode = $EVEN_LIGHT$;
        this.diffuse = toLight => {
            const at = [normal.dot(toLight).mul(0.5).add(0.5), covered];
            return $DIFFUSE$.mul(DIFFUSE_INTENSITY);
        };
    }

    setupLightingModel() {
        return new HazeLight(this);
    }

    // Instances are moved below, as a whole.
    setupPosition() {
        return tsl.positionLocal;
    }

    // Turns the square towards the camera.
    setupPositionView({ object }) {
        const isInstance = object.isInstancedMesh;
        const model = isInstance ? tsl.modelWorldMatrix.mul(tsl.referenceAttribute('instanceMatrix', 'mat4')) : tsl.modelWorldMatrix;
        const size = vec2(model.element(0).xyz.length(), model.element(1).xyz.length());
        const corner = turned(tsl.positionGeometry.xy.mul(size), turn);
        return tsl.cameraViewMatrix.mul(model.element(3)).xyz.add(vec3(corner, 0));
    }

    /** Frees the shader and the textures. */
    dispose() {
        super.dispose();
        Object.values(this.textures).forEach(texture => texture.dispose());
    }
}
