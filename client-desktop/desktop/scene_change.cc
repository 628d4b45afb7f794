#include "desktop/scene_change.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace thunderhead::desktop {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::OneofDescriptor;
using google::protobuf::Reflection;
using google::protobuf::util::MessageDifferencer;

using Fields = std::vector<const FieldDescriptor*>;

// Returns a copy of `whole` that contains only the given fields.
std::unique_ptr<Message> PartOf(const Message& whole, const Fields& fields) {
  std::unique_ptr<Message> part(whole.New());
  part->CopyFrom(whole);
  const Reflection& reflection = *whole.GetReflection();
  Fields set;
  reflection.ListFields(whole, &set);
  for (const FieldDescriptor* const field : set) {
    if (std::find(fields.begin(), fields.end(), field) == fields.end()) {
      reflection.ClearField(part.get(), field);
    }
  }
  return part;
}

bool IsSame(const Message& a, const Message& b, const Fields& fields) {
  return MessageDifferencer::Equals(*PartOf(a, fields), *PartOf(b, fields));
}

// Copies fields from `to` to `present`. Clears fields that `to` does not have.
void Copy(const Message& to, const Fields& fields, Message& present) {
  for (const FieldDescriptor* const field : fields) {
    present.GetReflection()->ClearField(&present, field);
  }
  present.MergeFrom(*PartOf(to, fields));
}

Fields FieldsOf(const OneofDescriptor& oneof) {
  Fields fields;
  for (int i = 0; i < oneof.field_count(); ++i) fields.push_back(oneof.field(i));
  return fields;
}

void ChangeItems(const Message& from, const Message& to, const FieldDescriptor& field,
                 Message& present) {
  const Reflection& reflection = *present.GetReflection();
  const int count = reflection.FieldSize(to, &field);
  // If the list in `present` has a different length, another viewer has changed it. It then stays
  // unchanged.
  if (reflection.FieldSize(present, &field) != count) return;
  for (int i = 0; i < count; ++i) {
    MakeChange(reflection.GetRepeatedMessage(from, &field, i),
               reflection.GetRepeatedMessage(to, &field, i),
               *reflection.MutableRepeatedMessage(&present, &field, i));
  }
}

void ChangeMessage(const Message& from, const Message& to, const FieldDescriptor& field,
                   Message& present) {
  const Reflection& reflection = *present.GetReflection();
  const Message& part_from = reflection.GetMessage(from, &field);
  const Message& part_to = reflection.GetMessage(to, &field);
  // `to` does not have the message, so it is removed, unless another viewer has set something in
  // it.
  if (!reflection.HasField(to, &field) &&
      MessageDifferencer::Equals(part_from, reflection.GetMessage(present, &field))) {
    return reflection.ClearField(&present, &field);
  }
  MakeChange(part_from, part_to, *reflection.MutableMessage(&present, &field));
}

}  // namespace

void MakeChange(const Message& from, const Message& to, Message& present) {
  const Reflection& reflection = *present.GetReflection();
  const auto& descriptor = *present.GetDescriptor();
  for (int i = 0; i < descriptor.real_oneof_decl_count(); ++i) {
    const Fields fields = FieldsOf(*descriptor.oneof_decl(i));
    if (!IsSame(from, to, fields)) Copy(to, fields, present);
  }
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor& field = *descriptor.field(i);
    if (field.real_containing_oneof() != nullptr || IsSame(from, to, {&field})) continue;
    const bool message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_map();
    if (message && !field.is_repeated()) {
      ChangeMessage(from, to, field, present);
    } else if (message && reflection.FieldSize(from, &field) == reflection.FieldSize(to, &field)) {
      ChangeItems(from, to, field, present);
    } else {
      Copy(to, {&field}, present);
    }
  }
}

}  // namespace thunderhead::desktop
