// One page in headless Chromium, served with the folders that it names: what the checks in a browser share.
//   await inPage({ playwright, browserPath, page, served }, async (tab) => ...)
// `page`: its HTML, which sets window.ready when it is; `served`: { top: folder }, so that /top/a/b is folder/a/b; `drawn`: with WebGL, in
// software. What it leaves out: finding playwright-core and a browser, which each check says for itself that it lacks.
import { createServer } from 'node:http';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';

const types = { '.js': 'text/javascript', '.mjs': 'text/javascript', '.glb': 'model/gltf-binary', '.html': 'text/html', '.wasm': 'application/wasm' };

export async function inPage({ playwright, browserPath, page, served, drawn = false }, use) {
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
    if (path === '/') return response.setHeader('Content-Type', 'text/html').end(page);
    const [, top, ...rest] = path.split('/');
    const file = join(served[top] ?? '/nowhere', ...rest);
    if (path.includes('..') || !existsSync(file)) return response.writeHead(404).end();
    response.setHeader('Content-Type', types[extname(file)] ?? 'application/octet-stream').end(readFileSync(file));
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const profile = mkdtempSync(join(tmpdir(), 'surefoot-page-'));
  const browser = await playwright.chromium.launchPersistentContext(profile, {
    executablePath: browserPath,
    headless: true,
    args: ['--no-sandbox', ...(drawn ? ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'] : ['--disable-gpu']), '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
  try {
    const tab = await browser.newPage();
    tab.on('pageerror', (error) => console.error(String(error)));
    await tab.goto(`http://127.0.0.1:${server.address().port}/`);
    await tab.waitForFunction('window.ready', null, { timeout: 30000 });
    await use(tab);
  } finally {
    await browser.close();
    server.close();
    rmSync(profile, { recursive: true, force: true });
  }
}
