// The records of the tables: the field rules of the layout, then the checks across fields.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <string_view>

#include "base/parallel.h"
#include "base/text.h"
#include "pan/fields.h"
#include "pan/internal/identity.h"
#include "pan/internal/material_limits.h"
#include "pan/internal/mesh_stream.h"
#include "pan/internal/report.h"
#include "pan/internal/scan.h"

namespace panwright::pan::internal {

namespace {

using layout::SectionKind;

const layout::SectionInfo& info(SectionKind kind) { return section_info(kind); }

// ---- strings

std::optional<Problem> offsets_problem(const Model& model) {
  const auto offsets = model.string_offsets();
  const std::uint64_t bytes = count_of(model, SectionKind::string_bytes);
  if (offsets.size() < 2 || offsets[0] != 0 || offsets[1] != 0)
    return Problem{Code("E4010"), "string_offsets do not begin with an empty string"};
  for (std::size_t i = 1; i < offsets.size(); ++i)
    if (offsets[i] < offsets[i - 1])
      return Problem{
          Code("E4010"),
          fmt::format("string_offsets[{}] is {}, expected at least {}, the one before it", i,
                      offsets[i], offsets[i - 1])};
  if (offsets.back() != bytes)
    return Problem{Code("E4010"),
                   fmt::format("the strings end at byte {}, but string_bytes has {} bytes",
                               offsets.back(), bytes)};
  return {};
}

std::optional<Problem> text_problem(const Model& model) {
  constexpr std::size_t kGroup = 4096;  // strings a task
  const std::size_t count = model.string_offsets().size() - 1;
  std::vector<Tally> groups((count + kGroup - 1) / kGroup);
  parallel_for(groups.size(), [&](std::size_t g) {
    const std::size_t end = std::min(count, (g + 1) * kGroup);
    for (std::size_t i = g * kGroup; i < end; ++i)
      if (!is_text(unchecked_string(model, static_cast<std::uint32_t>(i)))) groups[g].add(i);
  });
  Tally all;
  for (const Tally& group : groups) all.add(group);
  if (all.count == 0) return {};
  return Problem{
      Code("E4014"),
      fmt::format("string {} is not valid UTF-8 text without NUL{}", all.first,
                  all.count > 1 ? fmt::format(" (and {} more)", all.count - 1) : std::string())};
}

// ---- nodes

bool is_finite(const Mat4& m) {
  for (int k = 0; k < 4; ++k)
    if (!panwright::is_finite(Vec3(m[k])) || !std::isfinite(m[k].w)) return false;
  return true;
}

// The first problem of the tree.
std::optional<Problem> node_problem(const Model& model) {
  const auto nodes = model.nodes();
  if (nodes.empty())
    return Problem{Code("E4012"), "the file has no nodes, expected at least a root"};
  std::vector<std::uint32_t> depths(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::int64_t parent = nodes[i].parent;
    if (i == 0 && parent == -1) {
      depths[i] = 1;
      continue;
    }
    if (i == 0 || parent < 0)
      return Problem{
          i == 0 ? Code("E4011") : Code("E4010"),
          fmt::format("nodes[{}].parent is {}, {}", i, parent,
                      i == 0 ? "expected -1 for the root" : "but only node 0 may have no parent")};
    if (parent >= static_cast<std::int64_t>(i))
      return Problem{
          Code("E4011"),
          fmt::format("nodes[{}].parent is {}, expected a node before its child", i, parent)};
    depths[i] = depths[parent] + 1;
    if (depths[i] > layout::kMaxDepth)
      return Problem{Code("E4012"), fmt::format("nodes[{}] is at depth {}, expected at most {}", i,
                                                depths[i], layout::kMaxDepth)};
  }
  return {};
}

// Whether all that is drawn, every node and every keypoint has finite world coordinates.
std::optional<Problem> world_problem(const Model& model) {
  const std::vector<Mat4> world = model.world_from_nodes();
  for (std::size_t i = 0; i < world.size(); ++i)
    if (!is_finite(world[i]))
      return Problem{Code("E4012"),
                     fmt::format("nodes[{}] has world coordinates that are not finite", i)};
  const auto instances = model.instances();
  const auto is_reachable = [&](const layout::Mesh& mesh, const Mat4& m) {
    Vec3 furthest;
    for (int k = 0; k < 3; ++k)
      furthest[k] = std::fabs(mesh.origin[k]) +
                    std::fmax(std::fabs(mesh.bounds_min[k]), std::fabs(mesh.bounds_max[k]));
    Vec3 reach = glm::abs(Vec3(m[3]));
    for (int k = 0; k < 3; ++k) reach += glm::abs(Vec3(m[k])) * furthest[k];
    return panwright::is_finite(reach);
  };
  for (std::size_t i = 0; i < instances.size(); ++i)
    if (!is_reachable(model.meshes()[instances[i].mesh], world[instances[i].node]))
      return Problem{Code("E4012"),
                     fmt::format("instances[{}] has world coordinates that are not finite", i)};
  const auto levels = model.levels();
  for (std::size_t i = 0; i < levels.size(); ++i)
    if (!is_reachable(model.meshes()[levels[i].mesh], world[instances[levels[i].instance].node]))
      return Problem{Code("E4012"),
                     fmt::format("levels[{}] has world coordinates that are not finite", i)};
  const auto keypoints = model.keypoints();
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const double* p = keypoints[i].position;
    if (!panwright::is_finite(Vec3(world[keypoints[i].node] * Vec4(p[0], p[1], p[2], 1.0))))
      return Problem{Code("E4012"),
                     fmt::format("keypoints[{}] has world coordinates that are not finite", i)};
  }
  return {};
}

std::optional<Problem> lamp_problem(const Model& model) {
  const std::vector<Mat4> world = model.world_from_nodes();
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < model.lamps().size(); ++i) {
    const layout::Lamp& lamp = model.lamps()[i];
    const auto wrong = [&](std::string_view what) {
      return Problem{Code("E4012"), fmt::format("lamps[{}] {}", i, what)};
    };
    // note: not lamp_name(), which is of checked models; the table of strings is sound here
    const auto offsets = model.string_offsets();
    const std::string_view name(model.string_bytes().data() + offsets[lamp.name],
                                offsets[lamp.name + 1] - offsets[lamp.name]);
    if (name.empty() || !names.insert(name).second) return wrong("has no name of its own");
    const auto kind = static_cast<layout::LampKind>(lamp.kind);
    if (kind == layout::LampKind::spot && !(lamp.half_angle > 0 && lamp.half_angle <= kPi))
      return wrong("is a spot with a half_angle outside 0 to pi");
    if (kind == layout::LampKind::disc && !(lamp.radius > 0))
      return wrong("is a disc with a radius that is not above 0");
    if ((lamp.flags & layout::kLampPulsed) != 0 && !(lamp.pulse[0] < lamp.pulse[1]))
      return wrong("has a pulse that does not end after its begin");
    const double* p = lamp.position;
    if (!panwright::is_finite(Vec3(world[lamp.node] * Vec4(p[0], p[1], p[2], 1.0))))
      return wrong("has world coordinates that are not finite");
  }
  return {};
}

