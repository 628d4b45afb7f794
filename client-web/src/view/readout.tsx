// The readout: the state of the connection, and the pictures' cost in time, bytes and memory.
import { nameOfEncoding } from "../core/encoding";
import { nameOfStage, nameOfTechnique } from "../core/names";
import type { PageState } from "../core/state";
import { formatBitRate, formatBytes, formatNumber } from "../core/units";

// A button with a summary of the connection. A click opens a panel with the cost of the picture.
export function Connection({ state }: { state: PageState }) {
  const frame = state.frame.value;
  const pace = state.pace.value;
  const connection = state.connection.value.kind;
  return (
    <details class="readout" data-testid="readout">
      <summary
        data-frames-per-second={pace.framesPerSecond.toFixed(1)}
        data-latency-ms={pace.latencyMs?.toFixed(0)}
        data-testid="readout-summary"
      >
        <span class={`lamp ${connection}`} aria-hidden="true" />
        <span class="visually-hidden">Connection and cost of the picture: </span>
        <span class="word">{connection}</span>
        {pace.latencyMs !== undefined && (
          <span class="latency">{Math.round(pace.latencyMs)} ms</span>
        )}
        <span class="rate">{formatBitRate(pace.bytesPerSecond)}</span>
      </summary>
      <div class="readout-body">
        {frame !== undefined && <Costs state={state} />}
        <p class="quiet" data-testid="renderer">
          {state.server.value === undefined
            ? ""
            : `${state.server.value.glRenderer} (${state.server.value.device}), Thunderhead ${state.server.value.version}`}
        </p>
      </div>
    </details>
  );
}

function Costs({ state }: { state: PageState }) {
  const frame = state.frame.value;
  if (frame === undefined) return null;
  const total = frame.stages.reduce((sum, stage) => sum + stage.milliseconds, 0);
  return (
    <table class="costs" data-testid="stages">
      <caption class="visually-hidden">Cost of the picture shown</caption>
      <tbody>
        {frame.stages.map((stage) => (
          <tr key={stage.stage}>
            <th scope="row">{nameOfStage(stage.stage)}</th>
            <td>{formatNumber(stage.milliseconds)} ms</td>
            <td class="bar" aria-hidden="true">
              <meter min={0} max={Math.max(total, 1e-3)} value={stage.milliseconds} />
            </td>
          </tr>
        ))}
        <Row name="All stages" text={`${formatNumber(total)} ms`} />
        <Row name="Picture" text={`${frame.widthPx} × ${frame.heightPx}`} />
        {frame.tier > 0 && <Row name="Reduced by" text={`${frame.tier} steps, for this link`} />}
        {frame.ownView && <Row name="View" testId="own-view" text={ownView(state)} />}
        <Row
          name="Sent as"
          testId="encoding"
          text={nameOfEncoding(frame.encoding, state.whyNoVideo.value)}
        />
        <Row name="Bytes" text={formatBytes(frame.bytes)} />
        <Row name="Rate" text={`${formatBytes(state.pace.value.bytesPerSecond)}/s`} />
        <Row name="Frames a second" text={formatNumber(state.pace.value.framesPerSecond)} />
        {frame.modelled !== undefined && (
          <>
            <Row
              name="Technique"
              testId="technique"
              text={nameOfTechnique(frame.modelled.technique)}
            />
            {/* The reference is traced on the CPU: it has no slices and no device memory. */}
            {frame.refinement === undefined && (
              <>
                {frame.modelled.balls > 0 && (
                  <>
                    <Row name="Metaballs" text={String(frame.modelled.balls)} />
                    <Row
                      name="Fit error"
                      text={`${formatNumber(frame.modelled.fitError * 100)} %, root mean square`}
                    />
                  </>
                )}
                {frame.modelled.slices > 0 && (
                  <Row name="Slices drawn" text={String(frame.modelled.slices)} />
                )}
                {frame.modelled.tracedPaths > 0n && (
                  <Row
                    name="Paths traced"
                    testId="traced-paths"
                    text={`${formatNumber(Number(frame.modelled.tracedPaths) / 1e6)} million`}
                  />
                )}
                {frame.modelled.ellipsoids > 0 && (
                  <Row name="Ellipsoids" text={String(frame.modelled.ellipsoids)} />
                )}
                <Row name="Device memory" text={formatBytes(Number(frame.modelled.deviceBytes))} />
                <Row
                  name="Domain drawn"
                  text={`${formatNumber(frame.modelled.occupiedShare * 100)} %`}
                />
              </>
            )}
          </>
        )}
      </tbody>
    </table>
  );
}

// Describes how many people look around. All own views together get half of the server's rendering
// time while the session's view also moves (server/drawing/turns.h).
function ownView({ session }: PageState): string {
  const count = session.othersLookingAround.value + 1;
  if (count === 1) return "Your own, rendered only for you";
  return `Your own; ${count} people look around and share the server's rendering time, so pictures may arrive more slowly`;
}

function Row({ name, text, testId }: { name: string; text: string; testId?: string }) {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td colSpan={2} data-testid={testId}>
        {text}
      </td>
    </tr>
  );
}
