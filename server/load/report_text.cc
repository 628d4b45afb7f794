#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "load/report.h"

namespace thunderhead::load {
namespace {

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted.push_back('\\');
    quoted.push_back(static_cast<unsigned char>(c) < 0x20 ? ' ' : c);
  }
  return quoted + "\"";
}

std::string Json(const std::optional<double>& value) {
  return value.has_value() ? absl::StrFormat("%.4g", *value) : "null";
}

std::string Json(const std::optional<Percentiles>& latency) {
  const Percentiles values = latency.value_or(Percentiles{});
  const auto json = [&](double value) {
    return latency.has_value() ? Json(std::optional(value)) : "null";
  };
  return absl::StrCat("{\"p50\": ", json(values.p50), ", \"p95\": ", json(values.p95),
                      ", \"p99\": ", json(values.p99), "}");
}

// Returns the values of `figures` as lines of JSON, without braces.
std::string Keys(const ViewerFigures& figures) {
  if (figures.viewers == 0) {
    const std::string none = Json(std::optional<Percentiles>());
    return absl::StrCat("\"fps_min\": null, \"fps_median\": null, \"latency_ms\": ", none,
                        ", \"spread_ms\": ", none,
                        ", \"kbit_per_viewer\": null, \"bytes_per_frame\": null");
  }
  return absl::StrFormat(
      "\"fps_min\": %.4g, \"fps_median\": %.4g, \"latency_ms\": %s, \"spread_ms\": %s, "
      "\"kbit_per_viewer\": %.5g, "
      "\"bytes_per_frame\": %.6g",
      figures.fps_min, figures.fps_median, Json(figures.latency_ms), Json(figures.spread_ms),
      figures.kbit_per_viewer, figures.bytes_per_frame);
}

std::string Json(const FirstFrames& first) {
  return absl::StrCat("{\"median\": ", Json(first.median_ms), ", \"most\": ", Json(first.most_ms),
                      "}");
}

std::string ThrottledJson(const Report& report) {
  const ViewerFigures& figures = report.throttled;
  if (figures.viewers == 0) return "null";
  return absl::StrFormat(
      "{\"viewers\": %d, \"kbit_limit\": %.6g, %s, \"first_frame_ms\": %s, "
      "\"latency_first_third_ms\": %s, \"latency_last_third_ms\": %s}",
      figures.viewers, report.throttle_kbit_per_s, Keys(figures), Json(report.throttled_first),
      Json(figures.latency_growth.first_third_ms), Json(figures.latency_growth.last_third_ms));
}

std::string LookingJson(const Report& report) {
  if (report.looking.viewers == 0) return "null";
  return absl::StrFormat("{\"viewers\": %d, %s, \"first_frame_ms\": %s}", report.looking.viewers,
                         Keys(report.looking), Json(report.looking_first));
}

std::string PassingJson(const Report& report) {
  if (report.passing == 0) return "null";
  return absl::StrFormat("{\"viewers\": %d, \"visits\": %d, \"first_frame_ms\": %s}",
                         report.passing, report.passing_first.count, Json(report.passing_first));
}

std::string ImagesJson(const ImageBurstFigures& images) {
  if (images.asked == 0) return "null";
  return absl::StrFormat("{\"asked\": %d, \"came\": %d, \"ms\": {\"median\": %s, \"most\": %s}}",
                         images.asked, images.came, Json(images.median_ms), Json(images.most_ms));
}

std::string ServerJson(const std::optional<ServerFigures>& server) {
  if (!server.has_value()) return "\"server_rss_mb\": null,\n  \"server_cpu\": null";
  const std::string over_time =
      absl::StrJoin(server->rss_over_time_mb, ", ", [](std::string* text, const auto& sample) {
        absl::StrAppendFormat(text, "[%.1f, %.1f]", sample.first, sample.second);
      });
  return absl::StrFormat(
      "\"server_rss_mb\": {\"first\": %.1f, \"last\": %.1f, \"most\": %.1f, \"over_time\": [%s]},\n"
      "  \"server_cpu\": %.3g",
      server->rss_first_mb, server->rss_last_mb, server->rss_most_mb, over_time, server->cpu);
}

std::string Text(const ViewerFigures& figures) {
  std::string text = absl::StrFormat("  frames a second  least %.1f, median %.1f\n",
                                     figures.fps_min, figures.fps_median);
  if (figures.latency_ms.has_value()) {
    absl::StrAppendFormat(&text, "  latency          p50 %.0f ms, p95 %.0f ms, p99 %.0f ms\n",
                          figures.latency_ms->p50, figures.latency_ms->p95,
                          figures.latency_ms->p99);
  }
  if (figures.spread_ms.has_value() && figures.viewers > 1) {
    absl::StrAppendFormat(
        &text, "  first to last    p50 %.0f ms, p95 %.0f ms, p99 %.0f ms between viewers\n",
        figures.spread_ms->p50, figures.spread_ms->p95, figures.spread_ms->p99);
  }
  absl::StrAppendFormat(&text, "  bytes            %.0f kbit/s a viewer, %.1f kB a frame\n",
                        figures.kbit_per_viewer, 1e-3 * figures.bytes_per_frame);
  return text;
}

