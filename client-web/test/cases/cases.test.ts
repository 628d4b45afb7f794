// Runs the cases that all clients share: tests/clients/README.md.
import { describe, expect, it } from "vitest";
import { runBackOff } from "./back_off";
import { runCamera } from "./camera";
import { type Case, caseFiles, type Runner, runCase } from "./case_files";
import { runControlResumption } from "./control_resumption";
import { runClamp, runLimits } from "./limits";
import { runParameters } from "./parameters";
import { runPlayback } from "./playback";
import { runProjection } from "./projection";
import { runSceneSync } from "./scene_sync";
import { runSessionState } from "./session_state";

const RUNNERS: Readonly<Record<string, Runner>> = {
  back_off: runBackOff,
  camera: runCamera,
  clamp: runClamp,
  control_resumption: runControlResumption,
  limits: runLimits,
  parameters: runParameters,
  playback: runPlayback,
  projection: runProjection,
  scene_sync: runSceneSync,
  session_state: runSessionState,
};

const FILES = caseFiles();

it("runs every case file that names the page, and no other", () => {
  const named = [...FILES].filter(([, { modules }]) => "page" in modules).map(([name]) => name);
  expect(Object.keys(RUNNERS).sort()).toEqual(named.sort());
});

describe.each(Object.keys(RUNNERS))("%s", (module) => {
  const cases = FILES.get(module)?.cases ?? [];
  it.each(cases.map((each): [string, Case] => [each.name, each]))("%s", async (_, each) => {
    const runner = RUNNERS[module];
    if (runner === undefined) throw new Error(`no runner of ${module}`);
    await runCase(runner, each);
  });
});

describe("a case that the runner does not understand fails", () => {
  const actions: Runner = () => ({ add: (step) => ({ sum: step.number("by") }) });
  it.each<[string, Case]>([
    ["does not know the action", { name: "", steps: [{ do: "divide", expect: {} }] }],
    ["does not know: slow", { name: "", steps: [{ do: "add", by: 1, slow: true, expect: {} }] }],
    ["does not know the result", { name: "", steps: [{ do: "add", by: 1, expect: { rest: 0 } }] }],
    ["is 1 in place of 2", { name: "", steps: [{ do: "add", by: 1, expect: { sum: 2 } }] }],
    ["is no number", { name: "", steps: [{ do: "add", by: "1", expect: {} }] }],
    ["does not know: from", { name: "", given: { from: 1 }, steps: [{ do: "add", expect: {} }] }],
    ["expects nothing", { name: "", steps: [{ do: "add", by: 1 }] }],
  ])("%s", async (message, each) => {
    await expect(runCase(actions, each)).rejects.toThrow(message);
  });
});
