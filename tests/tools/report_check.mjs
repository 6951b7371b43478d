// Opens the pages of audits in headless Chromium and uses them as a person would:
//   node report_check.mjs FOLDER [CHROMIUM] [PICTURES]
// For every FOLDER/NAME.html, light and dark: no message of an error, no dialog (a hostile name that ran), no request beyond the file, canvases that
// show something and change with the playhead, keys and clicks that move it. With PICTURES it saves a screenshot of each there.
// Needs playwright-core, found as in three_check.mjs.
import { createRequire } from 'node:module';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium', pictures] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node report_check.mjs FOLDER [CHROMIUM] [PICTURES]');
  process.exit(2);
}
let playwright;
try {
  playwright = require('playwright-core');
} catch {
  console.log('skipped: no playwright-core (npm install it, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}
if (!existsSync(browserPath)) {
  console.log(`skipped: no browser at ${browserPath}`);
  process.exit(0);
}

// What a canvas shows: how many colours, and a number that changes with it.
const seen = (tab, id) => tab.evaluate((id) => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const colours = new Set();
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) {
    const colour = (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
    colours.add(colour);
    sum = (Math.imul(sum, 31) + colour) | 0;
  }
  return { colours: colours.size, sum };
}, id);

async function use(tab, problems) {
  const frame = () => tab.evaluate(() => window.surefoot.frame);
  const must = (holds, what) => { if (!holds) problems.push(what); };
  await tab.evaluate(() => window.surefoot.open(0));
  const { clips, frames, flags } = await tab.evaluate(() => ({
    clips: window.surefoot.clips.length, frames: window.surefoot.clips[0].frames, flags: window.surefoot.clips[0].flags.length,
  }));
  must((await tab.locator('#flags tr[data-id]').count()) === flags, 'the table does not list every flag');
  await tab.keyboard.press('Home');
  must((await frame()) === 0, 'Home does not lead to the first frame');
  const views = ['stage', 'top', 'timeline'], before = {};
  for (const id of views) {
    before[id] = await seen(tab, id);
    must(before[id].colours > 12, `the ${id} is blank: ${before[id].colours} colours`);
  }
  await tab.keyboard.press('ArrowRight');
  must((await frame()) === 1, 'an arrow does not step by a frame');
  await tab.keyboard.press('End');
  must((await frame()) === frames - 1, 'End does not lead to the last frame');
  for (const id of views) must((await seen(tab, id)).sum !== before[id].sum, `the ${id} does not follow the playhead`);
  await tab.locator('#scrub').evaluate((scrub) => { scrub.value = 7; scrub.dispatchEvent(new Event('input')); });
  must((await frame()) === 7, 'the slider does not scrub');
  await tab.locator('#timeline').scrollIntoViewIfNeeded();
  const box = await tab.locator('#timeline').boundingBox();
  await tab.mouse.move(box.x + 160, box.y + 12);
  await tab.mouse.down();
  await tab.mouse.move(box.x + 148 + (box.width - 158) / 2, box.y + 12, { steps: 4 });
  await tab.mouse.up();
  must(Math.abs((await frame()) - (frames - 1) / 2) <= 1.5, `dragging over the timeline leads to ${await frame()} of ${frames}`);
  const still = await seen(tab, 'stage');
  await tab.locator('#stage').scrollIntoViewIfNeeded();
  const stage = await tab.locator('#stage').boundingBox();
  await tab.mouse.move(stage.x + 200, stage.y + 150);
  await tab.mouse.down();
  await tab.mouse.move(stage.x + 320, stage.y + 170, { steps: 3 });
  await tab.mouse.up();
  must((await seen(tab, 'stage')).sum !== still.sum, 'the figure does not turn under the mouse');
  if (flags > 0) {
    await tab.locator('#flags tr[data-id]').first().click();
    must((await tab.locator('#flags tr.here').count()) > 0, 'a click on a flag does not lead into it');
    must((await tab.locator('#now span').count()) > 0, 'the flag under the playhead is not told');
  }
  await tab.keyboard.press('Home');
  await tab.keyboard.press(' ');
  await tab.waitForTimeout(400);
  must((await frame()) > 0, 'it does not play');
  await tab.keyboard.press(' ');
  must(!(await tab.evaluate(() => window.surefoot.playing)), 'it does not pause');
  if (clips > 1) {
    await tab.locator('#clips').selectOption('1');
    must((await tab.locator('#name').textContent()) === (await tab.evaluate(() => window.surefoot.clips[1].name)), 'the select opens no clip');
  }
  const index = await tab.evaluate(() => { window.surefoot.open(0); return window.surefoot.frame; });
  must(Number.isFinite(index), 'it does not open again');
}

const profile = mkdtempSync(join(tmpdir(), 'surefoot-report-'));
const browser = await playwright.chromium.launchPersistentContext(profile, {
  executablePath: browserPath,
  headless: true,
  viewport: { width: 1440, height: 900 },
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
const pages = readdirSync(folder).filter((name) => name.endsWith('.html')).sort();
let bad = 0;
try {
  for (const name of pages) {
    const problems = [];
    for (const scheme of ['light', 'dark']) {
      const tab = await browser.newPage();
      await tab.emulateMedia({ colorScheme: scheme });
      tab.on('pageerror', (error) => problems.push(`${scheme}: ${error}`));
      tab.on('console', (message) => { if (message.type() === 'error') problems.push(`${scheme}: ${message.text()}`); });
      tab.on('dialog', (dialog) => { problems.push(`${scheme}: a dialog: ${dialog.message()}`); dialog.dismiss(); });
      tab.on('request', (request) => { if (!request.url().startsWith('file:')) problems.push(`${scheme}: asks for ${request.url()}`); });
      await tab.goto(pathToFileURL(resolve(folder, name)).href);
      await tab.waitForFunction('window.surefoot', null, { timeout: 15000 }).catch(() => problems.push(`${scheme}: the page's script did not end`));
      if (problems.length === 0) {
        if (pictures) {
          mkdirSync(pictures, { recursive: true });
          await tab.waitForTimeout(200);
          await tab.screenshot({ path: join(pictures, `${basename(name, '.html')}-${scheme}.png`), fullPage: true });
        }
        await use(tab, problems);
      }
      await tab.close();
    }
    console.log(`${name}: ${problems.length ? 'BAD' : 'ok'}${problems.map((problem) => `\n  ${problem}`).join('')}`);
    if (problems.length) bad += 1;
  }
} finally {
  await browser.close();
  rmSync(profile, { recursive: true, force: true });
}
console.log(`${pages.length} pages, ${bad} bad`);
process.exit(bad > 0 || pages.length === 0 ? 1 : 0);
