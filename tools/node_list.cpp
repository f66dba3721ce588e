#include "tools/node_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

namespace panwright::tools {

namespace {

std::string on_one_line(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      out += c;
  return out;
}

// Names from the root down, "bus/panel".
std::string path_of(const pan::Model& model, std::size_t node) {
  std::string path(model.node_name(node));
  for (std::int32_t up = model.nodes()[node].parent; up > 0;
       up = model.nodes()[static_cast<std::size_t>(up)].parent)
    path = std::string(model.node_name(static_cast<std::size_t>(up))) + "/" + path;
  return path;
}

}  // namespace

std::string node_list(const pan::Model& model) {
  struct Surface {
    std::uint64_t triangles = 0;
    std::vector<std::uint32_t>
        materials;  // of both sides, in the order of the instances, each once
  };
  std::vector<Surface> surfaces(model.nodes().size());
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const auto& instance = model.instances()[i];
    Surface& surface = surfaces[instance.node];
    surface.triangles += model.meshes()[instance.mesh].triangle_count;
    auto& known = surface.materials;
    for (const std::int64_t side :
         {std::int64_t{instance.material}, static_cast<std::int64_t>(model.back_of(i))}) {
      const auto material = static_cast<std::uint32_t>(side);
      if (side >= 0 && std::find(known.begin(), known.end(), material) == known.end())
        known.push_back(material);
    }
  }
  std::string out = "name\ttriangles\tmaterials\tid\tpath\n";
  for (std::size_t i = 1; i < surfaces.size(); ++i) {
    out += fmt::format("{}\t{}\t", on_one_line(model.node_name(i)), surfaces[i].triangles);
    for (std::size_t k = 0; k < surfaces[i].materials.size(); ++k)
      out += (k > 0 ? ", " : "") + on_one_line(model.material_name(surfaces[i].materials[k]));
    out += fmt::format("\t{}\t{}\n", i + 1, on_one_line(path_of(model, i)));
  }
  return out;
}

}  // namespace panwright::tools
