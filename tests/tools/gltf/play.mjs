// SPDX-License-Identifier: GPL-3.0-or-later
// node play.mjs FILE.glb ...: loads every file in three.js in headless Chromium, plays its animation, and checks that
// the cloth moves. Saves FILE.png (the picture in the middle of the animation) beside the file.
// Exit status 1 when a file does not play, 77 (skipped) when Chromium or three.js is not installed.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const kTimeout = 120_000;  // [ms] for one file; a software renderer on a busy machine is slow
const folder = dirname(fileURLToPath(import.meta.url));

function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(77);
}

function findChromium() {
  const names = ['chromium', 'chromium-browser', 'google-chrome'];
  const candidates = process.env.CHROMIUM ? [process.env.CHROMIUM] : names;
  return candidates.find((name) => spawnSync(name, ['--version'], { stdio: 'ignore' }).status === 0);
}

const three = join(folder, 'node_modules', 'three');
if (!existsSync(three)) skip('three is not installed (npm ci in tests/tools/gltf)');
const chromium = findChromium();
if (!chromium) skip('Chromium is not installed (apt-get install chromium)');

/// Serves the page, three.js and one .glb; resolves with what the page posts back.
function play(glb) {
  return new Promise((resolve, reject) => {
    const profile = mkdtempSync(join(tmpdir(), 'geocloth-chromium-'));
    let browser, timer, log = '';
    const server = createServer((request, response) => {
      const path = new URL(request.url, 'http://localhost').pathname;
      if (request.method === 'POST') {
        const chunks = [];
        request.on('data', (chunk) => chunks.push(chunk));
        request.on('end', () => {
          response.end();
          finish(() => resolve(JSON.parse(Buffer.concat(chunks).toString())));
        });
        return;
      }
      const file = path === '/' ? join(folder, 'play.html')
        : path === '/cloth.glb' ? glb
        : path.startsWith('/three/') && !path.includes('..') ? join(three, path.slice('/three/'.length)) : '';
      const types = { '.html': 'text/html', '.js': 'text/javascript', '.glb': 'model/gltf-binary' };
      if (!existsSync(file)) return response.writeHead(404).end();
      response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
      response.end(readFileSync(file));
    });
    function finish(then) {
      clearTimeout(timer);
      server.close();
      server.closeAllConnections();
      browser.once('exit', () => {
        // Chromium's other processes may still be writing: what they leave behind says nothing about the file.
        try {
          rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 200 });
        } catch (error) {
          console.warn(`left behind: ${profile} (${error.code})`);
        }
        then();
      });
      process.kill(-browser.pid, 'SIGKILL');  // with its children, which are its process group
    }
    server.listen(0, '127.0.0.1', () => {
      browser = spawn(chromium, [
        '--headless=new', '--no-sandbox', '--disable-dev-shm-usage', '--no-first-run', '--hide-scrollbars',
        '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist',
        `--user-data-dir=${profile}`, `http://127.0.0.1:${server.address().port}/`], { stdio: ['ignore', 'ignore', 'pipe'], detached: true });
      browser.stderr.on('data', (text) => { log = (log + text).slice(-4000); });
      timer = setTimeout(() => finish(() => reject(new Error(`no answer from Chromium\n${log}`))), kTimeout);
    });
  });
}

let failed = false;
for (const file of process.argv.slice(2)) {
  const result = await play(file);
  const problems = [...result.problems];
  if (problems.length === 0) {
    console.log(`${file}: ${result.meshes} meshes, ${result.targets} morph targets, ${result.seconds} s, ` +
      `${result.movedPixels} pixels differ between two times`);
    writeFileSync(file.replace(/\.glb$/, '.png'), Buffer.from(result.picture.split(',')[1], 'base64'));
  }
  for (const problem of problems) console.error(`${file}: ${problem}`);
  failed ||= problems.length > 0;
}
process.exit(failed ? 1 : 0);
