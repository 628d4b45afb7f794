import { fromJson } from "@bufbuild/protobuf";
import { ControlResumption } from "../../src/core/control_resumption";
import { PresenceSchema } from "../../src/gen/thunderhead/v1/interact_pb";
import type { Arguments, Runner } from "./case_files";

export const runControlResumption: Runner = () => {
  const resumption = new ControlResumption();
  const presenceOf = (step: Arguments) => fromJson(PresenceSchema, step.json("presence"));
  return {
    rejoin: (step) => {
      const viewerId = BigInt(step.number("viewer_id"));
      const { steeringViewerId, people } = presenceOf(step);
      resumption.rejoined({ viewerId, steered: steeringViewerId === viewerId, people });
      return {};
    },
    presence: (step) => ({ outcome: resumption.of(presenceOf(step), step.flag("presents")) }),
    end: () => {
      resumption.end();
      return {};
    },
  };
};
