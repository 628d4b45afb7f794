import { create, fromJson } from "@bufbuild/protobuf";
import { SessionState } from "../../src/core/session_state";
import {
  JoinedSchema,
  MarksSchema,
  PersonSchema,
  PresenceSchema,
} from "../../src/gen/thunderhead/v1/interact_pb";
import type { Observed, Runner } from "./case_files";

export const runSessionState: Runner = (given) => {
  const session = new SessionState();
  const { viewerId, role } = fromJson(PersonSchema, given.json("me"));
  session.joined(create(JoinedSchema, { viewerId, role }));
  const observed = (): Observed => {
    const steerer = session.steerer.value;
    return {
      steers: session.steering.value,
      presents: session.presenting.value,
      alone: session.alone.value,
      asks_control: session.iAsk.value,
      gets_control_at_once: session.steersWhoAsks.value,
      may_look_around: session.mayLookAround.value,
      may_mark: session.mayMark.value,
      steerer: steerer === undefined ? null : session.nameOf(steerer),
    };
  };
  return {
    presence: (step) => {
      session.takePresence(fromJson(PresenceSchema, step.json("presence")));
      return observed();
    },
    marks: (step) => {
      session.takeMarks(fromJson(MarksSchema, step.json("marks")));
      const marks = session.marks.value.map((mark) => ({
        mark_id: Number(mark.markId),
        viewer_id: Number(mark.viewerId),
      }));
      return { marks };
    },
  };
};
