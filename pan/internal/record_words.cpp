#include "pan/internal/record_words.h"

#include <fmt/core.h>

#include "base/text.h"

namespace panwright::pan::internal {

std::string node_words(const Model& model, std::size_t i) {
  return "node " + in_quotes(model.node_path(i));
}

std::string mesh_words(const Model& model, std::size_t i) {
  return "mesh " + in_quotes(model.mesh_name(i));
}

std::string material_words(const Model& model, std::size_t i) {
  return "material " + in_quotes(model.material_name(i));
}

std::string texture_words(const Model& model, std::size_t i) {
  return "texture " + in_quotes(model.texture_name(i));
}

std::string joint_words(const Model& model, std::size_t i) {
  return fmt::format("joint {}", in_quotes(model.joint_name(i)));
}

std::string frame_words(const Model& model, std::size_t i) {
  return "frame " + in_quotes(model.frame_name(i));
}

std::string keypoint_words(const Model& model, std::size_t i) {
  return "keypoint " + in_quotes(model.keypoint_name(i));
}

std::string decal_words(const Model& model, std::size_t i) {
  return "decal " + in_quotes(model.decal_name(i));
}

std::string sheet_words(const Model& model, std::size_t i) {
  return fmt::format("sheet of {}", mesh_words(model, model.sheets()[i].mesh));
}

std::string instance_words(const Model& model, std::size_t i) {
  const layout::Instance& instance = model.instances()[i];
  return fmt::format("{} at {}", mesh_words(model, instance.mesh),
                     node_words(model, instance.node));
}

std::string level_words(const Model& model, std::size_t i) {
  const layout::Level& level = model.levels()[i];
  return fmt::format("level {} of {}", mesh_words(model, level.mesh),
                     instance_words(model, level.instance));
}

std::string back_words(const Model& model, std::int32_t material) {
  return material < 0 ? "that of the front"
                      : material_words(model, static_cast<std::size_t>(material));
}

std::string image_words(const Model& model, std::int32_t texture) {
  return texture < 0 ? "no texture" : texture_words(model, texture);
}

std::string input_words(const Model& model, std::size_t i) {
  return "input " + in_quotes(model.string(model.inputs()[i].path));
}

}  // namespace panwright::pan::internal
