// The drawer's list of settings, in groups by the part of the scene.

import { nameOfHydrometeor } from "../core/names";
import { type Parameter, parametersOf, parameterValue, withParameter } from "../core/parameters";
import type { PageState } from "../core/state";
import { formatQuantity } from "../core/units";
import { COMMENTS } from "../gen/comments";
import { Choice, Slider, Switch, TextInput } from "./controls";
import type { Page } from "./page";

// Parameters that the list leaves out, because other parts of the page set them.
const NOT_LISTED = new Set(["storm_id", "time_index"]);

export interface SettingsProps {
  readonly page: Page;
  readonly query: string;
}

export function EverySetting({ page, query }: SettingsProps) {
  const { state } = page;
  const scene = state.scene.value;
  const wanted = query.trim().toLowerCase();
  const found = parametersOf(scene).filter(
    (parameter) => !NOT_LISTED.has(parameter.path) && matches(parameter, wanted),
  );
  const groups = new Map<string, Parameter[]>();
  for (const parameter of found)
    groups.set(parameter.group, [...(groups.get(parameter.group) ?? []), parameter]);
  if (found.length === 0) return <p class="quiet">No setting has such a name.</p>;
  return (
    <>
      <p class="visually-hidden" role="status">
        {found.length} settings
      </p>
      {[...groups].map(([group, parameters]) => (
        <details key={group} class="section" open={wanted !== ""} data-testid={`drawer-${group}`}>
          <summary>{titleOf(group)}</summary>
          <div class="section-body">
            {parameters.map((parameter) => (
              <Setting key={parameter.path} state={state} parameter={parameter} />
            ))}
          </div>
        </details>
      ))}
    </>
  );
}

function matches({ name, path, fullName }: Parameter, wanted: string): boolean {
  return [name, path, COMMENTS[fullName] ?? ""].some((text) => text.toLowerCase().includes(wanted));
}

function titleOf(group: string): string {
  const words = group.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

function Setting({ state, parameter }: { state: PageState; parameter: Parameter }) {
  const value = parameterValue(state.scene.value, parameter);
  const set = (next: unknown) => state.edit((scene) => withParameter(scene, parameter, next));
  const testId = `setting-${parameter.path}`;
  const label = labelOf(state, parameter);
  return (
    <div class="setting">
      {parameter.kind === "number" && (
        <>
          <Slider
            label={label}
            limits={parameter.limits}
            value={(value as number | undefined) ?? parameter.limits.defaultValue}
            giveBack={
              parameter.limits.defaultValue === undefined ? () => set(undefined) : undefined
            }
            testId={testId}
            onChange={set}
          />
          <p class="quiet limits">
            {formatQuantity(parameter.limits.minimum, parameter.limits)} to{" "}
            {formatQuantity(parameter.limits.maximum, parameter.limits)}
            {parameter.limits.defaultValue === undefined
              ? value === undefined
                ? ", left to the server"
                : ""
              : `, default ${formatQuantity(parameter.limits.defaultValue, parameter.limits)}`}
          </p>
        </>
      )}
      {parameter.kind === "flag" && (
        <Switch
          label={label}
          checked={(value as boolean | undefined) ?? parameter.defaultOn}
          testId={testId}
          onChange={set}
        />
      )}
      {parameter.kind === "choice" && (
        <Choice
          label={label}
          value={value as number}
          options={parameter.options.map(({ value: each, name }) => [each, name] as const)}
          testId={testId}
          onChange={set}
        />
      )}
      {parameter.kind === "text" && (
        <TextInput label={label} value={String(value ?? "")} testId={testId} onChange={set} />
      )}
      <p class="quiet">{COMMENTS[parameter.fullName]}</p>
    </div>
  );
}

// Returns the label. The label of a list element names the element.
function labelOf(state: PageState, { name, path, group }: Parameter): string {
  const index = /\[(\d+)\]/.exec(path)?.[1];
  if (index === undefined) return name;
  if (group !== "fields") return `${Number(index) + 1}: ${name}`;
  const field = state.scene.value.fields[Number(index)];
  return `${nameOfHydrometeor(field?.hydrometeor ?? 0)}: ${name}`;
}
