// Reads the cases that all clients share (tests/clients/README.md) and runs their steps.
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import type { JsonObject, JsonValue } from "@bufbuild/protobuf";

const FOLDER = fileURLToPath(new URL("../../../tests/clients/cases", import.meta.url));

// The tolerated difference of two numbers, as a fraction of the expected number. Below 1 it is
// absolute. Messages store 32-bit floats, so results are not exact.
const TOLERANCE = 1e-5;

export interface Case {
  readonly name: string;
  readonly given?: JsonObject;
  readonly steps: readonly JsonObject[];
}

export interface CaseFile {
  readonly modules: Readonly<Record<string, string>>;
  readonly cases: readonly Case[];
}

// Returns the case files by their names without ".json".
export function caseFiles(): ReadonlyMap<string, CaseFile> {
  const names = readdirSync(FOLDER).filter((name) => name.endsWith(".json"));
  return new Map(
    names.map((name) => [
      name.slice(0, -".json".length),
      JSON.parse(readFileSync(`${FOLDER}/${name}`, "utf8")) as CaseFile,
    ]),
  );
}

// The arguments of one step, or the values of `given`, the state before the first step. The class
// records which arguments were read. expectAllRead() can therefore fail for an argument that the
// runner does not know.
export class Arguments {
  readonly #values: JsonObject;
  readonly #read = new Set<string>();

  constructor(values: JsonObject) {
    this.#values = values;
  }

  // Returns an argument; undefined if it is absent.
  find(name: string): JsonValue | undefined {
    this.#read.add(name);
    return this.#values[name];
  }

  // Returns an argument. Throws an Error if it is absent.
  json(name: string): JsonValue {
    const value = this.find(name);
    if (value === undefined) throw new Error(`the argument '${name}' is missing`);
    return value;
  }

  number(name: string, otherwise?: number): number {
    const value = this.find(name) ?? otherwise;
    if (typeof value !== "number") throw new Error(`the argument '${name}' is no number`);
    return value;
  }

  text(name: string): string {
    const value = this.json(name);
    if (typeof value !== "string") throw new Error(`the argument '${name}' is no text`);
    return value;
  }

  flag(name: string, otherwise?: boolean): boolean {
    const value = this.find(name) ?? otherwise;
    if (typeof value !== "boolean")
      throw new Error(`the argument '${name}' is neither true nor false`);
    return value;
  }

  // Throws an Error if an argument was not read.
  expectAllRead(): void {
    const unread = Object.keys(this.#values).filter((name) => !this.#read.has(name));
    if (unread.length > 0) throw new Error(`the runner does not know: ${unread.join(", ")}`);
  }
}

// The results of a step that a case can expect, by name.
export type Observed = Readonly<Record<string, JsonValue>>;
export type Actions = Readonly<Record<string, (step: Arguments) => Observed | Promise<Observed>>>;
// Makes a module in the given state, and returns the actions of its steps.
export type Runner = (given: Arguments) => Actions;

// Throws an Error that names the step if the module does not do what the case expects.
export async function runCase(runner: Runner, { given = {}, steps }: Case): Promise<void> {
  const start = new Arguments(given);
  const actions = runner(start);
  start.expectAllRead();
  if (!steps.some((step) => "expect" in step)) throw new Error("the case expects nothing");
  for (const [index, step] of steps.entries()) {
    try {
      await runStep(actions, step);
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      throw new Error(`step ${index}, ${JSON.stringify(step)}: ${reason}`);
    }
  }
}

async function runStep(actions: Actions, step: JsonObject): Promise<void> {
  const { do: name, times = 1, expect = {}, ...values } = step;
  const action = actions[String(name)];
  if (action === undefined) throw new Error(`the runner does not know the action '${name}'`);
  let observed: Observed = {};
  for (let i = 0; i < Number(times); i += 1) {
    const given = new Arguments(values);
    observed = await action(given);
    given.expectAllRead();
  }
  for (const [key, expected] of Object.entries(expect as JsonObject)) {
    const found = observed[key];
    if (found === undefined) throw new Error(`the runner does not know the result '${key}'`);
    const difference = differenceOf(expected, found, key);
    if (difference !== undefined) throw new Error(difference);
  }
}

// Returns where two values differ; undefined if they are equal.
function differenceOf(expected: JsonValue, found: JsonValue, path: string): string | undefined {
  if (typeof expected === "number" && typeof found === "number") {
    const near = Math.abs(expected - found) <= TOLERANCE * Math.max(1, Math.abs(expected));
    return near ? undefined : `${path} is ${found} in place of ${expected}`;
  }
  if (!isObject(expected) || !isObject(found) || Array.isArray(expected) !== Array.isArray(found)) {
    if (expected === found) return undefined;
    return `${path} is ${JSON.stringify(found)} in place of ${JSON.stringify(expected)}`;
  }
  const keys = new Set([...Object.keys(expected), ...Object.keys(found)]);
  for (const key of keys) {
    const [a, b] = [expected[key], found[key]];
    if (a === undefined) return `${path}.${key} is ${JSON.stringify(b)} in place of nothing`;
    if (b === undefined) return `${path}.${key} is missing`;
    const difference = differenceOf(a, b, `${path}.${key}`);
    if (difference !== undefined) return difference;
  }
  return undefined;
}

function isObject(value: JsonValue): value is JsonObject {
  return typeof value === "object" && value !== null;
}
