#include "compiler/internal/mesh_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "compiler/internal/shared_borders.h"
#include "geometry/mesh/bytes.h"
#include "geometry/mesh/levels.h"

namespace panwright::compiler::internal {
namespace {

constexpr std::size_t kLeastLevelTriangles = 512;

// Levels change where they leave at most this share of the triangles of the whole model: frames in
// between are drawn with both.
constexpr double kWorth = 0.7;

Vec3 position(const pan::PackedMesh& mesh, std::size_t vertex) {
  const float* p = &mesh.positions[3 * vertex];
  return Vec3(p[0], p[1], p[2]);
}

// As the file has it, relative to its origin: what is made of it rounds to nothing else.
geometry::Mesh unpacked(const pan::PackedMesh& packed) {
  geometry::Mesh mesh;
  mesh.closed = packed.closed;
  for (std::size_t v = 0; v < packed.vertex_count(); ++v) {
    mesh.positions.push_back(position(packed, v));
    const float* n = &packed.normals[3 * v];
    mesh.normals.emplace_back(n[0], n[1], n[2]);
    if (!packed.texcoords.empty())
      mesh.texcoords.emplace_back(packed.texcoords[2 * v], packed.texcoords[2 * v + 1]);
    if (!packed.colors.empty())
      mesh.colors.emplace_back(packed.colors[3 * v], packed.colors[3 * v + 1],
                               packed.colors[3 * v + 2]);
  }
  for (std::size_t i = 0; i < packed.indices.size(); i += 3)
    mesh.triangles.push_back({packed.indices[i], packed.indices[i + 1], packed.indices[i + 2]});
  return mesh;
}

// Numbers that came from floats, back.
pan::PackedMesh packed_level(const pan::PackedMesh& full, const geometry::Mesh& mesh,
                             std::size_t level) {
  pan::PackedMesh out;
  out.name = fmt::format("{} level {}", full.name, level + 1);
  out.origin = full.origin;
  out.error = full.error + mesh.error;
  out.closed = full.closed && mesh.closed;
  const auto add = [](std::vector<float>& to, const auto& from) {
    for (const auto& v : from)
      for (int k = 0; k < v.length(); ++k) to.push_back(static_cast<float>(v[k]));
  };
  add(out.positions, mesh.positions);
  add(out.normals, mesh.normals);
  add(out.texcoords, mesh.texcoords);
  add(out.colors, mesh.colors);
  for (const geometry::Triangle& t : mesh.triangles)
    out.indices.insert(out.indices.end(), t.begin(), t.end());
  return out;
}

// Of all that geometry::mesh_levels() follows from, as it is called here.
Hash128 levels_key(const geometry::Mesh& mesh, const geometry::LevelOptions& options) {
  KeyHasher key;
  geometry::add_to_key(mesh, key);
  key.real(options.unit);
  key.real(options.least_error);
  key.list(options.shared);
  return key.key();
}

void write_levels(const std::vector<geometry::MeshLevel>& levels, ByteWriter& to) {
  to.number(levels.size());
  for (const geometry::MeshLevel& level : levels) {
    geometry::write(level.mesh, to);
    to.real(level.distance.low);
    to.real(level.distance.high);
  }
}

// What is used of them here.
std::vector<geometry::MeshLevel> read_levels(ByteReader& from) {
  std::vector<geometry::MeshLevel> out;
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    geometry::MeshLevel& level = out.emplace_back();
    level.mesh = geometry::read_mesh(from);
    level.distance.low = from.real();
    level.distance.high = from.real();
    if (level.mesh.triangles.empty() || level.mesh.normals.empty()) from.fail();
  }
  return out;
}

class MeshLevels {
 public:
  MeshLevels(const scene::Scene& scene, const WorkCache* cache, pan::Contents& out, const Job& job)
      : cache_(cache),
        budget_(scene.budget),
        pixels_(scene.budget.pixels.value_or(scene::Budget::kDefaultPixels)),
        out_(out),
        job_(job) {
    const std::vector<Mat4> nodes = scene::world_from_nodes(scene);
    for (const pan::InstanceContent& instance : out.instances)
      world_.push_back(nodes[instance.node]);
  }

