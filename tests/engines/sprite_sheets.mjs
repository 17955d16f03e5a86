// Sprite sheets: `color.json` with `color.png`, straight, in engines that blend codes.
import fs from 'node:fs';
import { PNG } from 'pngjs';
import { psnr } from './arithmetic.mjs';
import { openPage } from './browser.mjs';
import { check, folders } from './checks.mjs';

// Sheet and image are dithered to 8 bits, each by its own positions, and the product with alpha is rounded: 61 dB and more were seen.
const LEAST_PSNR = 55;

export async function testSpriteSheets(engine, html) {
    const { page, said } = await openPage(html);
    for (const folder of folders('sheet_')) {
        const name = folder.slice('sheet_'.length);
        const numbers = JSON.parse(fs.readFileSync(`${folder}/flipbook.json`));
        const { frame_width: width, frame_height: height, columns } = numbers;
        const url = `/${folder}/color.json`;
        const sheet = await page.evaluate(url => window.openSheet(url), url);
        const counts = `${sheet.frames.length} of ${sheet.all} frames in ${sheet.animations ?? 'no'} animations`;
        check(`${engine}, ${name}, frames`, sheet.frames.length === numbers.frames && sheet.all === numbers.frames, counts);
        if (sheet.animation !== undefined) {
            check(`${engine}, ${name}, animation`, sheet.animations === 1 && sheet.animation === name, sheet.animation);
        }
        for (const [index, frame] of sheet.frames.entries()) {
            const [x, y] = [(index % columns) * width, Math.floor(index / columns) * height];
            const isRight = frame.x === x && frame.y === y && frame.width === width && frame.height === height
                && frame.name === `${name}_${String(index).padStart(4, '0')}`;
            const seen = `${frame.name}: ${frame.width}x${frame.height} at ${frame.x}, ${frame.y}`;
            check(`${engine}, ${name}, rectangle of frame ${index}`, isRight, seen);
            const { data } = PNG.sync.read(fs.readFileSync(`sprite_${name}_${index}.png`));
            for (const background of [0, 124, 255]) {
                const options = { url, name: frame.name, animation: sheet.animation, index, background, width, height };
                const codes = await page.evaluate(options => window.drawFrame(options), options);
                const decibels = psnr(codes, overCodes(data, background));
                const isSame = codes.length === 3 * width * height && decibels >= LEAST_PSNR;
                check(`${engine}, ${name}, sprite ${index} over ${background}`, isSame, `${decibels.toFixed(1)} dB`);
            }
        }
    }
    check(`${engine}, messages of sprite sheets`, said.length === 0, said[0] ?? 'none');
    await page.close();
}

// Codes of a straight image over a background, blended as they are.
function overCodes(data, background) {
    const codes = [];
    for (let at = 0; at < data.length; at += 4) {
        const alpha = data[at + 3] / 255;
        for (let channel = 0; channel < 3; channel++) codes.push(data[at + channel] * alpha + background * (1 - alpha));
    }
    return codes;
}
