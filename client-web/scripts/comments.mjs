// Writes src/gen/comments.ts. It contains, by full name, the first sentence of the comment of every field and enum
// value of the scene's messages. Comments in generated code are for programmers, but the page shows these.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { fromBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";

const proto = fileURLToPath(new URL("../../proto", import.meta.url));
const target = fileURLToPath(new URL("../src/gen/comments.ts", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "thunderhead-comments-"));
const set = join(folder, "scene.bin");
execFileSync("protoc", [
  ...["-I", proto, "-I", "/usr/include", "--include_source_info", `--descriptor_set_out=${set}`],
  "thunderhead/v1/scene.proto",
]);
const [file] = fromBinary(FileDescriptorSetSchema, readFileSync(set)).file;
rmSync(folder, { recursive: true });

const comments = new Map();
for (const { path, leadingComments } of file.sourceCodeInfo?.location ?? [])
  if (leadingComments !== "") comments.set(path.join("."), firstSentence(leadingComments));

function firstSentence(comment) {
  const text = comment.replace(/\s+/g, " ").trim();
  return /^.*?[.:](?= [A-Z]|$)/.exec(text)?.[0] ?? text;
}

const named = {};
// These are field numbers in descriptor.proto. A file has its messages in 4 and its enums in 5. A message has its
// fields in 2, its messages in 3 and its enums in 4.
function ofMessage(message, prefix, path) {
  const name = `${prefix}.${message.name}`;
  message.field.forEach((field, at) => take(`${name}.${field.name}`, `${path}.2.${at}`));
  message.nestedType.forEach((inner, at) => ofMessage(inner, name, `${path}.3.${at}`));
  message.enumType.forEach((inner, at) => ofEnum(inner, name, `${path}.4.${at}`));
}
function ofEnum({ name, value }, prefix, path) {
  value.forEach((each, at) => take(`${prefix}.${name}.${each.name}`, `${path}.2.${at}`));
}
function take(name, path) {
  if (comments.has(path)) named[name] = comments.get(path);
}
file.messageType.forEach((message, at) => ofMessage(message, file.package, `4.${at}`));
file.enumType.forEach((each, at) => ofEnum(each, file.package, `5.${at}`));

writeFileSync(
  target,
  `// Written by scripts/comments.mjs.\nexport const COMMENTS: Readonly<Record<string, string>> = ${JSON.stringify(named, null, 2)};\n`,
);
