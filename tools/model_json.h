// Contents of a model as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "base/axis_box.h"
#include "pan/model.h"
#include "world/evaluation.h"

namespace panwright::tools {

// Returns the records of a table, as the layout's `json` says.
nlohmann::ordered_json table_json(const pan::Model& model, pan::layout::SectionKind kind);
// Adds the tables that have such members and are not in the object yet, under their names.
void add_other_tables(const pan::Model& model, nlohmann::ordered_json& out);
// world: matrices of the nodes at the given joint values.
nlohmann::ordered_json instances_json(const pan::Model& model);
nlohmann::ordered_json budget_json(const pan::Model& model);
// Returns materials, meshes, textures, frames and inputs.
nlohmann::ordered_json tables_json(const pan::Model& model, const std::vector<Mat4>& world);
// Returns keypoints, sheets, levels and decals.
nlohmann::ordered_json ground_truth_json(const pan::Model& model, const std::vector<Mat4>& world);
// Returns the sections of the file, read by this program or not.
nlohmann::ordered_json sections_json(const pan::Model& model);

// Return the least and largest corner, and the extents in metres and words. null: no bounds.
nlohmann::ordered_json bounds_json(const std::optional<AxisBox>& bounds);
nlohmann::ordered_json size_json(const std::optional<AxisBox>& bounds);

}  // namespace panwright::tools
