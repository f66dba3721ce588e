// Conversion of materials to glTF. Private to exporters.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "exporters/internal/gltf_textures.h"

namespace panwright::exporters {

// Losses of one or more materials in glTF.
struct Loss {
  std::size_t materials = 0;
  double share = 0;   // of the light of the worst of them, see changed_share()
  std::string worst;  // its name
};

// Faces drawn with a material: both; the front, as the back is invisible; or one side, as the other
// has its own.
enum class Faces : std::uint8_t { both, front, one_side };

// Writer of the materials used by a pan's surfaces, each once.
class MaterialWriter {
 public:
  // Both outlive the writer.
  MaterialWriter(const pan::Model& model, const Job& job)
      : model_(model), job_(job), textures_(model, job) {}

  // Returns the index of a material in the file.
  //
  //   material       of the pan
  //   texture        of the instance, over the diffuse colour; −1: none
  //   has_texcoords  true if the mesh has texture coordinates
  //   faces          that are drawn
  std::size_t place(std::size_t material, std::int32_t texture, bool has_texcoords, Faces faces);

  // Returns true if vertex colours change the material's reflectance: a metal without diffuse light
  // has its own colour.
  bool takes_colors(std::size_t place) const { return takes_colors_[place]; }
  // Records that a mesh with colours has this material.
  void note_colors(std::size_t place);

  const nlohmann::ordered_json& json() const { return json_; }
  const TexturePool& textures() const { return textures_; }
  const std::set<std::string>& extensions() const { return extensions_; }
  const std::map<std::string, Loss>& losses() const { return losses_; }

 private:
  void lose(const std::string& what, double share, std::string_view name);

  const pan::Model& model_;
  const Job& job_;
  TexturePool textures_;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::array();
  std::set<std::string> extensions_;
  std::map<std::string, Loss> losses_;
  std::vector<bool> takes_colors_;
  std::vector<bool> mixes_colors_;  // reflects light that vertex colours do not change
  std::map<std::tuple<std::size_t, std::int32_t, bool, bool>, std::size_t> places_;
};

}  // namespace panwright::exporters
