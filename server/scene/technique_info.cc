#include "scene/technique_info.h"

#include <type_traits>
#include <utility>

namespace thunderhead::scene {
namespace {

template <typename Kind>
void Add(std::vector<TechniqueInfo>* infos) {
  if constexpr (!std::is_same_v<Kind, OtherTechnique>) {
    infos->push_back({std::string(Kind::kName), Kind::kCapabilities});
  }
}

}  // namespace

std::vector<TechniqueInfo> TechniquesOfTheSchema() {
  std::vector<TechniqueInfo> infos;
  [&]<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
    (Add<std::variant_alternative_t<kIndices, Technique>>(&infos), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Technique>>());
  return infos;
}

}  // namespace thunderhead::scene
