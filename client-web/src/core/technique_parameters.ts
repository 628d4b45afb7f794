// The settings of the chosen technique, made from the descriptor of the technique's message. A
// setting that is added to scene.proto appears without a change of this file. The file only says
// when a setting has no effect, and gives names that differ from those of the schema.
import { type DescEnum, isMessage } from "@bufbuild/protobuf";
import {
  CumulusSchema,
  MetaballsSchema,
  Cumulus_Source as Source,
  Transport,
  TransportSchema,
} from "../gen/thunderhead/v1/scene_pb";
import type { TechniqueDescription } from "../gen/thunderhead/v1/thunderhead_pb";
import { defaultChoiceOf } from "./limits";
import { nameOfChoice } from "./names";
import { type Parameter, parametersOfMessage } from "./parameters";
import { descriptorOf, type Settings, tracesLight, transportOf } from "./rendering";

export type TechniqueParameter = Parameter & {
  // The setting's name in the settings message.
  readonly setting: string;
  // True if the server needs seconds for a change.
  readonly slow: boolean;
  // The setting's value in the settings message; undefined if it is absent. The value of a choice
  // is always known.
  readonly value: unknown;
};

type Condition = (settings: Settings, technique: TechniqueDescription) => boolean;

const asInThePaper: Condition = (settings, technique) =>
  transportOf(settings, technique) === Transport.PAPER;

// When a setting has an effect. Settings that are not listed always have one.
const EFFECTIVE: Readonly<Record<string, Condition>> = {
  transport: (settings, technique) => transportOf(settings, technique) !== undefined,
  tracedLight: tracesLight,
  slices: (_, technique) => technique.hasSlices,
  detail: (_, technique) => technique.showsDetail,
  perFieldPhase: (_, technique) => technique.showsFieldOptics,
  falseColors: (_, technique) => technique.showsFieldOptics,
  albedo: asInThePaper,
  opticalDepth: asInThePaper,
  leastExtinctionPerM: (settings) =>
    !isMessage(settings, CumulusSchema) ||
    [Source.UNSPECIFIED, Source.STORM].includes(settings.source),
};

const LABELS: Readonly<Record<string, string>> = {
  tracedLight: "Path-traced correction",
  thetaFDeg: "Forward angle θf",
  perFieldPhase: "Phase function per field",
  detail: "Detail finer than the grid",
  falseColors: "False colours",
  count: "Metaballs",
  isotropic: "Scatter isotropically",
  albedo: "Albedo a",
  opticalDepth: "Optical depth τ",
  source: "Surface",
  component: "Light shown",
  trap: "Light traps",
};

// Returns the settings that have an effect, in the order of the schema.
export function techniqueParametersOf(
  settings: Settings,
  technique: TechniqueDescription,
): TechniqueParameter[] {
  const { fields } = descriptorOf(settings);
  return parametersOfMessage(settings, fields).flatMap((parameter) => {
    const field = parameter.steps[0]?.field;
    if (field === undefined || parameter.kind === "text") return [];
    const setting = field.localName;
    if (EFFECTIVE[setting]?.(settings, technique) === false) return [];
    const common = {
      setting,
      name: LABELS[setting] ?? parameter.name,
      slow: isMessage(settings, MetaballsSchema) && setting === "count",
      value: (settings as unknown as Record<string, unknown>)[setting],
    };
    if (parameter.kind !== "choice" || field.fieldKind !== "enum")
      return [{ ...parameter, ...common }];
    const options = choicesOf(field.enum, technique).map((value) => ({
      value,
      name: nameOfChoice(field.enum, value),
      fullName: `${field.enum.typeName}.${field.enum.value[value]?.name}`,
    }));
    const chosen = field.enum === TransportSchema ? transportOf(settings, technique) : common.value;
    return [{ ...parameter, ...common, value: chosen || defaultChoiceOf(field), options }];
  });
}

// Returns the values of a choice that the technique offers, without the one that means "default".
function choicesOf(choice: DescEnum, technique: TechniqueDescription): number[] {
  if (choice === TransportSchema) return technique.transports;
  return choice.values.map(({ number }) => number).filter((number) => number !== 0);
}
