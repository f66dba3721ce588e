#include "compiler/internal/fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <map>
#include <variant>

#include "base/axis_box.h"
#include "base/clock.h"
#include "base/text.h"
#include "compiler/internal/approach.h"
#include "compiler/internal/scene_edit.h"
#include "compiler/internal/shared_borders.h"
#include "compiler/internal/surfaces.h"

namespace panwright::compiler {

bool asks_to_fit(const scene::Budget& budget) {
  return budget.nearest && budget.ifov && (budget.pixels || budget.flux || budget.centroid);
}

namespace internal {
namespace {

using geometry::Mesh;
using geometry::MeshShape;

// One that can be left out.
struct Candidate {
  std::size_t shape = 0;
  std::size_t instance = 0;     // the one that goes, of a shape of one piece
  std::uint32_t piece = 0;      // of the shape
  bool whole = true;            // an instance, else a piece of all of them
  std::uint64_t pieces = 0;     // instances counted
  std::uint64_t triangles = 0;  // instances counted
  double area = 0;              // m²: the largest that it shows, instances summed
  double weight = 0;            // m²: area times what light it may change
  double moment = 0;            // m³: weight times distance from the middle
};

// The pieces of a mesh that hang together by position.
struct Pieces {
  std::vector<std::uint32_t> of_triangle;
  std::vector<AxisBox> extents;
  std::vector<double> areas;  // m²
  std::vector<std::uint64_t> triangles;
};

Pieces pieces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> root = first_at_place(surface_of(mesh));
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t k = 1; k < 3; ++k) {
      const std::uint32_t a = find(t[0]), b = find(t[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  Pieces out;
  std::vector<std::uint32_t> number(root.size(), 0xffffffffu);
  for (const geometry::Triangle& t : mesh.triangles) {
    std::uint32_t& piece = number[find(t[0])];
    if (piece == 0xffffffffu) {
      piece = static_cast<std::uint32_t>(out.extents.size());
      out.extents.emplace_back();
      out.areas.push_back(0);
      out.triangles.push_back(0);
    }
    out.of_triangle.push_back(piece);
    for (const std::uint32_t v : t) out.extents[piece].add(mesh.positions[v]);
    const Vec3& a = mesh.positions[t[0]];
    out.areas[piece] +=
        glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) / 2;
    ++out.triangles[piece];
  }
  return out;
}

class Allotter {
 public:
  Allotter(scene::Scene& scene, Allotment& allotment, FitReport& report, const Job& job)
      : scene_(scene), allotment_(allotment), report_(report), job_(job) {}

  void run() {
    world_of_nodes_ = scene::world_from_nodes(scene_);
    surfaces_ = coarse_surfaces(scene_, job_);
    reflectance_ = reflectances(scene_, job_);
    std::vector<MeshShape> shown;
    std::vector<Mat4> world;
    for (const scene::Instance& instance : scene_.instances) {
      shown.push_back(surfaces_[static_cast<std::size_t>(instance.shape)]);
      world.push_back(world_of(instance));
    }
    shown_ = shown_area(shown, world, reflectance_, job_);
    const double enough = std::max(shown_.least, kLeastShown * shown_.largest);
    if (!(enough > 0)) return;
    find_candidates(enough);
    if (scene_.budget.flux) {
      choose(enough);
      apply();
    }
    allotment_.share = shares_of(scene_, weights_);
    allotment_.weight = std::move(weights_);
  }

 private:
  const Mat4& world_of(const scene::Instance& instance) const {
    return world_of_nodes_[static_cast<std::size_t>(instance.node)];
  }

  std::vector<char> fixed_instances() const {
    std::vector<char> stays(scene_.instances.size());
    for (const scene::Decal& decal : scene_.decals)
      stays[static_cast<std::size_t>(decal.instance)] = 1;
    std::vector<char> foil(scene_.shapes.size());
    for (const scene::Foil& sheet : scene_.foils) foil[static_cast<std::size_t>(sheet.shape)] = 1;
    for (std::size_t i = 0; i < stays.size(); ++i) {
      const scene::Instance& instance = scene_.instances[i];
      const auto shape = static_cast<std::size_t>(instance.shape);
      const auto sends_back = [&](std::int32_t index) {
        return index != scene::kNone &&
               std::holds_alternative<materials::Retroreflector>(
                   scene_.materials[static_cast<std::size_t>(index)].specular_brdf);
      };
      if (foil[shape] || !surfaces_[shape] || instance.tolerance || sends_back(instance.material) ||
          sends_back(instance.back))
        stays[i] = 1;
    }
    return stays;
  }

  void find_candidates(double enough) {
    const std::vector<char> stays = fixed_instances();
    std::vector<std::vector<std::size_t>> users(scene_.shapes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i)
      users[static_cast<std::size_t>(scene_.instances[i].shape)].push_back(i);
    pieces_.resize(scene_.shapes.size());
    weights_.resize(scene_.instances.size());
    for (std::size_t s = 0; s < users.size(); ++s) {
      if (users[s].empty() || !surfaces_[s] || surfaces_[s]->triangles.empty()) continue;
      job_.poll();
      Pieces& pieces = pieces_[s];
      pieces = pieces_of(*surfaces_[s]);
      for (const std::size_t i : users[s]) weights_[i] = weight_of(i, pieces, enough);
      const bool mesh = std::holds_alternative<MeshShape>(scene_.shapes[s]);
      const std::size_t count = mesh ? pieces.extents.size() : 1;
      report_.pieces += count * users[s].size();
      if (!mesh) join(pieces);
      for (std::uint32_t p = 0; p < count; ++p) {
        if (count == 1) {
          for (const std::size_t i : users[s]) add(s, p, {&i, 1}, true, stays);
        } else {
          add(s, p, users[s], false, stays);
        }
      }
    }
  }

  // The share of what the model sends that an instance sends. Where the images may have missed it,
  // what it can send at the most, or a pixel's.
  double weight_of(std::size_t instance, const Pieces& pieces, double enough) const {
    const Mat4& world = world_of(scene_.instances[instance]);
    const double stretch = stretch_of(world).largest;
    AxisBox extent;
    double area = 0;
    for (std::size_t p = 0; p < pieces.extents.size(); ++p) {
      extent.add(pieces.extents[p]);
      area += pieces.areas[p] * stretch * stretch;
    }
    const double least = std::min({placed(extent, world).largest_projection(), area, shown_.pixel});
    return std::max(shown_.shares[instance], least * reflectance_[instance] / enough);
  }

  // An exact shape is one piece, whatever it is made of.
  static void join(Pieces& pieces) {
    for (std::size_t p = 1; p < pieces.extents.size(); ++p) {
      pieces.extents[0].add(pieces.extents[p]);
      pieces.areas[0] += pieces.areas[p];
    }
    pieces.triangles.assign(1, 0);
  }

  void add(std::size_t shape, std::uint32_t piece, std::span<const std::size_t> users, bool whole,
           const std::vector<char>& stays) {
    const Pieces& pieces = pieces_[shape];
    const AxisBox& extent = pieces.extents[piece];
    Candidate candidate{.shape = shape, .instance = users.front(), .piece = piece, .whole = whole};
    candidate.pieces = users.size();
    candidate.triangles = pieces.triangles[piece] * users.size();
    for (const std::size_t i : users) {
      if (stays[i]) return;
      const Mat4& world = world_of(scene_.instances[i]);
      const PlacedBox box = placed(extent, world);
      const Reach reach = reach_of(scene_, world_of_nodes_, i, extent.low, extent.high);
      const scene::Budget budget = allotment_.of(scene_.budget, i);
      if (!reach.bounded || box.width() > budget.pixels.value_or(scene::Budget::kDefaultPixels) *
                                              *budget.ifov * *budget.nearest)
        return;
      const double stretch = stretch_of(world).largest;
      const double sides = surfaces_[shape]->closed ? 0.5 : 1;
      const double area =
          std::min(box.largest_projection(), sides * pieces.areas[piece] * stretch * stretch);
      const double weight = 2 * area * std::max(reflectance_[i], shown_.mean_reflectance);
      candidate.area += area;
      candidate.weight += weight;
      candidate.moment += weight * (glm::length(reach.centre - shown_.middle) + reach.radius);
    }
    if (std::isfinite(candidate.moment)) candidates_.push_back(candidate);
  }

  void choose(double enough) {
    const scene::Budget& budget = scene_.budget;
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.weight < b.weight; });
    const double most_flux = kLeftOutShare * *budget.flux;
    const double most_shift =
        budget.centroid ? kLeftOutShare * *budget.centroid * *budget.ifov * *budget.nearest
                        : HUGE_VAL;
    double weight = 0, moment = 0;
    for (const Candidate& candidate : candidates_) {
      if (!(weight + candidate.weight <= most_flux * enough)) break;
      weight += candidate.weight;
      if (!(moment + candidate.moment <= most_shift * enough)) {
        weight -= candidate.weight;
        continue;  // one that is nearer to the middle may do
      }
      moment += candidate.moment;
      chosen_.push_back(&candidate);
    }
    report_.flux_left_out = weight / enough;
    report_.centroid_left_out = moment / enough;
  }

