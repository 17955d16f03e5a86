// Flipbooks: the modules that go with them, in a target of linear light.
import fs from 'node:fs';
import { PNG } from 'pngjs';
import { over, psnr, squaredError, toCode } from './arithmetic.mjs';
import { openPage } from './browser.mjs';
import { check, folders } from './checks.mjs';

const SIDE = 128;
// Sheet and image are dithered to 8 bits, each by its own positions: 60 dB and more were seen.
const LEAST_PSNR = 55;
// Squared error between two frames with motion vectors, as a share of that without. Not where a cross-fade is as good as this, in
// decibels: frames that are so alike differ by less than the filter of a texture that is moved by a fraction of a texel.
const MOST_OF_A_FADE = 0.9;
const ALIKE = 40;

// Images of the renderer per frame of the flipbook.
const IMAGES = 4;
// Places between two frames. Motion vectors are fitted to the middle; before it, they are not.
const BETWEEN = [1, 2];

// `hasScreen`: the page can also draw codes, as on a canvas.
export async function testFlipbooks(engine, { html, prefix, hasScreen }) {
    const { page, said } = await openPage(html);
    for (const folder of folders(prefix)) {
        const name = folder.slice(prefix.length);
        const { frames, rate, alpha } = JSON.parse(fs.readFileSync(`${folder}/flipbook.json`));
        const images = Array.from({ length: IMAGES * (frames - 1) + 1 }, (_, index) => {
            const { data } = PNG.sync.read(fs.readFileSync(`frame_${name}_${index}.png`));
            return { data, isStraight: alpha === 'straight' };
        });
        const draw = async (background, seconds, hasMotion) => {
            const options = { url: `/${folder}/`, background, seconds, hasMotion, side: SIDE };
            return (await page.evaluate(options => window.readFlipbook(options), options)).map(toCode);
        };
        if (hasScreen && alpha === 'premultiplied') {
            const options = { url: `/${folder}/`, background: 0, seconds: 0, hasMotion: true, isScreen: true, side: SIDE };
            const codes = await page.evaluate(options => window.readFlipbook(options), options);
            const decibels = psnr(codes.map(code => 255 * code), over(images[0], 0));
            check(`${engine}, ${name}, as on a canvas`, decibels >= LEAST_PSNR, `${decibels.toFixed(1)} dB`);
        }
        for (const background of [0, 0.2, 1]) {
            for (let frame = 0; frame < frames; frame++) {
                const codes = await draw(background, frame / rate, true);
                const decibels = psnr(codes, over(images[IMAGES * frame], background));
                check(`${engine}, ${name}, frame ${frame} over ${background}`, decibels >= LEAST_PSNR, `${decibels.toFixed(1)} dB`);
            }
            for (const place of BETWEEN) {
                let moved = 0;
                let faded = 0;
                for (let frame = 0; frame + 1 < frames; frame++) {
                    const expected = over(images[IMAGES * frame + place], background);
                    const seconds = (frame + place / IMAGES) / rate;
                    moved += squaredError(await draw(background, seconds, true), expected);
                    faded += squaredError(await draw(background, seconds, false), expected);
                }
                const share = moved / faded;
                const decibels = 10 * Math.log10((255 * 255 * 3 * SIDE * SIDE * (frames - 1)) / faded);
                const seen = `${share.toFixed(3)} of the squared error of a cross-fade of ${decibels.toFixed(1)} dB`;
                const what = `${engine}, ${name}, ${place / IMAGES} between frames over ${background}`;
                check(what, share <= MOST_OF_A_FADE || decibels > ALIKE, seen);
            }
        }
    }
    check(`${engine}, messages of flipbooks`, said.length === 0, said[0] ?? 'none');
    await page.close();
}
