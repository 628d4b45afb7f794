// thunderhead_phase_tables [--only NAME] FOLDER [CURVES.svg]: computes every phase table, or only
// the named one, and writes it into FOLDER. It also draws the curves of the tables.
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "physics/tables/curves_svg.h"
#include "physics/tables/recipes.h"

namespace thunderhead::physics {
namespace {

absl::Status WriteFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    return absl::UnavailableError(
        absl::StrCat("cannot write ", path, "; check that its folder exists and is writable"));
  }
  return absl::OkStatus();
}

// Builds one table, shows the progress, and writes the table.
template <typename Recipe>
absl::Status BuildAndWrite(const Recipe& recipe, const std::string& folder,
                           std::vector<PhaseTable>& tables) {
  WorkPlan plan;
  plan.threads = static_cast<int>(std::thread::hardware_concurrency());
  plan.progress = [&](double done) {
    absl::FPrintF(stderr, "\r%-12s %3.0f %%", recipe.name, 100.0 * done);
  };
  const BuiltTable built = Build(recipe, plan);
  const PhaseTable& table = built.table;
  absl::FPrintF(stderr, "\r%-12s asymmetry %.4f %.4f %.4f, within %g degrees %.3f %.3f %.3f\n",
                recipe.name, table.Asymmetry(0), table.Asymmetry(1), table.Asymmetry(2),
                PhaseTable::kForwardAngleDeg, table.ForwardShare(0), table.ForwardShare(1),
                table.ForwardShare(2));
  tables.push_back(table);
  return WriteFile(absl::StrCat(folder, "/", recipe.name, ".txt"), table.ToText(built.provenance));
}

absl::Status Run(std::vector<std::string> arguments) {
  std::string only;
  if (arguments.size() > 1 && arguments[0] == "--only") {
    only = arguments[1];
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  if (arguments.empty() || arguments.size() > 2) {
    return absl::InvalidArgumentError(
        "usage: thunderhead_phase_tables [--only NAME] FOLDER [CURVES.svg]");
  }
  std::vector<PhaseTable> tables;
  for (const DropletRecipe& recipe : DropletRecipes()) {
    if (!only.empty() && recipe.name != only) continue;
    THUNDERHEAD_RETURN_IF_ERROR(BuildAndWrite(recipe, arguments[0], tables));
  }
  for (const IceRecipe& recipe : IceRecipes()) {
    if (!only.empty() && recipe.name != only) continue;
    THUNDERHEAD_RETURN_IF_ERROR(BuildAndWrite(recipe, arguments[0], tables));
  }
  if (tables.empty()) {
    return absl::NotFoundError(absl::StrCat(
        "there is no recipe '", only, "'; the names are in server/physics/tables/recipes.cc"));
  }
  if (arguments.size() < 2) return absl::OkStatus();
  return WriteFile(arguments[1], CurvesSvg(tables));
}

}  // namespace
}  // namespace thunderhead::physics

int main(int argc, char** argv) {
  const absl::Status status =
      thunderhead::physics::Run(std::vector<std::string>(argv + 1, argv + argc));
  if (status.ok()) return 0;
  absl::FPrintF(stderr, "%s\n", status.message());
  return 1;
}