void AppendFirst(const FirstFrames& first, std::string& text) {
  if (!first.median_ms.has_value() || !first.most_ms.has_value()) return;
  absl::StrAppendFormat(&text, "  first frame      after %.0f ms (median), %.0f ms (most)\n",
                        *first.median_ms, *first.most_ms);
}

void AppendThrottled(const Report& report, std::string& text) {
  const ViewerFigures& figures = report.throttled;
  if (figures.viewers == 0) return;
  absl::StrAppendFormat(&text, "throttled: %d that read at most %.0f kbit/s\n%s", figures.viewers,
                        report.throttle_kbit_per_s, Text(figures));
  AppendFirst(report.throttled_first, text);
  const Growth& growth = figures.latency_growth;
  if (growth.first_third_ms.has_value() && growth.last_third_ms.has_value()) {
    absl::StrAppendFormat(&text,
                          "  latency over time  median %.0f ms in the first third, %.0f ms in the "
                          "last\n",
                          *growth.first_third_ms, *growth.last_third_ms);
  }
}

void AppendImages(const ImageBurstFigures& images, std::string& text) {
  if (images.asked == 0) return;
  absl::StrAppendFormat(&text, "images: %d asked for at once, %d came\n", images.asked,
                        images.came);
  if (!images.median_ms.has_value() || !images.most_ms.has_value()) return;
  absl::StrAppendFormat(&text, "  came             after %.1f s (median), %.1f s (most)\n",
                        1e-3 * *images.median_ms, 1e-3 * *images.most_ms);
}

void AppendServer(const Report& report, std::string& text) {
  if (!report.server.has_value()) return;
  const ServerFigures& server = *report.server;
  absl::StrAppendFormat(
      &text,
      "server\n  processors       %.2f busy\n"
      "  memory           %.0f MB first, %.0f MB last, %.0f MB most\n"
      "    over time      %s\n",
      server.cpu, server.rss_first_mb, server.rss_last_mb, server.rss_most_mb,
      absl::StrJoin(server.rss_over_time_mb, " ", [](std::string* out, const auto& sample) {
        absl::StrAppendFormat(out, "%.0f", sample.second);
      }));
}

}  // namespace

std::string ToText(const Report& report) {
  std::string text = absl::StrFormat(
      "%d viewers by %s for %.1f s, %d x %d pixels, %g updates a second\n", report.Main().viewers,
      report.transport, report.seconds, report.width_px, report.height_px, report.steer_hz);
  if (report.healthy.viewers > 0) text += Text(report.healthy);
  AppendFirst(report.healthy_first, text);
  if (report.looking.viewers > 0) {
    absl::StrAppendFormat(&text, "looking around: %d\n%s", report.looking.viewers,
                          Text(report.looking));
    AppendFirst(report.looking_first, text);
  }
  AppendThrottled(report, text);
  if (report.stalled > 0) absl::StrAppendFormat(&text, "stalled: %d\n", report.stalled);
  if (report.passing > 0) {
    absl::StrAppendFormat(&text, "passing: %d who left and came again, %d visits\n", report.passing,
                          report.passing_first.count);
    AppendFirst(report.passing_first, text);
  }
  AppendImages(report.images, text);
  AppendServer(report, text);
  absl::StrAppendFormat(&text, "this program\n  processors       %.2f busy\nerrors: %d\n",
                        report.own_cpu, report.ErrorCount());
  for (const auto& [message, count] : report.errors) {
    absl::StrAppendFormat(&text, "  %d x %s\n", count, message);
  }
  return text;
}

std::string ToJson(const Report& report) {
  const std::string errors =
      absl::StrJoin(report.errors, ", ", [](std::string* text, const auto& error) {
        absl::StrAppend(text, Quoted(error.first), ": ", error.second);
      });
  return absl::StrFormat(
      "{\n  \"transport\": %s, \"seconds\": %.4g, \"width_px\": %d, \"height_px\": %d, "
      "\"steer_hz\": %g,\n"
      "  \"viewers\": %d, %s,\n"
      "  \"first_frame_ms\": %s,\n"
      "  \"looking\": %s,\n  \"throttled\": %s,\n  \"stalled\": %d,\n  \"passing\": %s,\n  "
      "\"stills\": %s,\n  %s,\n  "
      "\"client_cpu\": "
      "%.3g,\n"
      "  \"errors\": %d, \"error_messages\": {%s}\n}\n",
      Quoted(report.transport), report.seconds, report.width_px, report.height_px, report.steer_hz,
      report.Main().viewers, Keys(report.Main()), Json(report.MainFirst()), LookingJson(report),
      ThrottledJson(report), report.stalled, PassingJson(report), ImagesJson(report.images),
      ServerJson(report.server), report.own_cpu, report.ErrorCount(), errors);
}

}  // namespace thunderhead::load
