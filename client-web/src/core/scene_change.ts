// Computes the difference between two messages, and applies it to a third message. Values outside
// the difference stay as they are in the third message.
import { create, type DescMessage, equals, type Message } from "@bufbuild/protobuf";

export type Side = "before" | "after";

// A message's members by their names. An absent message counts as an empty one.
type Members = Readonly<Record<string, unknown>>;

interface Value {
  readonly kind: "value";
  readonly before: unknown;
  readonly after: unknown;
}

interface Parts {
  readonly kind: "message";
  readonly schema: DescMessage;
  readonly before: Members | undefined;
  readonly after: Members | undefined;
  readonly parts: ReadonlyMap<string, Change>;
}

// A change of a list of messages that has the same length before and after.
interface Items {
  readonly kind: "list";
  readonly items: readonly (Change | undefined)[];
}

export type Change = Value | Parts | Items;

export function changeBetween(
  schema: DescMessage,
  before: Message | undefined,
  after: Message | undefined,
): Change | undefined {
  return changeOfMessage(schema, membersOf(before), membersOf(after));
}

// Returns the message with the changed members as they are in the change's `before` or `after`.
export function withChange<T extends Message>(message: T, change: Change, side: Side): T {
  return applied(message, change, side) as T;
}

function changeOfMessage(
  schema: DescMessage,
  before: Members | undefined,
  after: Members | undefined,
): Change | undefined {
  if (before === after) return undefined;
  const empty = create(schema) as unknown as Members;
  const [from, to] = [before ?? empty, after ?? empty];
  const parts = new Map<string, Change>();
  for (const member of schema.members) {
    const { localName: name } = member;
    const change = changeOfMember(member, from[name], to[name]);
    if (change !== undefined) parts.set(name, change);
  }
  const appears = (before === undefined) !== (after === undefined);
  return parts.size > 0 || appears ? { kind: "message", schema, before, after, parts } : undefined;
}

function changeOfMember(
  member: DescMessage["members"][number],
  before: unknown,
  after: unknown,
): Change | undefined {
  if (before === after) return undefined;
  if (member.kind === "field" && member.fieldKind === "message")
    return changeOfMessage(member.message, membersOf(before), membersOf(after));
  if (
    member.kind === "field" &&
    member.fieldKind === "list" &&
    member.listKind === "message" &&
    Array.isArray(before) &&
    Array.isArray(after) &&
    before.length === after.length
  ) {
    const items = before.map((item, at) =>
      changeOfMessage(member.message, membersOf(item), membersOf(after[at])),
    );
    return items.some((item) => item !== undefined) ? { kind: "list", items } : undefined;
  }
  return { kind: "value", before, after };
}

function applied(present: unknown, change: Change, side: Side): unknown {
  switch (change.kind) {
    case "value":
      return change[side];
    case "list":
      // If the list has a different length, another viewer has changed it. It then stays unchanged.
      if (!Array.isArray(present) || present.length !== change.items.length) return present;
      return present.map((item, at) => {
        const part = change.items[at];
        return part === undefined ? item : applied(item, part, side);
      });
    case "message":
      return appliedToMessage(membersOf(present), change, side);
  }
}

function appliedToMessage(
  present: Members | undefined,
  change: Parts,
  side: Side,
): Members | undefined {
  const { schema, parts } = change;
  const base = present ?? (create(schema) as unknown as Members);
  // The message is absent on this side of the change, so it is removed, unless another viewer has
  // set something in it.
  const other = change[side === "before" ? "after" : "before"];
  if (change[side] === undefined && isSame(schema, base, other)) return undefined;
  const changed = [...parts].map(([name, part]) => [name, applied(base[name], part, side)]);
  return { ...base, ...Object.fromEntries(changed) };
}

function isSame(schema: DescMessage, a: Members, b: Members | undefined): boolean {
  const other = b ?? create(schema);
  return equals(schema, a as unknown as Message, other as unknown as Message);
}

function membersOf(message: unknown): Members | undefined {
  return message as Members | undefined;
}
