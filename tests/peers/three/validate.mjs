// What the validator of the Khronos Group says about files.
// Never here: any judgement of our own.
//
//     node validate.mjs FILE.gltf|glb...
//
// Standard output gets a line for each file: the issues of its report as JSON. The exit code is 1 where there are errors.

import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import validator from 'gltf-validator';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.gltf|glb...');
  process.exit(2);
}
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: file,
    // By default it stops counting at 100.
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
  });
  console.log(JSON.stringify(report.issues));
  // Not `exit`, which may cut off what goes into a pipe.
  if (report.issues.numErrors > 0) process.exitCode = 1;
}
