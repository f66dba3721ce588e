// The parameters of stored materials. Private to pan.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schemas/generated/pan_layout.h"

namespace panwright::pan {

// The first problem of the parameters that a record uses, in words; none: all are valid. Its model
// numbers must be known.
std::optional<std::string> material_limit_broken(const layout::Material& record);

// The required features of a file with the record: those of BRDFs that format 1.0 lacks.
std::uint64_t features_of(const layout::Material& record);

// The fields of a record that hold the parameters of BRDFs.
std::span<const std::string_view> brdf_slots();

}  // namespace panwright::pan
