// Loads the tweaker, with progress. `BUNDLES` is filled in by scripts/web: the bytes of each module.
const BUNDLES = {};

// WebGL reads zeros from a depth texture with the filter of a new texture, which blends mip levels, and wgpu leaves it so.
// Where a sampler reads a texture, the sampler's filter counts.
const webgl = globalThis.WebGL2RenderingContext?.prototype ?? {};
for (const name of ["texStorage2D", "texStorage3D"]) {
    const createStorage = webgl[name];
    webgl[name] = function (target, ...rest) {
        createStorage.call(this, target, ...rest);
        this.texParameteri(target, this.TEXTURE_MIN_FILTER, this.NEAREST);
        this.texParameteri(target, this.TEXTURE_MAG_FILTER, this.NEAREST);
    };
}

// Files that were chosen for saving, by name; browsers without a dialog for that download instead.
const saved = new Map();

// Opens the browser's dialog for saving. Returns the chosen name; undefined if it was cancelled.
globalThis.pickSaveFile = async (suggestedName) => {
    try {
        const types = [{ description: "Preset", accept: { "application/json": [".json"] } }];
        const handle = await showSaveFilePicker({ suggestedName, types });
        saved.set(handle.name, handle);
        return handle.name;
    } catch (error) {
        if (error.name !== "AbortError") {
            console.warn(error);
        }
    }
};

// Writes a file to where it was saved before, or offers it as a download.
globalThis.offerFile = async (name, bytes) => {
    try {
        const handle = saved.get(name);
        if (handle) {
            const file = await handle.createWritable();
            await file.write(bytes);
            return await file.close();
        }
    } catch (error) {
        saved.delete(name);
        console.warn(error);
    }
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
};

function fail(reason) {
    if (document.body.dataset.state !== "failed") {
        document.getElementById("reason").textContent = reason;
        document.body.dataset.state = "failed";
    }
}

// A link to another look, opened in the same tab.
addEventListener("hashchange", () => location.reload());

// A panic of the program ends its frames.
addEventListener("error", (event) => {
    if (event.error instanceof WebAssembly.RuntimeError) {
        fail("it stopped by an internal error; a reload continues with the work of the last seconds.");
    }
});

async function hasWebGpu() {
    try {
        return Boolean(await navigator.gpu?.requestAdapter());
    } catch {
        return false;
    }
}

// A module as it arrives, and the share of its bytes that has.
async function load(name) {
    const response = await fetch(`${name}_bg.wasm`);
    if (!response.ok) {
        throw new Error(`${name}_bg.wasm: ${response.status} ${response.statusText}`);
    }
    const progress = document.getElementById("progress");
    let bytes = 0;
    const count = new TransformStream({
        transform(part, out) {
            bytes += part.length;
            progress.value = bytes / BUNDLES[name];
            out.enqueue(part);
        },
    });
    return new Response(response.body.pipeThrough(count), { headers: { "Content-Type": "application/wasm" } });
}

try {
    // The bundle without WebGL is smaller.
    const asked = new URLSearchParams(location.search).get("api");
    const name = BUNDLES.haze && asked !== "webgl" && (await hasWebGpu()) ? "haze" : "haze_webgl";
    document.body.dataset.program = `./${name}.js`;
    const [program, module_or_path] = await Promise.all([import(`./${name}.js`), load(name)]);
    await program.default({ module_or_path });
} catch (error) {
    fail(String(error));
}
