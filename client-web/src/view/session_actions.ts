// The requests that the session's buttons send: about control, rules, marks, the person's name, and
// the end of the session.
import { ConnectError } from "@connectrpc/connect";
import type { OwnKeys } from "../core/own_keys";
import type { PageState } from "../core/state";
import type { SessionRules } from "../gen/thunderhead/v1/interact_pb";
import type { ServerCalls } from "../transport/server_calls";
import type { SessionClient } from "../transport/session_client";

export class SessionActions {
  readonly #client: SessionClient;
  readonly #calls: ServerCalls;
  readonly #keys: OwnKeys;
  readonly #state: PageState;

  constructor(client: SessionClient, calls: ServerCalls, keys: OwnKeys, state: PageState) {
    this.#client = client;
    this.#calls = calls;
    this.#keys = keys;
    this.#state = state;
  }

  // The name that others see. It is kept for the next session.
  get name(): string {
    return this.#keys.name;
  }

  rename(name: string): void {
    this.#keys.name = name;
    this.#client.send({ case: "setName", value: { name: this.#keys.name } });
  }

  askControl(): void {
    this.#client.send({ case: "askControl", value: {} });
  }

  takeControl(): void {
    this.#client.send({ case: "takeControl", value: {} });
  }

  // Gives control to a person. Without a person, a viewer returns control to the presenter, and a
  // presenter releases it.
  giveControl(viewerId = 0n): void {
    this.#client.send({ case: "giveControl", value: { viewerId } });
  }

  refuseControl(viewerId: bigint): void {
    this.#client.send({ case: "refuseControl", value: { viewerId } });
  }

  setRules(rules: Partial<Omit<SessionRules, "$typeName" | "$unknown">>): void {
    this.#client.send({ case: "setRules", value: { rules } });
  }

  eraseMarks(): void {
    this.#client.send({ case: "eraseMarks", value: {} });
  }

  // Ends the session for all people. Does nothing if this browser does not have the session's
  // presenter key.
  async endSession(): Promise<void> {
    const viewerKey = this.#state.session.viewerKey.peek() ?? "";
    const presenterKey = this.#keys.presenterKey(viewerKey);
    if (presenterKey === undefined) return;
    this.#state.popover.value = undefined;
    try {
      await this.#calls.closeSession(presenterKey);
    } catch (error) {
      const text = `The session could not be ended: ${ConnectError.from(error).rawMessage}`;
      this.#state.notify({ subject: "session", text, severity: "problem" });
    }
  }

  // Opens a session in place of one that has ended.
  openNewSession(): void {
    const { session, connection } = this.#state;
    session.ended.value = undefined;
    session.viewerKey.value = undefined;
    connection.value = { kind: "connecting" };
    this.#client.openNew();
  }
}
