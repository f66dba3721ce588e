#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;

Json as_json(const Vec3& v) { return {v.x, v.y, v.z}; }

const char* diffuse_word(std::uint32_t law) {
  constexpr const char* kWords[] = {"lambert", "oren-nayar", "hapke"};
  return kWords[law];
}

const char* specular_word(std::uint32_t law) {
  constexpr const char* kWords[] = {"none", "blinn-phong", "cook-torrance"};
  return kWords[law];
}

struct Totals {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t unique_triangles = 0;
  std::uint64_t unique_vertices = 0;
  double worst_error = 0;  // metres, world: transforms applied
};

// The factor by which a matrix stretches lengths at most: the root of the largest eigenvalue of
// MᵀM, by power iteration from a start that no symmetry makes useless.
double largest_stretch(const Mat4& m) {
  const Mat3 a(m);
  const Mat3 square = glm::transpose(a) * a;
  Vec3 v = glm::normalize(Vec3(0.62, 0.54, 0.57));
  double value = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 next = square * v;
    value = glm::length(next);
    if (!(value > 0)) return 0;
    v = next / value;
  }
  return std::sqrt(value);
}

Totals totals_of(const pan::Model& model) {
  Totals totals;
  const auto world = model.world_from_nodes();
  for (const auto& instance : model.instances()) {
    totals.triangles += model.meshes()[instance.mesh].triangle_count;
    totals.vertices += model.meshes()[instance.mesh].vertex_count;
    totals.worst_error = std::max(totals.worst_error, model.meshes()[instance.mesh].error *
                                                          largest_stretch(world[instance.node]));
  }
  for (const auto& mesh : model.meshes()) {
    totals.unique_triangles += mesh.triangle_count;
    totals.unique_vertices += mesh.vertex_count;
  }
  return totals;
}

Json nodes_json(const pan::Model& model) {
  Json out = Json::array();
  for (std::size_t i = 0; i < model.nodes().size(); ++i) {
    const auto& node = model.nodes()[i];
    Json item;
    item["name"] = model.node_name(i);
    item["parent"] = node.parent < 0 ? Json(nullptr) : Json(node.parent);
    item["translation"] = node.translation;
    item["rotation"] = node.rotation;
    item["scale"] = node.scale;
    out.push_back(std::move(item));
  }
  return out;
}

Json instances_json(const pan::Model& model) {
  Json out = Json::array();
  for (std::size_t i = 0; i < model.instances().size(); ++i) {
    const auto& instance = model.instances()[i];
    Json item{{"node", instance.node}, {"mesh", instance.mesh}, {"material", instance.material}};
    item["texture"] = instance.texture < 0 ? Json(nullptr) : Json(instance.texture);
    if (!model.sources().empty() && model.sources()[i].line > 0) {
      const auto& source = model.sources()[i];
      item["source"] =
          fmt::format("{}:{}:{}", model.string(source.file), source.line, source.column);
    }
    out.push_back(std::move(item));
  }
  return out;
}

Json tables_json(const pan::Model& model) {
  Json out;
  out["materials"] = Json::array();
  for (std::size_t i = 0; i < model.materials().size(); ++i) {
    const auto& material = model.materials()[i];
    out["materials"].push_back({{"name", model.material_name(i)},
                                {"diffuse_law", diffuse_word(material.diffuse_law)},
                                {"specular_law", specular_word(material.specular_law)}});
  }
  out["meshes"] = Json::array();
  for (std::size_t i = 0; i < model.meshes().size(); ++i) {
    const auto& mesh = model.meshes()[i];
    out["meshes"].push_back({{"name", model.mesh_name(i)},
                             {"triangles", mesh.triangle_count},
                             {"vertices", mesh.vertex_count},
                             {"error", mesh.error},
                             {"closed", (mesh.flags & pan::layout::kMeshClosed) != 0}});
  }
  out["textures"] = Json::array();
  for (std::size_t i = 0; i < model.textures().size(); ++i)
    out["textures"].push_back({{"name", model.texture_name(i)},
                               {"width", model.textures()[i].width},
                               {"height", model.textures()[i].height}});
  out["frames"] = Json::array();
  for (std::size_t i = 0; i < model.frames().size(); ++i) {
    const Mat4 m = model.world_from_frame(i);
    out["frames"].push_back({{"name", model.frame_name(i)},
                             {"node", model.frames()[i].node},
                             {"origin", as_json(Vec3(m[3]))},
                             {"right", as_json(glm::normalize(Vec3(m[0])))},
                             {"forward", as_json(glm::normalize(Vec3(m[2])))}});
  }
  out["inputs"] = Json::array();
  for (const auto& input : model.inputs())
    out["inputs"].push_back({{"path", model.string(input.path)},
                             {"bytes", input.bytes},
                             {"xxh3", Hash128{input.hash[0], input.hash[1]}.hex()}});
  return out;
}

