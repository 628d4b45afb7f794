#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/local_scene.h"
#include "app/output_name.h"
#include "app/scene_file.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "interchange/storm_export.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct ExportFlags {
  std::string storm;
  std::string output;
  std::string view;
  SceneFlags scene;
  interchange::ExportOptions options;
};

void Print(const interchange::VdbFile& file, const std::string& path) {
  std::cout << path << "\n";
  for (const interchange::VdbGrid& grid : file.grids) {
    const glm::ivec3& cells = grid.grid.cells;
    const glm::dvec3& spacing_m = grid.grid.spacing_m;
    std::cout << absl::StrFormat(
        "  %-8s extinction (1/m), %d x %d x %d voxels of %g x %g x %.4g m, asymmetry %.3f\n",
        grid.name, cells.x, cells.y, cells.z, spacing_m.x, spacing_m.y, spacing_m.z,
        std::get<double>(grid.metadata.at("asymmetry")));
  }
}

absl::Status Export(const ExportFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("-o", flags.output, {".vdb"}));
  if (!flags.view.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("--view", flags.view, {".json"}));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local, OpenScene(flags.storm, flags.scene));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const interchange::VdbFile file,
      interchange::ExportOf(local.scene, local.fields, local.storm, flags.options));
  {
    const Interruption interruption;
    runs::ProgressBar bar("exporting");
    THUNDERHEAD_RETURN_IF_ERROR(interchange::WriteVdb(
        file, flags.output, [&bar](double share) { bar.Set(share); }, interruption.Token()));
  }
  if (!flags.view.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(
        base::WriteWholeFile(flags.view, interchange::ViewJson(local.scene, *local.fields, file)));
  }
  Print(file, flags.output);
  return absl::OkStatus();
}

}  // namespace

Command AddExport(CLI::App& app) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = app.add_subcommand(
      "export", "Write a storm's extinction as OpenVDB, for renderers such as Blender's");
  command->add_option("STORM", flags->storm, "Storm file or folder")->required();
  command->add_option("-o,--output", flags->output, "File to write: .vdb")->required();
  command->add_flag("--detail", flags->options.detail,
                    absl::StrCat("Add turbulent detail, on voxels of 1/",
                                 interchange::kDetailVoxelsPerCell, " of a cell"));
  command->add_option("--view", flags->view,
                      "Also write camera, sun, picture size and optics as the scene has them: "
                      ".json, for deploy/blender/thunderhead_storm.py");
  AddSceneOptions(*command, flags->scene);
  return {command, [flags] { return Export(*flags); }};
}

}  // namespace thunderhead::app
