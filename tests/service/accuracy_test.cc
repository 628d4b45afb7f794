// Tests of sessions and pictures that request an accuracy or a speed. The table of settings and the
// machine are simulated.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "accuracy/named_settings.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/manual_time.h"
#include "tests/support/techniques.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Messages = std::vector<v1::WatchFramesResponse>;
using Stub = v1::ThunderheadService::Stub;

// 64 x 36 pixels with 100 slices are 0.23 million samples.
constexpr double kMegaSamplesAt100Slices = 64 * 36 * 100 * 1e-6;

accuracy::OfferTables Tables() {
  accuracy::PricedSettings table;
  table.size_px = {64, 36};
  accuracy::Setting setting{test_support::PlainScene().rendering.technique};
  for (const auto& [slices, cost_ms, error] :
       {std::tuple{25, 5.0, 0.4}, std::tuple{50, 10.0, 0.3}, std::tuple{100, 20.0, 0.2}}) {
    scene::SetCount(&setting.technique, slices);
    table.rows.push_back({setting, cost_ms, error});
  }
  accuracy::OfferTables tables;
  tables.fill(table);
  tables[1] = absl::FailedPreconditionError("no accuracy can be offered for spotter views");
  return tables;
}

// A fixture with a fake machine whose drawing times are those of the table. The clock advances when
// the machine draws and when a test advances it.
class AccuracyTest : public ::testing::Test {
 protected:
  AccuracyTest() {
    service_.machine->time = &time_;
    service_.machine->ms_per_mega_sample = 20.0 / kMegaSamplesAt100Slices;
  }

  service::ServerOptions Options() const {
    service::ServerOptions options = Patient(time_);
    options.render_loop.offer_tables = Tables;
    return options;
  }

  // Waits until this revision was shown, and then until its frame at rest was drawn and checked.
  bool Settle(Watcher& watcher, std::uint64_t revision) {
    if (!watcher.AwaitFrame(revision, false)) return false;
    time_.Advance(std::chrono::seconds(1));
    return true;
  }

  static v1::Scene WithMaxError(float error) {
    v1::Scene scene = SmallScene();
    scene.mutable_accuracy()->set_max_error(error);
    return scene;
  }
  static v1::Scene WithMaxMilliseconds(float limit_ms) {
    v1::Scene scene = SmallScene();
    scene.mutable_accuracy()->set_max_milliseconds(limit_ms);
    return scene;
  }

  // Waits for a frame at rest of this revision with this number of slices.
  bool AwaitChecked(Watcher& watcher, std::uint64_t revision, std::uint32_t slices) {
    return Settle(watcher, revision) && watcher.Await([=](const Messages& messages) {
      return std::any_of(messages.begin(), messages.end(), [=](const auto& message) {
        const v1::AccuracyReport& report = message.frame().accuracy();
        return message.frame().scene_revision() == revision && report.slices() == slices &&
               report.has_discretisation_error();
      });
    });
  }

  ManualTime time_;
  FakeService service_{Options()};
};

TEST_F(AccuracyTest, EveryFrameSaysItsSettingAndError) {
  const std::string id = service_.Open(WithMaxError(0.35F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitChecked(watcher, 1, 50));
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    const v1::AccuracyReport& report = message.frame().accuracy();
    const v1::LightVolume& light_volume = report.rendering().light_volume();
    EXPECT_EQ(light_volume.transport(), v1::TRANSPORT_CONSISTENT);
    EXPECT_TRUE(light_volume.per_field_phase());
    EXPECT_TRUE(light_volume.detail());  // as the scene requests
    EXPECT_GT(report.estimated_error(), 0.0F);
    EXPECT_TRUE(report.has_expected_milliseconds());
    EXPECT_FALSE(report.has_unmet());
  }
  const v1::AccuracyReport report = watcher.NewestFrame().accuracy();
  EXPECT_EQ(report.slices(), 50U);
  EXPECT_EQ(report.model_error(), 0.3F);
  // The discretisation error of the fake machine's frames is one divided by their number of slices.
  EXPECT_FLOAT_EQ(report.discretisation_error(), 0.02F);
  EXPECT_FLOAT_EQ(report.estimated_error(), std::hypot(0.3F, 0.02F));
  EXPECT_EQ(watcher.NewestFrame().modelled().slices(), 50U);
  EXPECT_EQ(service_.machine->checked, 1);
}