void print_text(const std::string& path, const pan::Model& model, const Totals& totals) {
  const auto plural = [](std::uint64_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
  };
  fmt::print("{}: {}, {}, {} in {}\n", path, counted(model.bytes().size(), "byte"),
             counted(totals.triangles, "triangle"), counted(model.instances().size(), "instance"),
             plural(model.meshes().size(), "mesh", "meshes"));
  fmt::print("made by   {} ({})\n", model.version(), model.options());
  fmt::print("build id  {}\n", model.build_id().hex());
  if (const auto bounds = model.world_bounds())
    fmt::print("bounds    {:.6g} {:.6g} {:.6g} .. {:.6g} {:.6g} {:.6g} m\n", bounds->min.x,
               bounds->min.y, bounds->min.z, bounds->max.x, bounds->max.y, bounds->max.z);
  fmt::print("error     {:.4g} m at most between mesh and shape\n", totals.worst_error);
  for (std::size_t i = 0; i < model.meshes().size(); ++i) {
    const auto& mesh = model.meshes()[i];
    fmt::print("mesh      {}: {}, {}, error {:.4g} m in its own frame{}\n", model.mesh_name(i),
               counted(mesh.triangle_count, "triangle"),
               plural(mesh.vertex_count, "vertex", "vertices"), mesh.error,
               mesh.flags & pan::layout::kMeshClosed ? ", closed" : ", open");
  }
  for (std::size_t i = 0; i < model.materials().size(); ++i)
    fmt::print("material  {}: {} + {}\n", model.material_name(i),
               diffuse_word(model.materials()[i].diffuse_law),
               specular_word(model.materials()[i].specular_law));
  for (std::size_t i = 0; i < model.textures().size(); ++i)
    fmt::print("texture   {}: {}x{}\n", model.texture_name(i), model.textures()[i].width,
               model.textures()[i].height);
  for (std::size_t i = 0; i < model.frames().size(); ++i) {
    const Vec3 origin(model.world_from_frame(i)[3]);
    fmt::print("frame     {} at {:.6g} {:.6g} {:.6g}\n", model.frame_name(i), origin.x, origin.y,
               origin.z);
  }
  for (const auto& input : model.inputs())
    fmt::print("input     {}, {} bytes\n", model.string(input.path), input.bytes);
}

}  // namespace

int info(const InfoOptions& options) {
  Session session("info", options.common);
  const auto model = load_model(options.input, options.read, session);
  if (!model) return session.finish();
  const Totals totals = totals_of(*model);
  Json& out = session.result();
  out["file"] = options.input;
  out["bytes"] = model->bytes().size();
  out["format"] = fmt::format("{}.{}", model->header().major, model->header().minor);
  out["build_id"] = model->build_id().hex();
  out["version"] = model->version();
  out["options"] = model->options();
  out["triangles"] = totals.triangles;
  out["vertices"] = totals.vertices;
  out["unique_triangles"] = totals.unique_triangles;
  out["unique_vertices"] = totals.unique_vertices;
  out["error"] = totals.worst_error;
  const auto bounds = model->world_bounds();
  out["bounds"]["min"] = bounds ? as_json(bounds->min) : Json(nullptr);
  out["bounds"]["max"] = bounds ? as_json(bounds->max) : Json(nullptr);
  out["nodes"] = nodes_json(*model);
  out["joints"] = Json::array();
  out["instances"] = instances_json(*model);
  out.update(tables_json(*model));
  if (!options.common.json) print_text(options.input, *model, totals);
  return session.finish();
}

}  // namespace panwright::tools