// ---- runs in the arrays

std::optional<Problem> mesh_form_problem(const layout::Mesh& mesh, std::size_t i) {
  if (mesh.index_size != 2 && mesh.index_size != 4)
    return Problem{Code("E4012"),
                   fmt::format("meshes[{}].index_size is {}, expected 2 or 4", i, mesh.index_size)};
  if (mesh.index_size == 2 && mesh.vertex_count > layout::kMaxShortVertices)
    return Problem{
        Code("E4012"),
        fmt::format("meshes[{}] has {} vertices with indices of 2 bytes, expected at most {}", i,
                    mesh.vertex_count, layout::kMaxShortVertices)};
  for (int k = 0; k < 3; ++k)
    if (mesh.bounds_min[k] > mesh.bounds_max[k])
      return Problem{Code("E4012"),
                     fmt::format("meshes[{}].bounds_min[{}] is {}, above bounds_max, {}", i, k,
                                 mesh.bounds_min[k], mesh.bounds_max[k])};
  return {};
}

std::optional<Problem> mesh_problem(const Model& model) {
  std::uint64_t vertices = 0, texcoords = 0, colors = 0, bytes = 0;
  const auto meshes = model.meshes();
  const bool whole = !(model.header().required_features & layout::kFeatureLongRuns);
  const auto stored = [&](std::uint64_t place) { return whole ? place : place & 0xffffffffu; };
  const auto misplaced = [](std::size_t i, const char* field, std::uint64_t is,
                            std::uint64_t must) {
    return Problem{Code("E4010"),
                   fmt::format("meshes[{}].{} is {}, expected {}, where the run before it ends", i,
                               field, is, must)};
  };
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const layout::Mesh& mesh = meshes[i];
    if (auto problem = mesh_form_problem(mesh, i)) return problem;
    const bool has_texcoords = mesh.flags & layout::kMeshTexcoords;
    const bool has_colors = mesh.flags & layout::kMeshColors;
    const std::uint64_t texcoord = has_texcoords ? texcoords : 0;
    const std::uint64_t color = has_colors ? colors : 0;
    if (mesh.first_vertex != stored(vertices))
      return misplaced(i, "first_vertex", mesh.first_vertex, stored(vertices));
    if (mesh.index_offset != bytes) return misplaced(i, "index_offset", mesh.index_offset, bytes);
    if (mesh.first_texcoord != stored(texcoord))
      return misplaced(i, "first_texcoord", mesh.first_texcoord, stored(texcoord));
    if (mesh.first_color != stored(color))
      return misplaced(i, "first_color", mesh.first_color, stored(color));
    vertices += mesh.vertex_count;
    texcoords += has_texcoords ? mesh.vertex_count : 0;
    colors += has_colors ? mesh.vertex_count : 0;
    // note: counts are below 2^32 and records below 2^58, so no sum overflows before it is compared
    bytes += (std::uint64_t{3} * mesh.triangle_count * mesh.index_size + 3) / 4 * 4;
  }
  const struct {
    SectionKind kind;
    std::uint64_t needed;
  } arrays[] = {{SectionKind::positions, vertices},
                {SectionKind::normals, vertices},
                {SectionKind::texcoords, texcoords},
                {SectionKind::colors, colors},
                {SectionKind::indices, bytes}};
  for (const auto& array : arrays)
    if (count_of(model, array.kind) != array.needed)
      return Problem{
          Code("E4010"),
          fmt::format("section '{}' has {}, but the meshes need {}", info(array.kind).name,
                      counted(count_of(model, array.kind), "element"), array.needed)};
  return {};
}

