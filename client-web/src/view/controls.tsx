// The panel's controls. Each shows one value and reports the user's changes.
import type { ComponentChildren, TargetedEvent } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import { clampToLimits, type Limits, positionOfValue, valueAtPosition } from "../core/limits";
import { displayUnitOf, formatNumber, formatQuantity } from "../core/units";
import { Icon } from "./icons";

const SLIDER_STEPS = 400;
// A slider whose changes cost the server seconds reports its value after this time without motion.
const SLIDER_REST_MS = 500;

interface SliderProps {
  readonly label: string;
  readonly limits: Limits;
  // Undefined until the server has sent the value.
  readonly value: number | undefined;
  // The value that the reset button restores; absent means the schema's default.
  readonly initial?: number | undefined;
  // Resets the value, so that the server chooses it. If this function is given, the value can be
  // set even while it is unknown.
  readonly giveBack?: (() => void) | undefined;
  readonly testId: string;
  // True if the server needs seconds for a change. The change is then reported only when the slider
  // is released or has not moved for a while.
  readonly afterRest?: boolean;
  // True to put the slider on the line of its visible label.
  readonly inLine?: boolean;
  readonly onChange: (value: number) => void;
}

// Holds the value to which a slider was dragged, until the value is reported. This happens on
// release or after SLIDER_REST_MS without motion.
function useHeld(onChange: (value: number) => void) {
  const [held, setHeld] = useState<number | undefined>(undefined);
  const tellLater = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const tell = useRef<() => void>(() => undefined);
  useEffect(() => () => clearTimeout(tellLater.current), []);
  const hold = (value: number) => {
    clearTimeout(tellLater.current);
    setHeld(value);
    tell.current = () => {
      clearTimeout(tellLater.current);
      tell.current = () => undefined;
      setHeld(undefined);
      onChange(value);
    };
    tellLater.current = setTimeout(() => tell.current(), SLIDER_REST_MS);
  };
  return { held, hold, release: () => tell.current() };
}

// Returns the value and event handlers of an input that keeps the text while it is being typed.
// Otherwise each frame would redraw the page and lose the text. `tell` gets the input on Enter or
// when the input is left. It returns false if the input is incomplete, such as half a date.
export function useTyped(value: string, tell: (input: HTMLInputElement) => boolean) {
  const [typed, setTyped] = useState<string | undefined>(undefined);
  return {
    value: typed ?? value,
    onInput: (event: TargetedEvent<HTMLInputElement>) => setTyped(event.currentTarget.value),
    onChange: (event: TargetedEvent<HTMLInputElement>) => {
      if (tell(event.currentTarget)) setTyped(undefined);
    },
    onBlur: () => setTyped(undefined),
  };
}

// A control for a number: a slider, a text field and the unit.
export function Slider(props: SliderProps) {
  const { label, limits, initial, giveBack, testId, afterRest, inLine, onChange } = props;
  const { held, hold, release } = useHeld(onChange);
  const value = held ?? props.value;
  const id = useId();
  const unit = displayUnitOf(limits);
  const range = limits.maximum - limits.minimum;
  const steps =
    limits.integer && !limits.logarithmic ? Math.min(range, SLIDER_STEPS) : SLIDER_STEPS;
  const known = value !== undefined;
  const usable = known || giveBack !== undefined;
  const unknown = giveBack === undefined ? "not known yet" : "left to the server";
  const first = initial ?? limits.defaultValue;
  const changed = known && first !== undefined && !nearlyEqual(value, first);
  const number = useTyped(known ? formatNumber(value * unit.factor) : "", (input) => {
    const typed = input.valueAsNumber;
    if (Number.isNaN(typed)) return false;
    const next = clampToLimits(typed / unit.factor, limits);
    input.value = formatNumber(next * unit.factor);
    onChange(next);
    return true;
  });
  return (
    <div class={inLine ? "slider in-line" : "slider"}>
      <label for={id} class={inLine ? "visually-hidden" : undefined}>
        {label}
      </label>
      <span class="slider-value">
        {changed && (
          <button
            type="button"
            class="reset"
            aria-label={`Reset ${label} to ${formatQuantity(first, limits)}`}
            title={`Reset to ${formatQuantity(first, limits)}`}
            onClick={() => onChange(first)}
          >
            <Icon name="undo" />
          </button>
        )}
        {known && first === undefined && giveBack !== undefined && (
          <button
            type="button"
            class="reset"
            aria-label={`Leave ${label} to the server`}
            title="Leave it to the server"
            data-testid={`${testId}-give-back`}
            onClick={giveBack}
          >
            <Icon name="undo" />
          </button>
        )}
        <input
          type="number"
          class="number"
          aria-label={`${label}${unit.symbol === "" ? "" : ` in ${unit.symbol}`}`}
          data-testid={`${testId}-number`}
          disabled={!usable}
          placeholder={known ? undefined : "—"}
          min={limits.minimum * unit.factor}
          max={limits.maximum * unit.factor}
          step="any"
          {...number}
        />
        <span class="unit" aria-hidden="true">
          {unit.symbol}
        </span>
      </span>
      <input
        id={id}
        type="range"
        data-testid={testId}
        disabled={!usable}
        min={0}
        max={steps}
        step={1}
        value={known ? Math.round(positionOfValue(value, limits) * steps) : 0}
        aria-valuetext={known ? formatQuantity(value, limits) : unknown}
        onInput={(event) => {
          const next = valueAtPosition(event.currentTarget.valueAsNumber / steps, limits);
          if (afterRest) hold(next);
          else onChange(next);
        }}
        onPointerUp={release}
      />
    </div>
  );
}

