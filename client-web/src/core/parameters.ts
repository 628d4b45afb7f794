// The list of every parameter of a scene, made from the descriptors of the Protobuf messages. A
// field that is added to scene.proto appears in this list without a change of code. A parameter's
// value is found by the path of fields that leads to it.
import {
  create,
  type DescField,
  type DescMessage,
  type Message,
  ScalarType,
} from "@bufbuild/protobuf";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import { defaultChoiceOf, defaultOnOf, type Limits, limitsOf } from "./limits";
import { enumeratorInWords } from "./names";

interface Step {
  readonly field: DescField;
  // Index of the element if the field is a list.
  readonly index?: number;
}

interface Common {
  // A path such as "sun.azimuth_deg" or "fields[0].scale".
  readonly path: string;
  // The field's name in the schema, such as "thunderhead.v1.Sun.azimuth_deg".
  readonly fullName: string;
  // The name for people, without the unit.
  readonly name: string;
  // The part of the scene that contains the parameter, such as "sun" or "fields".
  readonly group: string;
  readonly steps: readonly Step[];
}

export type Parameter = Common &
  (
    | { readonly kind: "number"; readonly limits: Limits }
    | { readonly kind: "flag"; readonly defaultOn: boolean }
    | { readonly kind: "text" }
    | { readonly kind: "choice"; readonly options: readonly ParameterOption[] }
  );

export interface ParameterOption {
  readonly value: number;
  readonly name: string;
  readonly fullName: string;
}

type Fields = Record<string, unknown>;

// Returns the parameters that the scene has now. A oneof contributes only the case that is set, and
// a list contributes each of its elements.
export function parametersOf(scene: Scene): Parameter[] {
  return SceneSchema.fields.flatMap((field) => ofField(scene, field, [], "", field.name));
}

// Returns the parameters in the given fields of a message, with paths that begin at the message.
export function parametersOfMessage(message: Message, fields: readonly DescField[]): Parameter[] {
  return fields.flatMap((field) => ofField(message, field, [], "", ""));
}

function ofField(
  owner: Message,
  field: DescField,
  before: readonly Step[],
  prefix: string,
  group: string,
): Parameter[] {
  const path = `${prefix}${field.name}`;
  const { oneof } = field;
  if (oneof !== undefined) {
    const chosen = (owner as unknown as Fields)[oneof.localName] as { case?: string } | undefined;
    if (chosen?.case !== field.localName) return [];
  }
  if (field.fieldKind === "list" && field.listKind === "message") {
    const items = (owner as unknown as Fields)[field.localName] as Message[];
    return items.flatMap((item, index) =>
      ofMessage(item, field.message, [...before, { field, index }], `${path}[${index}].`, group),
    );
  }
  const steps = [...before, { field }];
  if (field.fieldKind === "message") {
    const inner = valueAt(owner, { field }) ?? create(field.message);
    return ofMessage(inner as Message, field.message, steps, `${path}.`, group);
  }
  const parameter = leaf(field, { path, steps, group });
  return parameter === undefined ? [] : [parameter];
}

function ofMessage(
  message: Message,
  desc: DescMessage,
  steps: readonly Step[],
  prefix: string,
  group: string,
): Parameter[] {
  return desc.fields.flatMap((field) => ofField(message, field, steps, prefix, group));
}

function leaf(
  field: DescField,
  { path, steps, group }: Pick<Common, "path" | "steps" | "group">,
): Parameter | undefined {
  const fullName = `${field.parent.typeName}.${field.name}`;
  const common = { path, fullName, name: nameOf(field.name), group, steps };
  if (field.fieldKind === "enum") {
    const { enum: desc } = field;
    const words = (number: number) => enumeratorInWords(desc, number) ?? "";
    const standsFor = defaultChoiceOf(field);
    const absent = standsFor === 0 ? "default" : `default: ${words(standsFor)}`;
    const options = desc.values.map(({ number, name }) => ({
      value: number,
      name: number === 0 ? absent : words(number),
      fullName: `${desc.typeName}.${name}`,
    }));
    return { ...common, kind: "choice", options };
  }
  if (field.fieldKind !== "scalar") return undefined;
  if (field.scalar === ScalarType.STRING) return { ...common, kind: "text" };
  if (field.scalar === ScalarType.BOOL)
    return { ...common, kind: "flag", defaultOn: defaultOnOf(field) };
  return { ...common, kind: "number", limits: limitsOf(field) };
}

const UNIT_ENDINGS = /_(deg|m|mm|px|ev|kg_per_m3|per_m|milliseconds)$/;

function nameOf(field: string): string {
  const words = field.replace(UNIT_ENDINGS, "").replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

// Returns the parameter's value; undefined if the scene has no such value.
export function parameterValue(scene: Scene, { steps }: Parameter): unknown {
  let at: unknown = scene;
  for (const step of steps) {
    if (at === undefined) return undefined;
    at = valueAt(at as Message, step);
  }
  return at;
}

function valueAt(owner: Message, { field, index }: Step): unknown {
  const fields = owner as unknown as Fields;
  const { oneof } = field;
  if (oneof !== undefined) return (fields[oneof.localName] as { value?: unknown }).value;
  const value = fields[field.localName];
  return index === undefined ? value : (value as unknown[])[index];
}

// Returns the scene with another value of the parameter. If `value` is undefined, the server
// chooses the value.
export function withParameter(scene: Scene, { steps }: Parameter, value: unknown): Scene {
  return changed(scene, steps, value) as Scene;
}

function changed(owner: Message, [step, ...rest]: readonly Step[], value: unknown): Message {
  if (step === undefined) return owner;
  const { field, index } = step;
  const fields = owner as unknown as Fields;
  const next = (inner: unknown) => {
    const { message } = field as { message?: DescMessage };
    if (rest.length === 0 || message === undefined) return value;
    return changed((inner as Message | undefined) ?? create(message), rest, value);
  };
  if (field.oneof !== undefined) {
    const { localName } = field.oneof;
    const chosen = { case: field.localName, value: next(valueAt(owner, step)) };
    return { ...owner, [localName]: chosen } as Message;
  }
  if (index !== undefined) {
    const items = (fields[field.localName] as unknown[]).map((item, at) =>
      at === index ? next(item) : item,
    );
    return { ...owner, [field.localName]: items } as Message;
  }
  return { ...owner, [field.localName]: next(fields[field.localName]) } as Message;
}
