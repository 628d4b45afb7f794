#include "renderers/technique.h"

namespace thunderhead::renderers {

absl::Status Technique::MakeContent(const scene::Scene& /*scene*/, const Fields& /*fields*/,
                                    StageTimes* /*times*/) {
  return absl::OkStatus();
}

Content DescribeMedium(const ResidentMedium& medium, const volume::HydrometeorFields& fields,
                       bool leaps) {
  Content content;
  content.fields = scene::HydrometeorsOf(medium.Content().fields);
  if (medium.Empty()) return content;
  const glm::dvec3 box_m = 2.0 * medium.HalfExtent_m();
  const glm::dvec3 domain_m = fields.grid.HighCorner_m() - fields.grid.low_corner_m;
  content.occupied_share = (leaps ? medium.OccupiedShare() : 1.0) * box_m.x * box_m.y * box_m.z /
                           (domain_m.x * domain_m.y * domain_m.z);
  return content;
}

volume::WorldBox BoxOf(const ResidentMedium& medium) {
  return {medium.Middle_m() - medium.HalfExtent_m(), medium.Middle_m() + medium.HalfExtent_m()};
}

}  // namespace thunderhead::renderers
