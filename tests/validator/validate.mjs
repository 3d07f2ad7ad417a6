// Runs Khronos' glTF validator over files. Standard input: a JSON array of {"file", "folder"}, where
// "folder" holds the files that "file" names. Standard output: a JSON array of their reports.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { validateBytes } from "gltf-validator";

const requests = JSON.parse(readFileSync(0, "utf8"));
const reports = [];
for (const { file, folder } of requests) {
  reports.push(
    await validateBytes(new Uint8Array(readFileSync(file)), {
      uri: file,
      maxIssues: 0, // all of them: a cut list could hide a new one
      writeTimestamp: false,
      externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(folder, decodeURIComponent(uri)))),
    }),
  );
}
process.stdout.write(JSON.stringify(reports));
