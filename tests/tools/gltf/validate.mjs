// SPDX-License-Identifier: GPL-3.0-or-later
// node validate.mjs FILE.glb | FOLDER ...: the Khronos glTF validator must find no error. Warnings are shown: a
// normal map without tangents is one, and what most files have.
// Exit status 1 when it finds an error, 77 (skipped) when npm packages are not installed.
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';

let validator;
try {
  validator = (await import('gltf-validator')).default;
} catch {
  console.log('skipped: gltf-validator is not installed (npm ci in tests/tools/gltf)');
  process.exit(77);
}

const files = process.argv.slice(2).flatMap((path) =>
  statSync(path).isDirectory()
    ? readdirSync(path).filter((name) => name.endsWith('.glb')).sort().map((name) => join(path, name))
    : [path]);
if (files.length === 0) {
  console.error('no .glb file to validate');
  process.exit(1);
}

let failed = false;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { uri: file, maxIssues: 100 });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints`);
  for (const message of messages.filter((m) => m.severity <= 1)) {
    console.log(`  ${message.code} at ${message.pointer ?? message.offset}: ${message.message}`);
  }
  failed ||= numErrors > 0;
}
process.exit(failed ? 1 : 0);