TEST_F(AccuracyTest, UnreachableErrorsGetTheNearestAndSaySo) {
  Watcher watcher(service_.stub(), service_.Open(WithMaxError(0.01F)));
  ASSERT_TRUE(Settle(watcher, 1));
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const v1::AccuracyReport report = watcher.NewestFrame().accuracy();
  EXPECT_EQ(report.slices(), 100U);
  EXPECT_THAT(report.unmet().message(),
              HasSubstr("no setting reaches an error of 0.01 for orbit views; the best has 0.2"));
}

TEST_F(AccuracyTest, TimesAreCorrectedByWhatThisMachineTakes) {
  // Drawing takes four times as long as the table says. The server learns this while the view
  // rests.
  service_.machine->ms_per_mega_sample = 80.0 / kMegaSamplesAt100Slices;
  const std::string id = service_.Open(WithMaxMilliseconds(22.0F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitChecked(watcher, 1, 25));
  const v1::AccuracyReport report = watcher.NewestFrame().accuracy();
  EXPECT_EQ(report.slices(), 25U);
  EXPECT_NEAR(report.expected_milliseconds(), 20.0, 0.1);
  const std::vector<FakeMachine::Drawn> log = service_.machine->Log();
  EXPECT_TRUE(std::any_of(log.begin(), log.end(), [](const FakeMachine::Drawn& drawn) {
    return *scene::SlicesOf(drawn.scene.rendering.technique) == 100;
  }));
}

TEST_F(AccuracyTest, ChangesKeepTheSettingAndAnotherRequestChangesIt) {
  const std::string id = service_.Open(WithMaxError(0.35F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitChecked(watcher, 1, 50));
  v1::Scene turned = WithMaxError(0.35F);
  turned.mutable_camera()->mutable_orbit()->set_azimuth_deg(10.0F);
  std::uint64_t revision = service_.Update(id, turned);
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_EQ(watcher.NewestFrame().accuracy().slices(), 50U);
  revision = service_.Update(id, WithMaxError(0.25F));
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_EQ(watcher.NewestFrame().accuracy().slices(), 100U);
  // If a scene requests no accuracy, its own setting is drawn. The report contains the table's
  // estimates for this setting.
  v1::Scene own = SmallScene();
  own.mutable_rendering()->mutable_light_volume()->set_transport(v1::TRANSPORT_CONSISTENT);
  revision = service_.Update(id, own);
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_EQ(watcher.NewestFrame().modelled().slices(), 16U);
  EXPECT_EQ(watcher.NewestFrame().accuracy().model_error(), 0.4F);
}

TEST_F(AccuracyTest, AViewWithoutATableIsAProblemOnce) {
  v1::Scene scene = WithMaxError(0.35F);
  scene.mutable_camera()->mutable_spotter();
  const std::string id = service_.Open(scene);
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(watcher.Await([](const Messages& messages) { return !messages.empty(); }));
  EXPECT_THAT(watcher.Messages().front().problem().message(), HasSubstr("spotter views"));
  // The render loop checks the session again when another session is drawn.
  time_.Advance(std::chrono::seconds(60));
  Watcher other(service_.stub(), service_.Open(SmallScene()));
  ASSERT_TRUE(other.AwaitFrame(1, false));
  const std::uint64_t revision = service_.Update(id, WithMaxError(0.35F));
  EXPECT_TRUE(Settle(watcher, revision));
  EXPECT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_EQ(std::ranges::count_if(watcher.Messages(),
                                  [](const auto& message) { return message.has_problem(); }),
            1);
}

TEST_F(AccuracyTest, TheErrorIsMeasuredAtRestAndReplacesTheTables) {
  service_.machine->measured_error = 0.25;
  const std::string id = service_.Open(WithMaxError(0.35F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(Settle(watcher, 1));
  ASSERT_TRUE(watcher.Await([](const Messages& messages) {
    return std::ranges::any_of(
        messages, [](const auto& message) { return message.frame().accuracy().measured(); });
  }));
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    const v1::AccuracyReport& report = message.frame().accuracy();
    if (report.measured()) {
      EXPECT_EQ(report.estimated_error(), 0.25F);
      EXPECT_LT(report.error_low(), 0.25F);
      EXPECT_GT(report.error_high(), 0.25F);
      EXPECT_EQ(report.bias(), -0.125F);
      EXPECT_LT(report.bias_low(), report.bias_high());
    } else {
      EXPECT_GE(report.estimated_error(), 0.3F) << "the table's";
      EXPECT_FALSE(report.has_error_low());
    }
  }
  EXPECT_FALSE(watcher.Messages().front().frame().accuracy().measured()) << "nobody waits for it";
  EXPECT_EQ(watcher.NewestFrame().accuracy().model_error(), 0.3F);
  // With another camera the measured error no longer applies.
  v1::Scene turned = WithMaxError(0.35F);
  turned.mutable_camera()->mutable_orbit()->set_azimuth_deg(10.0F);
  const std::uint64_t revision = service_.Update(id, turned);
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  const auto messages = watcher.Messages();
  const auto changed = std::ranges::find_if(
      messages, [&](const auto& message) { return message.frame().scene_revision() == revision; });
  EXPECT_FALSE(changed->frame().accuracy().measured());
}

TEST_F(AccuracyTest, AMeasuredErrorAboveTheLimitIsTold) {
  service_.machine->measured_error = 0.5;
  Watcher watcher(service_.stub(), service_.Open(WithMaxError(0.35F)));
  ASSERT_TRUE(Settle(watcher, 1));
  ASSERT_TRUE(watcher.Await([](const Messages& messages) {
    return !messages.empty() && messages.back().frame().accuracy().measured();
  }));
  EXPECT_THAT(watcher.NewestFrame().accuracy().unmet().message(), HasSubstr("0.5"));
}

TEST_F(AccuracyTest, APicturesErrorIsMeasuredForAsLongAsItAsks) {
  service_.machine->measured_error = 0.25;
  v1::RenderImageRequest request;
  *request.mutable_scene() = WithMaxError(0.35F);
  v1::RenderImageResponse response;
  ASSERT_TRUE(Call(service_.stub(), &Stub::RenderImage, request, &response).ok());
  EXPECT_FALSE(response.accuracy().measured());
  EXPECT_EQ(service_.machine->measured_steps, 0);
  request.set_error_seconds(0.5F);  // a fake step takes 0.1 s
  ASSERT_TRUE(Call(service_.stub(), &Stub::RenderImage, request, &response).ok());
  EXPECT_TRUE(response.accuracy().measured());
  EXPECT_EQ(response.accuracy().estimated_error(), 0.25F);
  EXPECT_EQ(service_.machine->measured_steps, 5);
  request.set_error_seconds(61.0F);
  EXPECT_EQ(Call(service_.stub(), &Stub::RenderImage, request, &response).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(AccuracyTest, ASettingThatIsMeasuredToMissTheLimitIsReplaced) {
  service_.machine->measured_error = 0.5;
  service_.machine->slices_of_half_error = 100;
  const std::string id = service_.Open(WithMaxError(0.35F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitChecked(watcher, 1, 50));
  ASSERT_TRUE(watcher.Await([](const Messages& messages) {
    const v1::AccuracyReport& report = messages.back().frame().accuracy();
    return report.measured() && report.slices() == 100;
  }));
  EXPECT_EQ(watcher.NewestFrame().accuracy().estimated_error(), 0.25F);
  EXPECT_FALSE(watcher.NewestFrame().accuracy().has_unmet());
  // The measurement applies to the next view of the same storm, from its first full frame.
  v1::Scene turned = WithMaxError(0.35F);
  turned.mutable_camera()->mutable_orbit()->set_azimuth_deg(77.0F);
  const std::uint64_t revision = service_.Update(id, turned);
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(watcher.Await([&](const Messages& messages) {
    const v1::Frame& frame = messages.back().frame();
    return frame.scene_revision() == revision && frame.refined();
  }));
  EXPECT_EQ(watcher.NewestFrame().accuracy().slices(), 100U);
}

TEST_F(AccuracyTest, APictureThatIsMeasuredToMissTheLimitIsDrawnBetter) {
  service_.machine->measured_error = 0.5;
  service_.machine->slices_of_half_error = 100;
  v1::RenderImageRequest request;
  *request.mutable_scene() = WithMaxError(0.35F);
  request.set_error_seconds(0.5F);
  v1::RenderImageResponse response;
  ASSERT_TRUE(Call(service_.stub(), &Stub::RenderImage, request, &response).ok());
  EXPECT_EQ(response.modelled().slices(), 100U);
  EXPECT_TRUE(response.accuracy().measured());
  EXPECT_EQ(response.accuracy().estimated_error(), 0.25F);
  EXPECT_FALSE(response.accuracy().has_unmet());
}

TEST_F(AccuracyTest, PicturesAskToo) {
  v1::RenderImageRequest request;
  *request.mutable_scene() = WithMaxError(0.35F);
  v1::RenderImageResponse response;
  const grpc::Status status = Call(service_.stub(), &Stub::RenderImage, request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.modelled().slices(), 50U);
  EXPECT_EQ(response.accuracy().slices(), 50U);
  EXPECT_EQ(response.accuracy().estimated_error(), 0.3F);
  EXPECT_EQ(response.scene().accuracy().max_error(), 0.35F);
}

}  // namespace
}  // namespace thunderhead::testing
