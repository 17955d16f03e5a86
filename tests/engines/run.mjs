// Opens what haze has exported in engines that run in a browser. scripts/test_engines prepares the folder that it runs in:
// `flipbook_ENGINE_NAME` with `frame_NAME_N.png` at its times and three between, `sheet_NAME` with `sprite_NAME_N.png`, and materials `godot_NAME`, `three_NAME` and `wgsl_NAME`.
import { browser, server } from './browser.mjs';
import { endOfChecks } from './checks.mjs';
import { testFlipbooks } from './flipbooks.mjs';
import { testGodot } from './godot.mjs';
import { testSpriteSheets } from './sprite_sheets.mjs';
import { testThreeMaterials } from './three_materials.mjs';

await testFlipbooks('three.js', { html: 'three.html', prefix: 'flipbook_three_' });
await testFlipbooks('Babylon.js', { html: 'babylon.html', prefix: 'flipbook_babylon_', hasScreen: true });
await testFlipbooks('PlayCanvas', { html: 'playcanvas.html', prefix: 'flipbook_playcanvas_', hasScreen: true });
await testSpriteSheets('PixiJS', 'pixi.html');
await testSpriteSheets('Phaser', 'phaser.html');
await testThreeMaterials('three.js', { page: 'three.html', module: 'haze_material.js', name: 'HazeMaterial' });
for (const [renderer, page] of [['three.js, WebGPU', 'three_webgpu.html'], ['three.js, nodes in WebGL 2', 'three_webgpu.html?webgl']]) {
    await testThreeMaterials(renderer, { page, module: 'haze_material_webgpu.js', name: 'HazeNodeMaterial' });
}
await testGodot();
await browser.close();
server.close();
endOfChecks();