std::optional<Problem> texture_problem(const Model& model) {
  std::uint64_t bytes = 0;
  const auto textures = model.textures();
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const layout::Texture& texture = textures[i];
    const std::uint64_t needed = std::uint64_t{4} * texture.width * texture.height;
    if (texture.offset != bytes || texture.bytes != needed)
      return Problem{
          Code("E4010"),
          fmt::format("textures[{}] has {} bytes at {}, expected {} x {} texels at {}", i,
                      texture.bytes, texture.offset, texture.width, texture.height, bytes)};
    bytes += needed;
  }
  if (count_of(model, SectionKind::texels) != bytes)
    return Problem{Code("E4010"),
                   fmt::format("section 'texels' has {} bytes, but the textures need {}",
                               count_of(model, SectionKind::texels), bytes)};
  return {};
}

// ---- the rest

bool has_maps(const layout::Material& material) {
  return material.albedo_map >= 0 || material.normal_map >= 0 || material.roughness_map >= 0 ||
         material.reflectance_map >= 0 || material.cutout_map >= 0;
}

std::optional<Problem> back_problem(const Model& model, std::size_t index) {
  const layout::Back& back = model.backs()[index];
  const layout::Instance& instance = model.instances()[back.instance];
  const layout::Material& front = model.materials()[instance.material];
  const layout::Material& behind = model.materials()[back.material];
  const bool alike =
      front.cutout_map == behind.cutout_map &&
      (front.cutout_map < 0 || (front.cutout_threshold == behind.cutout_threshold &&
                                std::ranges::equal(front.map_repeat, behind.map_repeat)));
  if (!alike)
    return Problem{Code("E4012"), fmt::format("backs[{}].material has other holes than that of "
                                              "instances[{}]",
                                              index, back.instance)};
  if ((model.meshes()[instance.mesh].flags & layout::kMeshClosed) != 0 && front.cutout_map < 0)
    return Problem{Code("E4012"),
                   fmt::format("backs[{}] is of a closed mesh, whose back is not visible", index)};
  return {};
}

