#include <memory>
#include <vector>

#include "app/commands.h"

namespace thunderhead::app {

Command AddMeasure(CLI::App& app) {
  CLI::App* measure = app.add_subcommand("measure", "Measure speed, accuracy and stability");
  measure->require_subcommand(1);
  const auto parts = std::make_shared<std::vector<Command>>();
  parts->push_back(AddMeasureFrames(*measure));
  parts->push_back(AddMeasureExtremes(*measure));
  parts->push_back(AddMeasureSlices(*measure));
  parts->push_back(AddMeasureTrade(*measure));
  parts->push_back(AddMeasureLight(*measure));
  parts->push_back(AddMeasureLook(*measure));
  return {measure, [parts] {
            for (const Command& part : *parts) {
              if (part.app->parsed()) return part.run();
            }
            return absl::InvalidArgumentError("measure needs a subcommand");
          }};
}

}  // namespace thunderhead::app