  void add() {
    choose();
    if (chosen_.empty()) return;
    find_shared();
    Phase phase(job_, "simplifying", chosen_.size());
    std::vector<std::vector<geometry::MeshLevel>> levels(chosen_.size());
    parallel_for(
        chosen_.size(),
        [&](std::size_t i) {
          levels[i] = made(chosen_[i]);
          phase.advance();
        },
        job_);
    for (std::size_t i = 0; i < chosen_.size(); ++i) leave_out_finer(chosen_[i], levels[i]);
    const std::vector<int> changes = worthwhile(levels);
    for (std::size_t i = 0; i < chosen_.size(); ++i) store(chosen_[i], levels[i], changes);
    std::stable_sort(out_.levels.begin(), out_.levels.end(),
                     [](const pan::layout::Level& a, const pan::layout::Level& b) {
                       return a.instance < b.instance;
                     });
  }

 private:
  struct Chosen {
    std::uint32_t mesh = 0;
    std::vector<std::uint32_t> instances;
    std::vector<char> shared;  // V
    double stretch = 1;        // of the first instance: tolerances are powers of two in the world
    double largest = 0;        // of all
  };

  void choose() {
    std::vector<char> unfit(out_.instances.size());
    for (const pan::DecalContent& decal : out_.decals) unfit[decal.instance] = 1;
    for (const pan::layout::Level& level : out_.levels) unfit[level.instance] = 1;
    std::vector<std::size_t> at(out_.meshes.size(), chosen_.max_size());
    for (std::uint32_t i = 0; i < out_.instances.size(); ++i) {
      const std::uint32_t mesh = out_.instances[i].mesh;
      const double stretch = stretch_of(world_[i]).largest;
      if (unfit[i] || out_.meshes[mesh].triangle_count() < kLeastLevelTriangles || !(stretch > 0))
        continue;
      if (at[mesh] == chosen_.max_size()) {
        at[mesh] = chosen_.size();
        chosen_.push_back({mesh, {}, {}, stretch, 0});
      }
      Chosen& chosen = chosen_[at[mesh]];
      chosen.instances.push_back(i);
      chosen.largest = std::max(chosen.largest, stretch);
    }
  }

  void find_shared() {
    std::vector<Surface> meshes;
    for (const pan::PackedMesh& mesh : out_.meshes) meshes.push_back(surface_of(mesh));
    std::vector<PlacedSurface> placed;
    for (std::uint32_t i = 0; i < out_.instances.size(); ++i)
      placed.push_back({out_.instances[i].mesh, i});
    const auto shared = shared_borders(meshes, placed, world_, Compared::borders, job_);
    for (Chosen& chosen : chosen_)
      chosen.shared = shared ? (*shared)[chosen.mesh]
                             : std::vector<char>(out_.meshes[chosen.mesh].vertex_count(), 1);
  }

  // What the nearest pixel of the budget sees of a mesh, in its own coordinates, metres; 0:
  // unknown.
  double nearest_pixel(const Chosen& chosen) const {
    return budget_.nearest && budget_.ifov ? *budget_.nearest * *budget_.ifov / chosen.largest : 0;
  }

  std::vector<geometry::MeshLevel> made(const Chosen& chosen) const {
    geometry::LevelOptions options;
    options.unit = 1 / chosen.stretch;
    options.least_error = pixels_ / 2 * nearest_pixel(chosen);
    options.shared = chosen.shared;
    const geometry::Mesh mesh = unpacked(out_.meshes[chosen.mesh]);
    return *remember<std::vector<geometry::MeshLevel>>(
        cache_, Work::levels, [&] { return levels_key(mesh, options); },
        [&] { return std::optional(geometry::mesh_levels(mesh, options, job_)); }, write_levels,
        read_levels);
  }

  // Those that nothing nearer than the budget's nearest pixel needs.
  void leave_out_finer(const Chosen& chosen, std::vector<geometry::MeshLevel>& levels) const {
    const double pixel = nearest_pixel(chosen);
    std::size_t first = 0;
    while (first + 1 < levels.size() && detail(levels[first + 1]) <= pixel) ++first;
    levels.erase(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(first));
  }