std::optional<Problem> instance_problem(const Model& model) {
  const auto instances = model.instances();
  const auto lacks_texcoords = [&](std::string_view what, std::size_t i, std::uint32_t mesh,
                                   std::uint32_t material_index,
                                   std::int32_t texture) -> std::optional<Problem> {
    if (model.meshes()[mesh].flags & layout::kMeshTexcoords) return {};
    const layout::Material& material = model.materials()[material_index];
    const char* reason = texture >= 0                 ? "texture"
                         : has_maps(material)         ? "material with maps"
                         : material.cell_count[0] > 0 ? "material with cells"
                                                      : nullptr;
    if (!reason) return {};
    return Problem{Code("E4010"), fmt::format("{}[{}] has a {}, but meshes[{}] has no texcoords",
                                              what, i, reason, mesh)};
  };
  for (std::size_t i = 0; i < instances.size(); ++i)
    if (auto problem = lacks_texcoords("instances", i, instances[i].mesh, instances[i].material,
                                       instances[i].texture))
      return problem;
  const auto levels = model.levels();
  for (std::size_t i = 0; i < levels.size(); ++i)
    if (auto problem = lacks_texcoords("levels", i, levels[i].mesh, levels[i].material,
                                       instances[levels[i].instance].texture))
      return problem;
  for (std::size_t i = 0; i < model.backs().size(); ++i) {
    const layout::Back& back = model.backs()[i];
    if (auto problem = back_problem(model, i)) return problem;
    if (auto problem =
            lacks_texcoords("backs", i, instances[back.instance].mesh, back.material, -1))
      return problem;
  }
  const std::uint64_t sources = model.sources().size();
  if (model.entry(SectionKind::sources) && sources != instances.size())
    return Problem{Code("E4010"),
                   fmt::format("section 'sources' has {}, but there are {}",
                               counted(sources, "element"), counted(instances.size(), "instance"))};
  return {};
}

std::optional<Problem> material_problem(const Model& model) {
  const auto materials = model.materials();
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const float* n = materials[i].refract;
    const int zeros = (n[0] == 0) + (n[1] == 0) + (n[2] == 0);
    if (zeros != 0 && zeros != 3)
      return Problem{
          Code("E4012"),
          fmt::format("materials[{}].refract is {} {} {}, expected 0 in all channels or in none", i,
                      n[0], n[1], n[2])};
    if (const auto broken = material_limit_broken(materials[i]))
      return Problem{Code("E4012"), fmt::format("materials[{}]: {}", i, *broken)};
  }
  return {};
}

std::optional<Problem> decal_problem(const Model& model) {
  const auto decals = model.decals();
  for (std::size_t i = 0; i < decals.size(); ++i) {
    const layout::Decal& decal = decals[i];
    if (!(decal.width > 0 && decal.height > 0 && decal.depth > 0))
      return Problem{Code("E4012"),
                     fmt::format("decals[{}] is {} x {} m and {} m deep, expected sizes above 0", i,
                                 decal.width, decal.height, decal.depth)};
  }
  return {};
}

