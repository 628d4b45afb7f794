// Fetches the server's description, its list of storms, and the description of the storm that is
// shown. Also makes and deletes clouds on the server.
import { ConnectError } from "@connectrpc/connect";
import { requestOfCloud } from "../core/cloud";
import type { PageState } from "../core/state";
import type { StormDescription } from "../gen/thunderhead/v1/storm_pb";
import type { ServerCalls } from "../transport/server_calls";

const DESCRIBE_REST_MS = 400;

export class StormsOnServer {
  readonly #calls: ServerCalls;
  readonly #state: PageState;
  #describeTimer: ReturnType<typeof setTimeout> | undefined;
  #making: AbortController | undefined;

  constructor(calls: ServerCalls, state: PageState) {
    this.#calls = calls;
    this.#state = state;
  }

  // Fetches the server's description and storms. If the scene names no storm, shows the first one.
  // Called each time the page joins a session, because the server may be a different one. Also
  // called when the list of storms may have changed.
  async learn(): Promise<void> {
    const { server, storms, scene } = this.#state;
    try {
      server.value = await this.#calls.serverInfo();
      storms.value = await this.#calls.storms();
      const first = storms.value[0];
      if (scene.value.stormId === "" && first !== undefined) {
        this.#state.adoptScene({ ...scene.value, stormId: first.id });
      }
    } catch {
      // This error is ignored. The session's call also detects a lost connection, and this method
      // is called again after the page has reconnected.
    }
  }

  // Fetches the description of the storm at the time that is shown. After a change of the storm
  // this happens at once. After a change of the time it happens with a delay, and not while the
  // times are playing. Call this method in an effect, so that it runs again when a signal changes.
  describeAfterRest(playing: boolean): void {
    const stormId = this.#state.stormId.value;
    const timeIndex = this.#state.timeIndex.value;
    const live = this.#state.connection.value.kind === "live";
    clearTimeout(this.#describeTimer);
    if (stormId === "" || !live) return;
    const known = this.#state.storm.peek();
    if (known?.id !== stormId) void this.#describe(stormId, timeIndex);
    else if (known.timeIndex !== timeIndex && !playing) {
      this.#describeTimer = setTimeout(() => this.#describe(stormId, timeIndex), DESCRIBE_REST_MS);
    }
  }

  // Handles a change of the server's storms or their times.
  async changed(): Promise<void> {
    const stormId = this.#state.stormId.value;
    if (stormId !== "") void this.#describe(stormId, this.#state.timeIndex.value);
    try {
      this.#state.storms.value = await this.#calls.storms();
    } catch {
      // This error is ignored for the same reason as in learn().
    }
  }

  // Returns the storm's description; undefined if the server cannot describe the storm now. The
  // page then reports no error here, because the server will report it when the storm is requested
  // in a scene.
  async description(stormId: string, timeIndex: number): Promise<StormDescription | undefined> {
    try {
      return await this.#calls.describeStorm(stormId, timeIndex);
    } catch {
      return undefined;
    }
  }

  // Makes the cloud that is set in the panel. Returns the id of the new storm; undefined if a
  // setting is invalid, the server failed, or the person stopped it.
  async makeCloud(): Promise<string | undefined> {
    const making = new AbortController();
    this.#making = making;
    this.#state.makingCloud.value = true;
    try {
      const request = requestOfCloud(this.#state.cloud.value);
      const storm = await this.#calls.generateCloud(request, making.signal);
      this.#state.storms.value = await this.#calls.storms();
      this.#state.dismiss("cloud");
      return storm?.id;
    } catch (error) {
      if (making.signal.aborted) return undefined;
      const text = error instanceof ConnectError ? error.rawMessage : String(error);
      this.#state.notify({
        subject: "cloud",
        text: `The cloud could not be made: ${text}`,
        severity: "problem",
      });
      return undefined;
    } finally {
      this.#state.makingCloud.value = false;
    }
  }

  // Deletes a cloud that the server made. A failure becomes a notice.
  async deleteCloud(stormId: string): Promise<void> {
    try {
      await this.#calls.deleteCloud(stormId);
      this.#state.dismiss("cloud");
    } catch (error) {
      const why = error instanceof ConnectError ? error.rawMessage : String(error);
      const text = `The cloud could not be deleted: ${why}`;
      this.#state.notify({ subject: "cloud", text, severity: "problem" });
    }
    await this.learn();
  }

  stopCloud(): void {
    this.#making?.abort();
  }

  dispose(): void {
    this.stopCloud();
    clearTimeout(this.#describeTimer);
  }

  async #describe(stormId: string, timeIndex: number): Promise<void> {
    try {
      const storm = await this.#calls.describeStorm(stormId, timeIndex);
      if (storm === undefined || stormId !== this.#state.stormId.value) return;
      this.#state.storm.value = storm;
      this.#state.dismiss("storm");
    } catch (error) {
      if (this.#state.connection.value.kind !== "live") return;
      const text = `The storm cannot be described: ${String(error)}`;
      this.#state.notify({ subject: "storm", text, severity: "problem" });
    }
  }
}
