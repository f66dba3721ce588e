// The parameters of stored materials. Private to pan.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schemas/generated/pan_layout.h"

namespace panwright::pan {

// Returns the first problem of the parameters that a record uses; none: all are valid. Its model
// numbers must be known.
std::optional<std::string> material_limit_broken(const layout::Material& record);

// Returns the required features of a file with the record: those of BRDFs that format 1.0 lacks.
std::uint64_t features_of(const layout::Material& record);

// The fields of a record that hold the parameters of BRDFs.
std::span<const std::string_view> brdf_slots();

}  // namespace panwright::pan