  void apply() {
    std::vector<char> keep(scene_.instances.size(), 1);
    std::vector<std::vector<char>> left(scene_.shapes.size());  // pieces that stay
    std::map<std::string, LeftOut> names;
    for (const Candidate* candidate : chosen_) {
      const std::string name = name_of(scene_, candidate->instance);
      LeftOut& entry = names[name];
      entry.name = name;
      entry.pieces += candidate->pieces;
      entry.triangles += candidate->triangles;
      entry.area += candidate->area;
      report_.pieces_left_out += candidate->pieces;
      report_.triangles_left_out += candidate->triangles;
      if (candidate->whole) {
        keep[candidate->instance] = 0;
        continue;
      }
      std::vector<char>& pieces = left[candidate->shape];
      pieces.resize(pieces_[candidate->shape].extents.size(), 1);
      pieces[candidate->piece] = 0;
    }
    for (auto& [name, entry] : names) report_.left_out.push_back(std::move(entry));
    std::stable_sort(report_.left_out.begin(), report_.left_out.end(),
                     [](const LeftOut& a, const LeftOut& b) { return a.area > b.area; });
    for (std::size_t s = 0; s < left.size(); ++s)
      if (!left[s].empty()) cut(s, left[s], keep);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (!keep[i]) continue;
      if (!allotment_.nearest.empty()) allotment_.nearest[kept] = allotment_.nearest[i];
      weights_[kept++] = weights_[i];
    }
    weights_.resize(kept);
    if (!allotment_.nearest.empty()) allotment_.nearest.resize(kept);
    keep_instances(scene_, keep);
  }