  // The least that a pixel may see of a level, metres of its mesh.
  double detail(const geometry::MeshLevel& level) const { return level.distance.high / pixels_; }

  // Levels change where a pixel sees a power of two metres (preview/frame/level_states.h): the
  // exponent of the first from which an instance shows a level.
  int change_to(const geometry::MeshLevel& level, std::uint32_t instance) const {
    int exponent = 0;
    const double part = std::frexp(detail(level) * stretch_of(world_[instance]).largest, &exponent);
    return part > 0.5 ? exponent : exponent - 1;
  }

  // Which of the levels an instance shows from a change on; as many as there are: none.
  std::size_t shown(const std::vector<geometry::MeshLevel>& levels, std::uint32_t instance,
                    int change) const {
    std::size_t out = levels.size();
    for (std::size_t k = 0; k < levels.size(); ++k)
      if (change_to(levels[k], instance) <= change) out = k;
    return out;
  }

  // The changes that leave few enough triangles of what the one before left, ascending.
  std::vector<int> worthwhile(const std::vector<std::vector<geometry::MeshLevel>>& levels) const {
    double all = 0;
    for (const pan::InstanceContent& instance : out_.instances)
      all += static_cast<double>(out_.meshes[instance.mesh].triangle_count());
    std::map<int, double> left_out;  // triangles that a change takes away
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      for (const std::uint32_t instance : chosen_[i].instances) {
        auto before = static_cast<double>(out_.meshes[chosen_[i].mesh].triangle_count());
        for (const geometry::MeshLevel& level : levels[i]) {
          const auto triangles = static_cast<double>(level.mesh.triangles.size());
          left_out[change_to(level, instance)] += before - triangles;
          before = triangles;
        }
      }
    std::vector<int> out;
    double shown = all;
    for (const auto& [change, fewer] : left_out) {
      all -= fewer;
      if (all > kWorth * shown) continue;
      shown = all;
      out.push_back(change);
    }
    return out;
  }

  void store(const Chosen& chosen, const std::vector<geometry::MeshLevel>& levels,
             const std::vector<int>& changes) {
    std::vector<std::optional<std::uint32_t>> mesh_of(levels.size());
    std::size_t made = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const bool used = std::ranges::any_of(chosen.instances, [&](std::uint32_t instance) {
        return std::ranges::any_of(
            changes, [&](int change) { return shown(levels, instance, change) == k; });
      });
      if (!used) continue;
      mesh_of[k] = static_cast<std::uint32_t>(out_.meshes.size());
      out_.meshes.push_back(packed_level(out_.meshes[chosen.mesh], levels[k].mesh, made++));
      if (!out_.mesh_tolerances.empty())
        out_.mesh_tolerances.push_back(
            {0, static_cast<std::uint32_t>(pan::layout::ToleranceReason::explicit_counts), 0});
    }
    for (const std::uint32_t i : chosen.instances) {
      std::size_t last = levels.size();
      for (const int change : changes) {
        const std::size_t k = shown(levels, i, change);
        if (k == last) continue;
        last = k;
        // one that was put off comes at the change, and not a rounding after it
        const bool late = change_to(levels[k], i) < change;
        const double from = late ? 0.75 * std::ldexp(1.0, change) / stretch_of(world_[i]).largest
                                 : detail(levels[k]);
        out_.levels.push_back(
            {from, levels[k].distance.high, i, *mesh_of[k], out_.instances[i].material, 0});
      }
    }
  }

  const WorkCache* cache_;
  const scene::Budget& budget_;
  const double pixels_;
  pan::Contents& out_;
  const Job& job_;
  std::vector<Mat4> world_;  // of instances
  std::vector<Chosen> chosen_;
};

}  // namespace

void add_mesh_levels(const scene::Scene& scene, const WorkCache* cache, pan::Contents& out,
                     const Job& job) {
  MeshLevels(scene, cache, out, job).add();
}

}  // namespace panwright::compiler::internal
