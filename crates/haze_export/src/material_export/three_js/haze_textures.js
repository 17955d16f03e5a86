// Textures of the material, for haze_material.js and haze_material_webgpu.js.
const RAMPS = [$RAMPS$];

// Layout of sprite.png.
export const CELLS = { columns: $COLUMNS$, rows: $ROWS$, frames: $FRAMES$ };

/** Loads the textures from a folder, a URL with a slash at its end; that of this module if left out. */
export async function loadTextures({ LinearFilter, SRGBColorSpace, TextureLoader }, folder = new URL('./', import.meta.url)) {
    const loader = new TextureLoader();
    const load = async name => {
        const { href } = new URL(`${name}.png`, folder);
        const texture = await loader.loadAsync(href).catch(() => {
            throw new Error(`${href}: not loaded; expected a texture of the exported material`);
        });
        texture.flipY = false;
        if (name !== 'sprite') {
            texture.colorSpace = SRGBColorSpace;
            texture.generateMipmaps = false;
            texture.minFilter = LinearFilter;
        }
        return [name, texture];
    };
    return Object.fromEntries(await Promise.all(['sprite', ...RAMPS].map(load)));
}