std::optional<Problem> level_problem(const Model& model) {
  const auto levels = model.levels();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const layout::Level& level = levels[i];
    if (!(level.detail > 0))
      return Problem{Code("E4012"),
                     fmt::format("levels[{}].detail is {}, expected more than 0", i, level.detail)};
  }
  for (std::size_t i = 0; i < model.decals().size(); ++i)
    if (std::ranges::binary_search(levels, model.decals()[i].instance, {},
                                   &layout::Level::instance))
      return Problem{Code("E4012"), fmt::format("decals[{}] is on an instance with levels", i)};
  return {};
}

std::optional<Problem> build_problem(const Model& model) {
  IdentityHasher hasher;
  const auto inputs = model.inputs();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string_view path = unchecked_string(model, inputs[i].path);
    // note: without a limit, many inputs that share one long path would take quadratic time
    if (path.size() > layout::kMaxPathBytes)
      return Problem{Code("E4012"), fmt::format("inputs[{}].path has {} bytes, expected at most {}",
                                                i, path.size(), layout::kMaxPathBytes)};
    hasher.input({inputs[i].hash[0], inputs[i].hash[1]}, inputs[i].bytes, path);
  }
  const layout::Build& build = model.builds().front();
  const Hash128 id =
      hasher.finish(unchecked_string(model, build.version), unchecked_string(model, build.options));
  if (id != model.build_id())
    return Problem{Code("E4012"),
                   fmt::format("the build identity is {}, but inputs, version and options give {}",
                               model.build_id().hex(), id.hex())};
  return {};
}

// Streams follow one another, and each is long enough for its mesh.
std::optional<Problem> stream_problem(const Model& model) {
  const auto streams = model.mesh_streams();
  if (!model.entry(SectionKind::mesh_streams)) return {};
  if (streams.size() != model.meshes().size())
    return Problem{Code("E4010"),
                   fmt::format("there are {} for {} meshes", counted(streams.size(), "mesh stream"),
                               model.meshes().size())};
  std::uint64_t end = 0;
  const std::uint64_t bytes = count_of(model, SectionKind::stream_bytes);
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const layout::MeshStream& stream = streams[i];
    const layout::Mesh& mesh = model.meshes()[i];
    const std::uint64_t raw =
        streamed_bytes({mesh.vertex_count, mesh.triangle_count, mesh.index_size});
    if (stream.offset != end || stream.length > bytes - end || stream.length % 4 != 0)
      return Problem{
          Code("E4010"),
          fmt::format("mesh_streams[{}] has the bytes {} to {}, expected to begin at {} of {}", i,
                      stream.offset, stream.offset + stream.length, end, bytes)};
    if (raw / layout::kMaxStreamed > stream.length)
      return Problem{Code("E4010"),
                     fmt::format("mesh_streams[{}] has {} bytes, too few for {} of its mesh", i,
                                 stream.length, raw)};
    end += stream.length;
  }
  if (end == bytes) return {};
  return Problem{Code("E4010"), fmt::format("mesh streams end at byte {} of {}", end, bytes)};
}

}  // namespace

Problems table_problems(const Model& model) {
  Problems problems = rule_problems(model);
  const auto add = [&](const std::optional<Problem>& problem) {
    if (problem) problems.push_back(*problem);
  };
  const auto bad_offsets = offsets_problem(model);
  add(bad_offsets);
  if (!bad_offsets) add(text_problem(model));
  add(node_problem(model));
  add(mesh_problem(model));
  add(texture_problem(model));
  add(material_problem(model));
  add(stream_problem(model));
  add(decal_problem(model));
  add(level_problem(model));
  if (problems.empty()) add(joint_problem(model));
  if (!problems.empty()) return problems;
  // these follow references, so they come when all of them hold
  add(instance_problem(model));
  add(world_problem(model));
  add(lamp_problem(model));
  add(build_problem(model));
  return problems;
}

}  // namespace panwright::pan::internal
