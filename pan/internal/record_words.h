// Names of records in messages: "node 'bus/panel'".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pan/model.h"

namespace panwright::pan::internal {

std::string node_words(const Model& model, std::size_t i);
std::string mesh_words(const Model& model, std::size_t i);
std::string material_words(const Model& model, std::size_t i);
std::string texture_words(const Model& model, std::size_t i);
std::string joint_words(const Model& model, std::size_t i);
std::string frame_words(const Model& model, std::size_t i);
std::string keypoint_words(const Model& model, std::size_t i);
std::string decal_words(const Model& model, std::size_t i);
std::string sheet_words(const Model& model, std::size_t i);
std::string instance_words(const Model& model, std::size_t i);
std::string level_words(const Model& model, std::size_t i);
std::string input_words(const Model& model, std::size_t i);
// A material of a back, or -1.
std::string back_words(const Model& model, std::int32_t material);
// A reference to a texture, or -1.
std::string image_words(const Model& model, std::int32_t texture);

}  // namespace panwright::pan::internal
