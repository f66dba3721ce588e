// Labels of a document of products: names, colours and materials.
#pragma once

#include <TDF_Label.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <gp_Trsf.hxx>
#include <optional>
#include <string>
#include <string_view>

#include "base/math.h"

namespace panwright::importers::step {

struct Colour {
  Vec3 rgb{0.8};
  double opacity = 1;
  bool operator==(const Colour&) const = default;
};

// Returns the product behind an occurrence, and sets its place if it has one.
TDF_Label product_of(const TDF_Label& label, gp_Trsf& transform);

// Returns a key that is unique in the document.
std::string key_of(const TDF_Label& label);

std::string name_of(const TDF_Label& label);

// Returns true for names that writers make up when an occurrence has none.
bool made_up(std::string_view name);

std::optional<Colour> color_at(XCAFDoc_ColorTool& colors, const TDF_Label& label);

// Returns the name of the material.
std::string material_at(const TDF_Label& label);

}  // namespace panwright::importers::step
