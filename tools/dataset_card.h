// Coverage of a data set before anything is rendered, and its data card.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "tools/dataset_folder.h"
#include "workspace/dataset.h"

namespace panwright::tools {

// Returns for range (m), phase (degrees) and pixels of the frames: least, median, most, edges of
// bins, counts.
nlohmann::ordered_json dataset_coverage(std::span<const workspace::PlannedFrame> frames);
// Returns the same as SVG, one plot above the other.
std::string dataset_plots(const nlohmann::ordered_json& coverage);
// Returns a line for each: number, name, range, phase, place and pixels.
std::string dataset_table(std::span<const workspace::PlannedFrame> frames);
// Returns the README of a set.
std::string dataset_card(const workspace::DatasetPlan& plan, const DatasetSettings& settings,
                         const std::string& plan_text, const nlohmann::ordered_json& coverage);

}  // namespace panwright::tools
