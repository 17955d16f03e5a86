// Browser and server.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import puppeteer from 'puppeteer-core';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png' };
export const server = http.createServer((request, response) => {
    const file = path.join('.', path.normalize(decodeURIComponent(request.url.split('?')[0])));
    if (!fs.existsSync(file) || !fs.statSync(file).isFile()) return response.writeHead(404).end();
    response.writeHead(200, {
        'Content-Type': types[path.extname(file)] ?? 'application/octet-stream',
        'Cross-Origin-Opener-Policy': 'same-origin',
        'Cross-Origin-Embedder-Policy': 'require-corp',
    });
    fs.createReadStream(file).pipe(response);
});
await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
export const address = `http://127.0.0.1:${server.address().port}`;
export const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
        '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist',
        '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
    ],
    protocolTimeout: 600000,
});

/** Opens one of the pages here. `said` collects its warnings and errors. */
export async function openPage(html) {
    const page = await browser.newPage();
    const said = [];
    page.on('console', message => {
        if (['error', 'warn'].includes(message.type())) said.push(message.text());
    });
    page.on('pageerror', error => said.push(String(error)));
    await page.goto(`${address}/${html}`);
    await page.waitForFunction('window.isLoaded').catch(error => {
        throw new Error(`${html}: ${error}; the page said: ${said.join('; ')}`);
    });
    return { page, said };
}
