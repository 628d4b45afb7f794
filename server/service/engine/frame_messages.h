// Converts frames, accuracy reports and a session's problems to messages.
#pragma once

#include "delivery/frame_hub.h"
#include "drawing/frame_source.h"
#include "scene/frame_stage.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

void ToMessage(const delivery::Modelled& modelled, v1::Modelled& message);
void ToMessage(const delivery::Refinement& refinement, v1::Refinement& message);
void ToMessage(const accuracy::AccuracyReport& report, v1::AccuracyReport& message);
void ToMessage(const delivery::EncodedFrame& frame, v1::Frame& message);
void ToMessage(const delivery::Problem& problem, v1::Problem& message);
void ToMessage(const scene::StageTime& time, v1::StageCost& message);

}  // namespace thunderhead::service
