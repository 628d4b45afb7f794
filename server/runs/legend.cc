#include "runs/legend.h"

#include "absl/strings/ascii.h"
#include "absl/strings/strip.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::runs {
namespace {

// Returns true if the chosen technique's setting false_colors is on.
bool ShowsFalseColors(const v1::Rendering& rendering) {
  const google::protobuf::FieldDescriptor* const technique =
      rendering.GetReflection()->GetOneofFieldDescriptor(
          rendering, rendering.GetDescriptor()->FindOneofByName("technique"));
  // A preset is an enumerator, without settings.
  if (technique == nullptr || technique->message_type() == nullptr) return false;
  const google::protobuf::Message& settings =
      rendering.GetReflection()->GetMessage(rendering, technique);
  const google::protobuf::FieldDescriptor* const field =
      settings.GetDescriptor()->FindFieldByName("false_colors");
  return field != nullptr && settings.GetReflection()->GetBool(settings, field);
}

}  // namespace

std::vector<product::LegendEntry> LegendOf(const v1::RenderImageResponse& picture) {
  std::vector<product::LegendEntry> legend;
  if (!ShowsFalseColors(picture.scene().rendering())) return legend;
  for (const v1::FieldParameters& field : picture.scene().fields()) {
    bool shown = false;
    for (const int hydrometeor : picture.modelled().fields()) {
      shown = shown || hydrometeor == static_cast<int>(field.hydrometeor());
    }
    if (!shown) continue;
    const v1::Color& color = field.false_color();
    legend.push_back({absl::AsciiStrToLower(absl::StripPrefix(
                          v1::Hydrometeor_Name(field.hydrometeor()), "HYDROMETEOR_")),
                      {color.red(), color.green(), color.blue()}});
  }
  return legend;
}

}  // namespace thunderhead::runs
