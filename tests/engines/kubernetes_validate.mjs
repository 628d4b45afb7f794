// Checks Kubernetes objects, given as JSON on standard input, against the schemas that its API publishes. Prints an
// array with the errors of each object. The package kubernetes-models has compiled the schemas to validators, which
// accept unknown fields.
import * as apps from 'kubernetes-models/apps/v1';
import * as batch from 'kubernetes-models/batch/v1';
import * as core from 'kubernetes-models/v1';

const kinds = { 'apps/v1': apps, 'batch/v1': batch, v1: core };

let text = '';
for await (const part of process.stdin) text += part;
const wrong = JSON.parse(text).map((thing) => {
  const Kind = kinds[thing.apiVersion]?.[thing.kind];
  if (Kind === undefined) return [`${thing.apiVersion} has no ${thing.kind}`];
  try {
    new Kind(thing).validate();
    return [];
  } catch (error) {
    return [error.message];
  }
});
console.log(JSON.stringify(wrong));
