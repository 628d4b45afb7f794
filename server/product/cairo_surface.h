// Owning pointers for objects of Cairo and Pango.
#pragma once

#include <pango/pangocairo.h>

#include <memory>

namespace thunderhead::product {

struct CairoDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
struct PangoDeleter {
  void operator()(PangoLayout* layout) const { g_object_unref(layout); }
  void operator()(PangoFontDescription* font) const { pango_font_description_free(font); }
};

using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter>;
using Layout = std::unique_ptr<PangoLayout, PangoDeleter>;
using Font = std::unique_ptr<PangoFontDescription, PangoDeleter>;

}  // namespace thunderhead::product
