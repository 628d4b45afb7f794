#include "load/response_reader.h"

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/wire_format_lite.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::load {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;
using Part = Response::Part;

constexpr std::uint32_t VarintTag(int field) {
  return WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_VARINT);
}

constexpr std::uint32_t MessageTag(int field) {
  return WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
}

// Reads only as far as necessary and never parses the picture. This is possible because servers
// write sequence and own_view before the rest.
bool ReadFrame(CodedInputStream& stream, Response& response) {
  response.part = Part::kFrame;
  while (response.sequence == 0 || response.scene_revision == 0) {
    const std::uint32_t tag = stream.ReadTag();
    if (tag == 0) return true;
    bool ok = false;
    if (tag == VarintTag(v1::Frame::kSequenceFieldNumber)) {
      ok = stream.ReadVarint64(&response.sequence);
    } else if (tag == VarintTag(v1::Frame::kOwnViewFieldNumber)) {
      std::uint64_t own_view = 0;
      ok = stream.ReadVarint64(&own_view);
      response.own_view = own_view != 0;
    } else if (tag == VarintTag(v1::Frame::kSceneRevisionFieldNumber)) {
      ok = stream.ReadVarint64(&response.scene_revision);
    } else {
      ok = WireFormatLite::SkipField(&stream, tag);
    }
    if (!ok) return false;
  }
  return stream.Skip(stream.BytesUntilLimit());
}

bool ReadSceneTaken(CodedInputStream& stream, Response& response) {
  v1::SceneTaken taken;
  if (!taken.MergeFromCodedStream(&stream)) return false;
  response.part = Part::kSceneTaken;
  response.request_id = taken.request_id();
  response.scene_revision = taken.scene_revision();
  return true;
}

bool ReadRefused(CodedInputStream& stream, Response& response) {
  v1::Refused refused;
  if (!refused.MergeFromCodedStream(&stream)) return false;
  response.part = Part::kRefused;
  response.request_id = refused.request_id();
  response.refusal = refused.status().message();
  return true;
}

bool ReadPart(CodedInputStream& stream, std::uint32_t tag, Response& response) {
  if (tag == MessageTag(v1::InteractResponse::kFrameFieldNumber)) {
    return ReadFrame(stream, response);
  }
  if (tag == MessageTag(v1::InteractResponse::kSceneTakenFieldNumber)) {
    return ReadSceneTaken(stream, response);
  }
  return ReadRefused(stream, response);
}

bool IsRead(std::uint32_t tag) {
  return tag == MessageTag(v1::InteractResponse::kFrameFieldNumber) ||
         tag == MessageTag(v1::InteractResponse::kSceneTakenFieldNumber) ||
         tag == MessageTag(v1::InteractResponse::kRefusedFieldNumber);
}

}  // namespace

std::optional<Response> ReadResponse(google::protobuf::io::ZeroCopyInputStream& message) {
  CodedInputStream stream(&message);
  Response response;
  while (const std::uint32_t tag = stream.ReadTag()) {
    if (!IsRead(tag)) {
      if (!WireFormatLite::SkipField(&stream, tag)) return std::nullopt;
      continue;
    }
    int bytes = 0;
    if (!stream.ReadVarintSizeAsInt(&bytes)) return std::nullopt;
    const CodedInputStream::Limit limit = stream.PushLimit(bytes);
    if (stream.BytesUntilLimit() != bytes || !ReadPart(stream, tag, response)) return std::nullopt;
    if (stream.BytesUntilLimit() != 0) return std::nullopt;
    stream.PopLimit(limit);
  }
  if (!stream.ConsumedEntireMessage()) return std::nullopt;
  return response;
}

}  // namespace thunderhead::load
