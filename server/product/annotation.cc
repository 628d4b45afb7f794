#include "product/annotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/srgb.h"
#include "base/status.h"
#include "product/cairo_surface.h"

namespace thunderhead::product {
namespace {

// The first installed font of this list is used, or fontconfig's substitute.
constexpr char kFont[] = "DejaVu Sans, Liberation Sans, Sans";
constexpr double kLinesInAPicture = 30.0;
constexpr double kMinText_px = 10.0;
// Sizes in units of the line height.
constexpr double kMargin = 0.6;
constexpr double kEdge = 0.16;
constexpr double kSwatch = 0.7;
// Maximum size of the logo, as shares of the picture's height and width.
constexpr double kLogoHeight = 1.0 / 6.0;
constexpr double kLogoWidth = 1.0 / 4.0;

// Returns the picture in Cairo's format: 32 bits per pixel, with the highest eight unused.
CairoSurface SurfaceOf(const frame::RgbImage& image) {
  CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width_px, image.height_px));
  unsigned char* const data = cairo_image_surface_get_data(surface.get());
  if (data == nullptr) return surface;
  const int stride = cairo_image_surface_get_stride(surface.get());
  const std::uint8_t* from = image.rgb.data();
  for (int y = 0; y < image.height_px; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
    for (int x = 0; x < image.width_px; ++x, from += 3) {
      row[x] = std::uint32_t{from[0]} << 16 | std::uint32_t{from[1]} << 8 | from[2];
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

void TakePixels(cairo_surface_t* surface, frame::RgbImage& image) {
  cairo_surface_flush(surface);
  const unsigned char* const data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  std::uint8_t* to = image.rgb.data();
  for (int y = 0; y < image.height_px; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
    for (int x = 0; x < image.width_px; ++x, to += 3) {
      to[0] = static_cast<std::uint8_t>(row[x] >> 16);
      to[1] = static_cast<std::uint8_t>(row[x] >> 8);
      to[2] = static_cast<std::uint8_t>(row[x]);
    }
  }
}

class Pen {
 public:
  Pen(cairo_surface_t* surface, int width_px, int height_px)
      : context_(cairo_create(surface)),
        line_px_(TextHeight_px(height_px)),
        width_px_(width_px),
        height_px_(height_px) {}

  double Line_px() const { return line_px_; }
  double Margin_px() const { return kMargin * line_px_; }
  double Width_px() const { return width_px_; }
  double Height_px() const { return height_px_; }

  // Draws a line of text whose top is at `top_px`. Returns the top of the next line.
  double TextAt(double left_px, double top_px, double max_width_px, const std::string& text,
                PangoWeight weight = PANGO_WEIGHT_NORMAL) {
    const Layout layout = LayoutOf(text, max_width_px, weight);
    cairo_move_to(context_.get(), left_px, top_px);
    pango_cairo_layout_path(context_.get(), layout.get());
    cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_width(context_.get(), 2.0 * kEdge * line_px_);
    Ink(0.0, 0.6);
    cairo_stroke_preserve(context_.get());
    Ink(1.0, 1.0);
    cairo_fill(context_.get());
    return top_px + HeightOf(layout.get());
  }

  double WidthOf(const std::string& text) const {
    const Layout layout = LayoutOf(text, width_px_, PANGO_WEIGHT_NORMAL);
    int width = 0;
    pango_layout_get_pixel_size(layout.get(), &width, nullptr);
    return width;
  }
  double LineHeight_px() const { return HeightOf(LayoutOf("X", 0.0, PANGO_WEIGHT_NORMAL).get()); }

  void Swatch(double left_px, double top_px, const glm::vec3& color) {
    cairo_rectangle(context_.get(), left_px, top_px, kSwatch * line_px_, kSwatch * line_px_);
    Ink(0.0, 0.6);
    cairo_set_line_width(context_.get(), 2.0 * kEdge * line_px_);
    cairo_stroke_preserve(context_.get());
    cairo_set_source_rgb(context_.get(), base::SrgbOfLinear(color.r), base::SrgbOfLinear(color.g),
                         base::SrgbOfLinear(color.b));
    cairo_fill(context_.get());
  }

  // Draws the logo in the upper right corner. Returns the width that it takes.
  double Mark(const Logo& logo) {
    cairo_surface_t* const surface = logo.Surface();
    const double width_px = cairo_image_surface_get_width(surface);
    const double height_px = cairo_image_surface_get_height(surface);
    const double scale =
        std::min({1.0, kLogoHeight * height_px_ / height_px, kLogoWidth * width_px_ / width_px});
    // The logo begins at a whole pixel, so that a small logo remains sharp.
    const double left_px = std::floor(width_px_ - Margin_px() - scale * width_px);
    cairo_save(context_.get());
    cairo_translate(context_.get(), left_px, std::round(Margin_px()));
    cairo_scale(context_.get(), scale, scale);
    cairo_set_source_surface(context_.get(), surface, 0.0, 0.0);
    cairo_pattern_set_filter(cairo_get_source(context_.get()), CAIRO_FILTER_BEST);
    cairo_paint(context_.get());
    cairo_restore(context_.get());
    return width_px_ - left_px;
  }

  // Returns the first error of Cairo, which the context keeps.
  absl::Status Status() const {
    const cairo_status_t status = cairo_status(context_.get());
    if (status == CAIRO_STATUS_SUCCESS) return absl::OkStatus();
    return absl::InternalError(
        absl::StrCat("cannot draw the annotation: ", cairo_status_to_string(status)));
  }

 private:
  void Ink(double grey, double alpha) {
    cairo_set_source_rgba(context_.get(), grey, grey, grey, alpha);
  }

  // Lays out one line. If `max_width_px` is 0, the line may be of any width.
  Layout LayoutOf(const std::string& text, double max_width_px, PangoWeight weight) const {
    Layout layout(pango_cairo_create_layout(context_.get()));
    const Font font(pango_font_description_from_string(kFont));
    pango_font_description_set_weight(font.get(), weight);
    pango_font_description_set_absolute_size(font.get(), 0.8 * line_px_ * PANGO_SCALE);
    pango_layout_set_font_description(layout.get(), font.get());
    pango_layout_set_single_paragraph_mode(layout.get(), TRUE);
    // Invalid UTF-8, for example from a file's attribute, becomes U+FFFD.
    gchar* const valid = g_utf8_make_valid(text.data(), static_cast<gssize>(text.size()));
    pango_layout_set_text(layout.get(), valid, -1);
    g_free(valid);
    if (max_width_px > 0.0) {
      pango_layout_set_width(layout.get(), static_cast<int>(max_width_px * PANGO_SCALE));
      pango_layout_set_ellipsize(layout.get(), PANGO_ELLIPSIZE_END);
    }
    return layout;
  }

  static double HeightOf(PangoLayout* layout) {
    int height = 0;
    pango_layout_get_pixel_size(layout, nullptr, &height);
    return height;
  }

  const CairoContext context_;
  const double line_px_;
  const double width_px_;
  const double height_px_;
};

bool HasFonts() {
  PangoFontFamily** families = nullptr;
  int count = 0;
  // Pango has one default font map for each thread, so no lock is needed.
  pango_font_map_list_families(pango_cairo_font_map_get_default(), &families, &count);
  g_free(families);
  return count > 0;
}

void DrawLegend(const std::vector<LegendEntry>& legend, Pen& pen) {
  double text_px = 0.0;
  for (const LegendEntry& entry : legend) text_px = std::max(text_px, pen.WidthOf(entry.name));
  const double line_px = pen.LineHeight_px();
  const double swatch_px = kSwatch * pen.Line_px();
  const double room_px = pen.Width_px() - 2.0 * pen.Margin_px() - 1.6 * swatch_px;
  const double left_px =
      std::max(pen.Margin_px(), pen.Width_px() - pen.Margin_px() - text_px - 1.6 * swatch_px);
  double top_px = pen.Height_px() - pen.Margin_px() - line_px * static_cast<double>(legend.size());
  for (const LegendEntry& entry : legend) {
    pen.Swatch(left_px, top_px + 0.5 * (line_px - swatch_px), entry.color);
    // The limit of the name's width stays positive in a narrow picture, because 0 would mean that
    // the name may be of any width.
    top_px =
        pen.TextAt(left_px + 1.6 * swatch_px, top_px, std::max(room_px, pen.Line_px()), entry.name);
  }
}

}  // namespace

double TextHeight_px(int picture_height_px) {
  return std::max(kMinText_px, picture_height_px / kLinesInAPicture);
}

absl::Status Annotate(const Annotation& annotation, frame::RgbImage& image) {
  THUNDERHEAD_CHECK(image.rgb.size() == std::size_t{3} * static_cast<std::size_t>(image.width_px) *
                                            static_cast<std::size_t>(image.height_px),
                    "pixels and size");
  if (!HasFonts()) {
    return absl::FailedPreconditionError(
        "--annotate needs a font and this machine has none; install Debian's package "
        "fonts-dejavu-core");
  }
  const CairoSurface surface = SurfaceOf(image);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return absl::ResourceExhaustedError("there is not enough memory to annotate the picture");
  }
  Pen pen(surface.get(), image.width_px, image.height_px);
  double room_px = pen.Width_px() - 2.0 * pen.Margin_px();
  if (annotation.logo != nullptr) room_px -= pen.Mark(*annotation.logo);
  // If the picture is hardly wider than its logo, the title still has room for some letters.
  room_px = std::max(room_px, 3.0 * pen.Line_px());
  const double below_title_px =
      pen.TextAt(pen.Margin_px(), pen.Margin_px(), room_px, annotation.title, PANGO_WEIGHT_BOLD);
  if (!annotation.run.empty()) {
    pen.TextAt(pen.Margin_px(), below_title_px, room_px, annotation.run);
  }
  pen.TextAt(pen.Margin_px(), pen.Height_px() - pen.Margin_px() - pen.LineHeight_px(),
             pen.Width_px() - 2.0 * pen.Margin_px(), annotation.valid_time);
  DrawLegend(annotation.legend, pen);
  THUNDERHEAD_RETURN_IF_ERROR(pen.Status());
  TakePixels(surface.get(), image);
  return absl::OkStatus();
}

}  // namespace thunderhead::product
