#include "importers/mesh_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace panwright::importers {

namespace {

using Json = nlohmann::ordered_json;
using geometry::CleanReport;
using geometry::SpotKind;

struct Member {
  const char* name;
  std::uint64_t CleanReport::*value;
  const char* one;  // in words; none: not told by itself
  const char* many;
};

constexpr Member kMembers[] = {
    {"vertices_before", &CleanReport::vertices_before, nullptr, nullptr},
    {"vertices_after", &CleanReport::vertices_after, nullptr, nullptr},
    {"triangles_before", &CleanReport::triangles_before, nullptr, nullptr},
    {"triangles_after", &CleanReport::triangles_after, nullptr, nullptr},
    {"welded", &CleanReport::welded, "vertex welded", "vertices welded"},
    {"degenerate", &CleanReport::degenerate, "degenerate triangle", "degenerate triangles"},
    {"duplicates", &CleanReport::duplicates, "duplicate triangle", "duplicate triangles"},
    {"flipped", &CleanReport::flipped, "triangle turned", "triangles turned"},
    {"normals_turned", &CleanReport::normals_turned, "triangle with normals turned",
     "triangles with normals turned"},
    {"components", &CleanReport::components, nullptr, nullptr},
    {"closed_components", &CleanReport::closed_components, nullptr, nullptr},
    {"one_sided", &CleanReport::one_sided, "component without two sides",
     "components without two sides"},
    {"non_manifold_edges", &CleanReport::non_manifold_edges, "edge of three triangles or more",
     "edges of three triangles or more"},
    {"border_edges", &CleanReport::border_edges, nullptr, nullptr},
    {"boundary_loops", &CleanReport::boundary_loops, nullptr, nullptr},
    {"holes", &CleanReport::holes, "hole", "holes"},
    {"filled", &CleanReport::filled, "hole filled", "holes filled"},
    {"t_junctions", &CleanReport::t_junctions, "T-junction", "T-junctions"},
};

std::string words(const CleanReport& report) {
  std::string out;
  for (const Member& member : kMembers) {
    const std::uint64_t value = report.*member.value;
    if (!member.one || value == 0) continue;
    fmt::format_to(std::back_inserter(out), "{}{} {}", out.empty() ? "" : ", ", value,
                   value == 1 ? member.one : member.many);
  }
  return out;
}

void add_numbers(const CleanReport& report, Json& out) {
  for (const Member& member : kMembers) out[member.name] = report.*member.value;
  // as they were called
  out["pieces"] = report.components;
  out["closed_pieces"] = report.closed_components;
  out["rims"] = report.boundary_loops;
  out["largest_move"] = report.largest_move;
  out["hole_length"] = report.hole_length;
}

}  // namespace

const char* kind_name(SpotKind kind) {
  switch (kind) {
    case SpotKind::non_manifold_edge:
      return "non-manifold edge";
    case SpotKind::hole:
      return "hole";
    case SpotKind::t_junction:
      return "T-junction";
    case SpotKind::flipped:
      return "turned";
  }
  return "";
}

std::string to_text(const MeshReport& mesh_report) {
  const CleanReport& total = mesh_report.total;
  std::string out = fmt::format(
      "{} {}, {} triangles ({} before), {} vertices ({} before)\n", mesh_report.meshes.size(),
      mesh_report.meshes.size() == 1 ? "mesh" : "meshes", total.triangles_after,
      total.triangles_before, total.vertices_after, total.vertices_before);
  const std::string all = words(total);
  out += all.empty() ? "nothing to clean\n" : all + "\n";
  for (const MeshQuality& mesh : mesh_report.meshes) {
    const std::string one = words(mesh.report);
    if (!one.empty()) fmt::format_to(std::back_inserter(out), "  {}: {}\n", mesh.path, one);
  }
  return out;
}

std::string to_json(const MeshReport& mesh_report) {
  Json out;
  out["schema"] = 1;
  out["total"] = Json::object();
  add_numbers(mesh_report.total, out["total"]);
  out["meshes"] = Json::array();
  for (const MeshQuality& mesh : mesh_report.meshes) {
    Json one;
    one["path"] = mesh.path;
    one["shape"] = mesh.shape;
    one["instances"] = mesh.instances;
    add_numbers(mesh.report, one);
    out["meshes"].push_back(std::move(one));
  }
  out["spots"] = Json::array();
  for (const WorldSpot& spot : mesh_report.spots)
    out["spots"].push_back({{"kind", kind_name(spot.kind)},
                            {"at", {spot.at.x, spot.at.y, spot.at.z}},
                            {"length", spot.length},
                            {"size", spot.size},
                            {"mesh", spot.mesh}});
  // names come from files and may hold any bytes
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace panwright::importers
