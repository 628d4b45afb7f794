// Checks objects of Kubernetes, JSON on standard input, against the schemas that its API publishes; prints an array of what is wrong
// with each. They come as the validators that the package kubernetes-models compiles from them; unknown fields they let pass.
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