  void cut(std::size_t shape, const std::vector<char>& pieces, std::vector<char>& keep) {
    const Mesh& mesh = *std::get<MeshShape>(scene_.shapes[shape]);
    std::vector<char> triangles(mesh.triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
      triangles[t] = pieces[pieces_[shape].of_triangle[t]];
    if (std::find(triangles.begin(), triangles.end(), 1) != triangles.end()) {
      scene_.shapes[shape] = some_triangles(mesh, triangles);
      return;
    }
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (static_cast<std::size_t>(scene_.instances[i].shape) == shape) keep[i] = 0;
  }

  scene::Scene& scene_;
  Allotment& allotment_;
  FitReport& report_;
  const Job& job_;
  std::vector<Mat4> world_of_nodes_;
  std::vector<MeshShape> surfaces_;  // of shapes
  std::vector<double> reflectance_;  // of instances
  ShownArea shown_;
  std::vector<Pieces> pieces_;   // of shapes
  std::vector<double> weights_;  // of instances: shares of what the model sends
  std::vector<Candidate> candidates_;
  std::vector<const Candidate*> chosen_;
};

std::string words(const FitReport& report, const scene::Budget& budget) {
  std::vector<std::string> said;
  if (report.pieces_left_out > 0) {
    std::string text =
        fmt::format("left out {} of {}, at most {:.2g} % of the flux", report.pieces_left_out,
                    counted(report.pieces, "part"), 100 * report.flux_left_out);
    if (budget.centroid)
      text += fmt::format(" and {:.2g} px of the photocentre",
                          report.centroid_left_out / (*budget.ifov * *budget.nearest));
    said.push_back(text +
                   fmt::format("; the largest is of {}", in_quotes(report.left_out.front().name)));
  }
  if (!report.simplified.empty()) {
    std::uint64_t before = 0, after = 0;
    for (const Simplified& mesh : report.simplified) {
      before += mesh.before;
      after += mesh.after;
    }
    said.push_back(fmt::format("{} simplified from {} to {} triangles",
                               report.simplified.size() == 1
                                   ? "1 mesh"
                                   : fmt::format("{} meshes", report.simplified.size()),
                               before, after));
  }
  if (report.texels_after < report.texels_before)
    said.push_back(fmt::format("textures of {:.3g} MB reduced to {:.3g} MB",
                               static_cast<double>(report.texels_before) / 1e6,
                               static_cast<double>(report.texels_after) / 1e6));
  std::string out;
  for (const std::string& each : said) out += (out.empty() ? "" : "; ") + each;
  return out;
}

}  // namespace

