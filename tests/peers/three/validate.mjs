// What the validator of the Khronos Group says about a file.
// Never here: any judgement of our own.
//
//     node validate.mjs FILE.gltf|glb
//
// Standard output gets the issues of the report as JSON. The exit code is 1 where there are errors.

import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import validator from 'gltf-validator';

const [file] = process.argv.slice(2);
if (!file) {
  console.error('usage: node validate.mjs FILE.gltf|glb');
  process.exit(2);
}
const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
  uri: file,
  // By default it stops counting at 100.
  maxIssues: 0,
  externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
});
console.log(JSON.stringify(report.issues));
// Not `exit`, which may cut off what goes into a pipe.
process.exitCode = report.issues.numErrors > 0 ? 1 : 0;
