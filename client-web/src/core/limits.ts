// Range, default and unit of each number, and the defaults of switches and choices. They are read
// from the field options in proto/. This file also maps values to slider positions. It does not
// depend on widgets.
import { type DescField, getOption, ScalarType } from "@bufbuild/protobuf";
import {
  default_choice as defaultChoiceOption,
  default_on as defaultOnOption,
  max_items as maxItemsOption,
  number$ as numberOption,
} from "../gen/thunderhead/v1/limits_pb";

export interface Limits {
  readonly minimum: number;
  readonly maximum: number;
  // Value of an absent field; undefined if it depends on the storm or the hydrometeor.
  readonly defaultValue: number | undefined;
  // The unit in UCUM notation.
  readonly unit: string;
  readonly logarithmic: boolean;
  readonly integer: boolean;
  // True if the message stores a 32-bit float.
  readonly singlePrecision: boolean;
}

const INTEGER_SCALARS = new Set<ScalarType>([
  ScalarType.UINT32,
  ScalarType.INT32,
  ScalarType.SINT32,
  ScalarType.FIXED32,
]);

export function limitsOf(field: DescField): Limits {
  const option = getOption(field, numberOption);
  if (field.fieldKind !== "scalar" || option.maximum <= option.minimum) {
    throw new Error(`${field.toString()} has no number limits in the schema`);
  }
  return {
    minimum: option.minimum,
    maximum: option.maximum,
    defaultValue: option.defaultValue,
    unit: option.unit,
    logarithmic: option.logarithmic,
    integer: INTEGER_SCALARS.has(field.scalar),
    singlePrecision: field.scalar === ScalarType.FLOAT,
  };
}

// Returns the value that an absent bool stands for; false if this value depends on the storm.
export function defaultOnOf(field: DescField): boolean {
  if (field.fieldKind !== "scalar" || field.scalar !== ScalarType.BOOL) {
    throw new Error(`${field.toString()} has no default in the schema`);
  }
  return getOption(field, defaultOnOption);
}

// Returns the enumerator that an absent value stands for. If this depends on the storm or on other
// fields, returns 0, the number of an absent value.
export function defaultChoiceOf(field: DescField): number {
  if (field.fieldKind !== "enum") throw new Error(`${field.toString()} is no choice`);
  const name = getOption(field, defaultChoiceOption);
  return field.enum.values.find((value) => value.name === name)?.number ?? 0;
}

// Returns the default of a number if the default does not depend on the storm. Otherwise throws an
// Error.
export function defaultNumberOf({ defaultValue }: Limits): number {
  if (defaultValue === undefined) throw new Error("the schema has no default of this number");
  return defaultValue;
}

// Returns the maximum number of elements of a list.
export function mostItemsOf(field: DescField): number {
  const most = getOption(field, maxItemsOption);
  if (field.fieldKind !== "list" || most < 1) {
    throw new Error(`${field.toString()} has no limit of its length in the schema`);
  }
  return most;
}

// Returns the nearest value that the server accepts. NaN becomes the default, or the minimum if
// there is no default. A 32-bit float near a limit can be rounded to a value outside the limits
// (0.99 becomes 0.9900000095). The limit itself is therefore rounded to the nearest 32-bit float
// inside the limits.
export function clampToLimits(value: number, limits: Limits): number {
  if (Number.isNaN(value)) return limits.defaultValue ?? limits.minimum;
  const rounded = limits.integer ? Math.round(value) : value;
  const clamped = Math.min(limits.maximum, Math.max(limits.minimum, rounded));
  if (!limits.singlePrecision) return clamped;
  const single = Math.fround(clamped);
  if (single > limits.maximum) return neighbourTowards(single, -1);
  if (single < limits.minimum) return neighbourTowards(single, 1);
  return single;
}

// Returns the next 32-bit float below (-1) or above (1) a finite number that is not zero.
function neighbourTowards(single: number, direction: -1 | 1): number {
  const view = new DataView(new ArrayBuffer(4));
  view.setFloat32(0, single);
  const awayFromZero = single > 0 === direction > 0;
  view.setInt32(0, view.getInt32(0) + (awayFromZero ? 1 : -1));
  return view.getFloat32(0);
}

// A logarithmic slider whose minimum is zero spans this ratio: its smallest positive value is its
// maximum divided by this number. Its first position is zero.
const LOGARITHMIC_SPAN = 1e5;

function logarithmicFloor(limits: Limits): number {
  return limits.minimum > 0 ? limits.minimum : limits.maximum / LOGARITHMIC_SPAN;
}

// Returns the slider position of a value, 0 to 1.
export function positionOfValue(value: number, limits: Limits): number {
  const { minimum, maximum } = limits;
  if (!limits.logarithmic) return share((value - minimum) / (maximum - minimum));
  const floor = logarithmicFloor(limits);
  if (value <= floor) return 0;
  return share(Math.log(value / floor) / Math.log(maximum / floor));
}

// Returns the value at a slider position, 0 to 1. Between the ends, the value is rounded to three
// digits.
export function valueAtPosition(position: number, limits: Limits): number {
  const { minimum, maximum } = limits;
  const along = share(position);
  if (along === 0) return clampToLimits(minimum, limits);
  if (along === 1) return clampToLimits(maximum, limits);
  const floor = limits.logarithmic ? logarithmicFloor(limits) : minimum;
  const value = limits.logarithmic
    ? floor * (maximum / floor) ** along
    : minimum + along * (maximum - minimum);
  return clampToLimits(Number(value.toPrecision(3)), limits);
}

function share(value: number): number {
  return Math.min(1, Math.max(0, value));
}
