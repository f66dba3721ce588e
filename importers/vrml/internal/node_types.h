// Names of field types in texts.
#pragma once

#include <optional>
#include <string_view>

#include "importers/vrml/internal/document.h"

namespace panwright::importers::vrml {

// Parses "SFVec3f", and equivalent names of VRML 1.0 and later standards.
std::optional<FieldType> field_type(std::string_view name);

// Returns true if a node of VRML 1.0 transforms its successors, and VRML 97 has no node of that
// name.
bool is_transform10(std::string_view name);

}  // namespace panwright::importers::vrml