std::string name_of(const scene::Scene& scene, std::size_t instance) {
  for (std::int32_t n = scene.instances[instance].node; n != scene::kNone;
       n = scene.nodes[static_cast<std::size_t>(n)].parent)
    if (n > 0 && !scene.nodes[static_cast<std::size_t>(n)].name.empty())
      return scene.nodes[static_cast<std::size_t>(n)].name;
  return "the model";
}

scene::Budget Allotment::of(const scene::Budget& budget, std::size_t instance) const {
  scene::Budget out = budget;
  if (!nearest.empty()) out.nearest = nearest[instance];
  if (share.empty()) return out;
  if (out.flux) out.flux = std::min(*out.flux * share[instance], 1.0);
  if (out.centroid) *out.centroid *= share[instance];
  return out;
}

void allot(scene::Scene& scene, Allotment& allotment, FitReport& report, const Job& job) {
  if (scene.budget.flux || scene.budget.centroid) Allotter(scene, allotment, report, job).run();
}

Fitted fitted_to_budget(const scene::Scene& scene, const std::optional<double>& max_error,
                        const WorkCache* cache, DiagnosticLog& log, const Job& job) {
  Fitted out;
  out.authored = &scene;
  const scene::Budget& budget = scene.budget;
  if (budget.nearest && !budget.approach.empty())
    out.allotment.nearest =
        nearest_distances(scene, scene::world_from_nodes(scene), coarse_surfaces(scene, job));
  if (!asks_to_fit(budget) || max_error) return out;
  const auto start = std::chrono::steady_clock::now();
  out.report.asked = true;
  scene::Scene& fitted = out.changed.emplace(scene);
  allot(fitted, out.allotment, out.report, job);
  out.made_to = simplify_meshes(fitted, out.allotment, cache, out.report, job);
  reduce_textures(fitted, out.allotment, out.report, job);
  out.report.seconds = seconds_since(start);
  if (const std::string text = words(out.report, budget); !text.empty())
    log.report(Code("N2025"), {}, text, "`--budget none` keeps all of it");
  return out;
}

}  // namespace internal
}  // namespace panwright::compiler
