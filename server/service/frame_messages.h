// Frames, the report of their accuracy and a session's problems as messages.
#pragma once

#include "scene/frame_stage.h"
#include "session/frame_hub.h"
#include "session/frame_source.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

void ToMessage(const session::Modelled& modelled, v1::Modelled& message);
void ToMessage(const session::Refinement& refinement, v1::Refinement& message);
void ToMessage(const session::AccuracyReport& report, v1::AccuracyReport& message);
void ToMessage(const session::EncodedFrame& frame, v1::Frame& message);
void ToMessage(const session::Problem& problem, v1::Problem& message);
void ToMessage(const scene::StageTime& time, v1::StageCost& message);

}  // namespace thunderhead::service