function nearlyEqual(a: number, b: number): boolean {
  return Math.abs(a - b) <= 1e-6 * Math.max(Math.abs(a), Math.abs(b));
}

interface ChoiceProps<T extends string | number> {
  readonly label: string;
  readonly value: T;
  readonly options: readonly (readonly [T, string])[];
  readonly testId: string;
  readonly onChange: (value: T) => void;
}

// A control to choose one of a few named values.
export function Choice<T extends string | number>(props: ChoiceProps<T>) {
  const { label, value, options, testId, onChange } = props;
  const id = useId();
  return (
    <div class="choice">
      <label for={id}>{label}</label>
      <select
        id={id}
        data-testid={testId}
        value={String(value)}
        onChange={(event) => {
          const chosen = options[event.currentTarget.selectedIndex];
          if (chosen !== undefined) onChange(chosen[0]);
        }}
      >
        {options.map(([key, text]) => (
          <option key={key} value={String(key)} selected={key === value}>
            {text}
          </option>
        ))}
      </select>
    </div>
  );
}

interface SegmentsProps<T extends string | number> {
  readonly label: string;
  // The chosen value; undefined if no option is chosen.
  readonly value: T | undefined;
  // Each option has a value, a name and an explanation.
  readonly options: readonly (readonly [T, string, string])[];
  // Text that is shown instead of an explanation while no option is chosen.
  readonly otherwise: string;
  readonly testId: string;
  readonly onChange: (value: T) => void;
}

// A few options side by side, with the explanation of the chosen option below. Screen readers read
// the explanation of each option.
export function Segments<T extends string | number>(props: SegmentsProps<T>) {
  const { label, value, options, otherwise, testId, onChange } = props;
  const id = useId();
  const chosen = options.find(([key]) => key === value);
  return (
    <div class="segments">
      <div class="segments-row" role="radiogroup" aria-label={label} data-testid={testId}>
        {options.map(([key, name, about]) => (
          <label key={key} title={about}>
            <input
              type="radio"
              name={id}
              class="visually-hidden"
              data-testid={`${testId}-${name.toLowerCase()}`}
              aria-describedby={`${id}-${key}`}
              checked={key === value}
              onChange={() => onChange(key)}
            />
            <span>{name}</span>
            <span id={`${id}-${key}`} hidden>
              {about}
            </span>
          </label>
        ))}
      </div>
      <p class="quiet" data-testid={`${testId}-about`}>
        {chosen?.[2] ?? otherwise}
      </p>
    </div>
  );
}

interface NumberInputProps {
  readonly label: string;
  readonly value: number;
  readonly testId: string;
  readonly onChange: (value: number) => void;
}

// A control for a number without known limits.
export function NumberInput({ label, value, testId, onChange }: NumberInputProps) {
  const id = useId();
  const typed = useTyped(String(value), ({ valueAsNumber }) => {
    if (Number.isNaN(valueAsNumber)) return false;
    onChange(valueAsNumber);
    return true;
  });
  return (
    <div class="choice">
      <label for={id}>{label}</label>
      <input id={id} type="number" class="number" step="any" data-testid={testId} {...typed} />
    </div>
  );
}

interface TextInputProps {
  readonly label: string;
  readonly value: string;
  readonly testId: string;
  readonly onChange: (value: string) => void;
}

export function TextInput({ label, value, testId, onChange }: TextInputProps) {
  const id = useId();
  const typed = useTyped(value, (input) => {
    onChange(input.value);
    return true;
  });
  return (
    <div class="choice">
      <label for={id}>{label}</label>
      <input id={id} type="text" data-testid={testId} {...typed} />
    </div>
  );
}

interface TimeInputProps {
  readonly label: string;
  // The value of an input of type datetime-local; empty while it is unknown.
  readonly value: string;
  readonly testId: string;
  readonly onChange: (value: string) => void;
}

// A control for a date and time.
export function TimeInput({ label, value, testId, onChange }: TimeInputProps) {
  const id = useId();
  const typed = useTyped(value, (input) => {
    if (input.value === "") return false;
    onChange(input.value);
    return true;
  });
  return (
    <div class="choice">
      <label for={id}>{label}</label>
      <input id={id} type="datetime-local" data-testid={testId} {...typed} />
    </div>
  );
}

interface SwitchProps {
  readonly label: string;
  readonly checked: boolean;
  readonly testId: string;
  readonly onChange: (checked: boolean) => void;
  // True if something else on the screen shows the label.
  readonly labelHidden?: boolean;
}

export function Switch({ label, checked, testId, onChange, labelHidden }: SwitchProps) {
  return (
    <label class="switch">
      <input
        type="checkbox"
        data-testid={testId}
        checked={checked}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
      <span class={labelHidden ? "visually-hidden" : undefined}>{label}</span>
    </label>
  );
}

interface SectionProps {
  readonly title: string;
  readonly open?: boolean;
  readonly testId: string;
  readonly children: ComponentChildren;
}

// A section of the panel that can be folded.
export function Section({ title, open, testId, children }: SectionProps) {
  return (
    <details class="section" open={open} data-testid={testId}>
      <summary>{title}</summary>
      <div class="section-body">{children}</div>
    </details>
  );
}
