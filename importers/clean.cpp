#include "importers/clean.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/mesh/bytes.h"
#include "geometry/tessellate/tessellate.h"
#include "importers/internal/storable.h"

namespace panwright::importers {

namespace {

using geometry::CleanReport;
using geometry::Mesh;
using geometry::MeshShape;
using geometry::SpotKind;

constexpr std::uint32_t kUnused = 0xffffffffu;
// what a spacecraft and its parts measure, metres
constexpr double kSmallest = 0.05;
constexpr double kLargest = 500;
// a model below this is less than a small part of one
constexpr double kLeastWhole = 0.005;
// what a whole spacecraft measures, mostly
constexpr double kLikelySmallest = 0.3;
constexpr double kLikelyLargest = 150;
// relative difference of units that are the same
constexpr double kSameUnit = 1e-9;

struct Unit {
  std::string_view name;
  double metres;
};
constexpr Unit kUnits[] = {{"um", 1e-6}, {"mm", 1e-3},   {"cm", 1e-2},   {"dm", 0.1},   {"m", 1},
                           {"km", 1e3},  {"in", 0.0254}, {"ft", 0.3048}, {"yd", 0.9144}};
// what CAD programs write, the usual first
constexpr std::string_view kUsual[] = {"mm", "cm", "in", "ft", "um", "km"};

std::string path_of(const scene::Scene& scene, std::int32_t node) {
  std::string path;
  for (; node > 0; node = scene.nodes[static_cast<std::size_t>(node)].parent)
    path = scene.nodes[static_cast<std::size_t>(node)].name + (path.empty() ? "" : "/") + path;
  return path.empty() && !scene.nodes.empty() ? scene.nodes[0].name : path;
}

constexpr std::uint64_t CleanReport::*kNumbers[] = {&CleanReport::vertices_before,
                                                    &CleanReport::vertices_after,
                                                    &CleanReport::triangles_before,
                                                    &CleanReport::triangles_after,
                                                    &CleanReport::welded,
                                                    &CleanReport::degenerate,
                                                    &CleanReport::duplicates,
                                                    &CleanReport::flipped,
                                                    &CleanReport::normals_turned,
                                                    &CleanReport::components,
                                                    &CleanReport::closed_components,
                                                    &CleanReport::one_sided,
                                                    &CleanReport::non_manifold_edges,
                                                    &CleanReport::border_edges,
                                                    &CleanReport::boundary_loops,
                                                    &CleanReport::holes,
                                                    &CleanReport::filled,
                                                    &CleanReport::t_junctions};

void add(const CleanReport& from, CleanReport& to) {
  for (const auto number : kNumbers) to.*number += from.*number;
  to.largest_move = std::max(to.largest_move, from.largest_move);
  to.hole_length += from.hole_length;
}

// About a millisecond; smaller meshes are not worth a file.
constexpr std::size_t kLeastKept = 1000;

struct Cleaned {
  Mesh mesh;
  CleanReport report;
};

// Of all that geometry::clean() follows from.
Hash128 key_of(const Mesh& mesh, const geometry::CleanOptions& options) {
  KeyHasher key;
  geometry::add_to_key(mesh, key);
  for (const bool flag :
       {options.weld, options.drop_degenerate, options.drop_duplicates, options.orient,
        options.fill_holes, options.keep_normals, options.reorder, options.examine})
    key.number(flag);
  for (const double length : {options.tolerance, options.crease_angle, options.junction})
    key.real(length);
  key.number(options.max_spots);
  return key.key();
}

void write(const Cleaned& cleaned, ByteWriter& to) {
  geometry::write(cleaned.mesh, to);
  const CleanReport& report = cleaned.report;
  for (const auto number : kNumbers) to.number(report.*number);
  to.real(report.largest_move);
  to.real(report.hole_length);
  to.number(report.spots.size());
  for (const geometry::Spot& spot : report.spots) {
    to.number(static_cast<std::uint64_t>(spot.kind));
    for (const double value : {spot.at.x, spot.at.y, spot.at.z, spot.length}) to.real(value);
    to.number(spot.size);
  }
}

Cleaned read(ByteReader& from) {
  Cleaned out{geometry::read_mesh(from), {}};
  CleanReport& report = out.report;
  for (const auto number : kNumbers) report.*number = from.number();
  report.largest_move = from.real();
  report.hole_length = from.real();
  for (std::uint64_t left = from.number(); left > 0 && from.good(); --left) {
    geometry::Spot& spot = report.spots.emplace_back();
    const std::uint64_t kind = from.number();
    if (kind > static_cast<std::uint64_t>(SpotKind::flipped)) from.fail();
    spot.kind = static_cast<SpotKind>(kind);
    for (double* value : {&spot.at.x, &spot.at.y, &spot.at.z, &spot.length}) *value = from.real();
    spot.size = from.number();
  }
  return out;
}

class SceneCleaner {
 public:
  SceneCleaner(scene::Scene& scene, const geometry::CleanOptions& options, const WorkCache* cache,
               const Job& job)
      : scene_(scene), options_(options), cache_(cache), job_(job) {}

  MeshReport run() {
    const std::vector<Mat4> world = scene::world_from_nodes(scene_);
    list_meshes(world);
    Phase phase(job_, "cleaning", out_.meshes.size());
    const auto clean_one = [&](std::size_t i) {
      geometry::Shape& shape = scene_.shapes[out_.meshes[i].shape];
      Mesh mesh = *std::get<MeshShape>(shape);
      std::get<MeshShape>(shape).reset();  // cleaning needs the room
      geometry::CleanOptions options = options_;
      // what is small in the world is small in each place of the mesh
      const double stretch = stretch_[out_.meshes[i].shape];
      if (stretch > 0) options.tolerance /= stretch;
      if (stretch > 0) options.junction /= stretch;
      // which side is which is already reported
      if (sided_[out_.meshes[i].shape]) options.orient = false;
      CleanReport& report = out_.meshes[i].report;
      report = clean(mesh, options);
      report.largest_move *= stretch;
      report.hole_length *= stretch;
      shape = std::make_shared<const Mesh>(std::move(mesh));
      phase.advance();
    };
    parallel_for(out_.meshes.size(), clean_one, job_);
    for (std::uint32_t i = 0; i < out_.meshes.size(); ++i) collect(i, world);
    std::stable_sort(out_.spots.begin(), out_.spots.end(),
                     [](const WorldSpot& a, const WorldSpot& b) {
                       return a.kind != b.kind ? a.kind < b.kind : a.length > b.length;
                     });
    drop_empty();
    return std::move(out_);
  }

 private:
  CleanReport clean(Mesh& mesh, const geometry::CleanOptions& options) const {
    if (cache_ == nullptr || mesh.triangles.size() < kLeastKept)
      return geometry::clean(mesh, options, job_);
    auto cleaned = *remember<Cleaned>(
        cache_, Work::cleaned, [&] { return key_of(mesh, options); },
        [&] {
          CleanReport report = geometry::clean(mesh, options, job_);
          return std::optional(Cleaned{std::move(mesh), std::move(report)});
        },
        write, read);
    mesh = std::move(cleaned.mesh);
    return std::move(cleaned.report);
  }

  void list_meshes(const std::vector<Mat4>& world) {
    std::vector<std::uint32_t> at(scene_.shapes.size(), kUnused);
    stretch_.assign(scene_.shapes.size(), 0);
    sided_.assign(scene_.shapes.size(), 0);
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const auto shape = static_cast<std::uint32_t>(scene_.instances[i].shape);
      if (!std::holds_alternative<MeshShape>(scene_.shapes[shape])) continue;
      if (at[shape] == kUnused) {
        at[shape] = static_cast<std::uint32_t>(out_.meshes.size());
        out_.meshes.push_back({shape, i, 0, path_of(scene_, scene_.instances[i].node), {}});
      }
      ++out_.meshes[at[shape]].instances;
      if (scene_.instances[i].back != scene::kNone) sided_[shape] = 1;
      const Mat4& matrix = world[static_cast<std::size_t>(scene_.instances[i].node)];
      stretch_[shape] = std::max(stretch_[shape], stretch_of(matrix).largest);
    }
    std::sort(out_.meshes.begin(), out_.meshes.end(),
              [](const MeshQuality& a, const MeshQuality& b) { return a.shape < b.shape; });
  }

  void collect(std::uint32_t i, const std::vector<Mat4>& world) {
    const MeshQuality& mesh = out_.meshes[i];
    add(mesh.report, out_.total);
    const auto node = static_cast<std::size_t>(scene_.instances[mesh.instance].node);
    const double stretch = stretch_of(world[node]).largest;
    for (const geometry::Spot& spot : mesh.report.spots)
      out_.spots.push_back(
          {spot.kind, Vec3(world[node] * Vec4(spot.at, 1)), spot.length * stretch, spot.size, i});
  }

  // Instances of meshes that have no triangles left go, with the decals on them.
  void drop_empty() {
    const auto moved = remove_instances(scene_, [&](const scene::Instance& instance) {
      const auto& shape = scene_.shapes[static_cast<std::size_t>(instance.shape)];
      const auto* mesh = std::get_if<MeshShape>(&shape);
      return mesh && (*mesh)->triangles.empty();
    });
    for (MeshQuality& mesh : out_.meshes)
      mesh.instance = static_cast<std::uint32_t>(std::max(0, moved[mesh.instance]));
  }

  scene::Scene& scene_;
  const geometry::CleanOptions& options_;
  const WorkCache* cache_;
  const Job& job_;
  std::vector<char> sided_;      // of shapes: another material is on the back
  std::vector<double> stretch_;  // of shapes into the world: the largest of their instances
  MeshReport out_;
};

// Where there is most of something, for a hint.
std::string worst(const MeshReport& mesh_report, std::uint64_t CleanReport::*member) {
  const MeshQuality* most = nullptr;
  for (const MeshQuality& mesh : mesh_report.meshes)
    if (!most || mesh.report.*member > most->report.*member) most = &mesh;
  return most ? fmt::format("most of them, {}, in {}", most->report.*member, in_quotes(most->path))
              : std::string();
}

std::string plural(std::uint64_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void report_meshes(const MeshReport& mesh_report, DiagnosticLog& log) {
  const CleanReport& total = mesh_report.total;
  std::string done;
  const auto tell = [&](std::uint64_t count, const char* one, const char* many) {
    if (count > 0) done += (done.empty() ? "" : ", ") + plural(count, one, many);
  };
  tell(total.welded, "vertex welded", "vertices welded");
  tell(total.degenerate, "triangle without area dropped", "triangles without area dropped");
  tell(total.duplicates, "duplicate triangle dropped", "duplicate triangles dropped");
  tell(total.flipped, "triangle turned to face outwards", "triangles turned to face outwards");
  tell(total.normals_turned, "triangle's normals turned to its outside",
       "triangles' normals turned to their outside");
  tell(total.filled, "hole filled", "holes filled");
  if (!done.empty()) log.report_file(Code("N6301"), {}, done);
  if (total.non_manifold_edges > 0)
    log.report_file(
        Code("W6302"), {},
        fmt::format("{} by more than two triangles",
                    plural(total.non_manifold_edges, "edge is shared", "edges are shared")),
        worst(mesh_report, &CleanReport::non_manifold_edges));
  if (total.holes > total.filled)
    log.report_file(
        Code("W6303"), {},
        fmt::format("{}, with boundary loops of {:.4g} m in all",
                    plural(total.holes - total.filled, "hole", "holes"), total.hole_length),
        worst(mesh_report, &CleanReport::holes));
  if (total.t_junctions > 0)
    log.report_file(
        Code("W6305"), {},
        fmt::format("{} of other triangles",
                    plural(total.t_junctions, "vertex lies on the edge", "vertices lie on edges")),
        worst(mesh_report, &CleanReport::t_junctions));
}

// An exact shape as it roughly is.
std::optional<Mesh> rough(const geometry::Shape& shape) {
  DiagnosticLog ignored;
  geometry::TessellationOptions options;
  options.max_error = 1e30;
  auto coarse = geometry::tessellated(shape, options, {}, ignored);
  if (!coarse || coarse->positions.empty()) return std::nullopt;
  AxisBox box;
  for (const Vec3& p : coarse->positions) box.add(p);
  options.max_error = 0.001 * box.diagonal();
  if (!(options.max_error > 0) || geometry::planned_triangles(shape, options) > 1e6)
    return std::move(*coarse);
  auto fine = geometry::tessellated(shape, options, {}, ignored);
  return fine ? std::move(*fine) : std::move(*coarse);
}

// A node between the root and all else.
void insert_model_node(scene::Scene& scene, const scene::Transform& transform) {
  scene::Node model;
  model.name = "model";
  model.parent = 0;
  model.parent_from_node = transform;
  model.source = scene.nodes[0].source;
  for (scene::Node& node : scene.nodes)
    if (node.parent >= 0) ++node.parent;
  scene.nodes.insert(scene.nodes.begin() + 1, std::move(model));
  // what stood at the root, too
  for (scene::Instance& one : scene.instances) ++one.node;
  for (scene::Frame& one : scene.frames) ++one.node;
  for (scene::Keypoint& one : scene.keypoints) ++one.node;
  for (scene::Lamp& one : scene.lamps) ++one.node;
  for (scene::Joint& one : scene.joints) ++one.node;
}

}  // namespace

Result<MeshReport> clean_up(scene::Scene& scene, const geometry::CleanOptions& options,
                            DiagnosticLog& log, const Job& job, const WorkCache* cache) {
  return run_job(job, log, [&]() -> Result<MeshReport> {
    MeshReport mesh_report = SceneCleaner(scene, options, cache, job).run();
    report_meshes(mesh_report, log);
    return mesh_report;
  });
}

std::vector<AxisBox> instance_bounds(const scene::Scene& scene) {
  std::vector<MeshShape> meshes(scene.shapes.size());
  parallel_for(meshes.size(), [&](std::size_t i) {
    if (const auto* mesh = std::get_if<MeshShape>(&scene.shapes[i]))
      meshes[i] = *mesh;
    else if (auto made = rough(scene.shapes[i]))
      meshes[i] = std::make_shared<const Mesh>(std::move(*made));
  });
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  std::vector<AxisBox> out;
  for (const scene::Instance& instance : scene.instances) {
    AxisBox& bounds = out.emplace_back();
    const MeshShape& mesh = meshes[static_cast<std::size_t>(instance.shape)];
    if (!mesh) continue;
    const Mat4& matrix = world[static_cast<std::size_t>(instance.node)];
    std::vector<char> used(mesh->positions.size(), 0);
    for (const geometry::Triangle& t : mesh->triangles)
      for (const std::uint32_t v : t) used[v] = 1;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      const Vec3 p(matrix * Vec4(mesh->positions[v], 1));
      if (is_finite(p)) bounds.add(p);
    }
  }
  return out;
}

AxisBox bounds_of(const scene::Scene& scene) {
  AxisBox bounds;
  for (const AxisBox& box : instance_bounds(scene)) bounds.add(box);
  return bounds;
}

std::optional<double> unit_of(std::string_view name) {
  for (const Unit& unit : kUnits)
    if (unit.name == name) return unit.metres;
  return std::nullopt;
}

std::optional<UpAxis> up_of(std::string_view name) {
  if (name == "y") return UpAxis::y;
  if (name == "z") return UpAxis::z;
  return std::nullopt;
}

UnitGuess guessed_unit(double largest_extent) {
  UnitGuess guess;
  // small things are parts of something
  if (largest_extent <= kLargest) return guess;
  const std::array<std::pair<double, double>, 2> ranges = {
      std::pair{kLikelySmallest, kLikelyLargest}, std::pair{kSmallest, kLargest}};
  for (const auto& [low, high] : ranges) {
    for (const std::string_view name : kUsual) {
      const double unit = *unit_of(name);
      const double size = largest_extent * unit;
      if (unit < 1 && size >= low && size <= high) return {unit, name, true};
    }
  }
  guess.plausible = false;
  return guess;
}

namespace {

bool is_unitless(Format format) {
  return format == Format::obj || format == Format::stl || format == Format::ply;
}

// Says what was taken for the unit of a file that does not say it, and what else it may be.
void warn_of_unit(const Imported& model, double size, const UnitGuess& guess, DiagnosticLog& log) {
  if (!(size > 0)) return;
  const bool unitless = is_unitless(model.format);
  const std::string file = model.scene.inputs.empty() ? "" : model.scene.inputs.front().path;
  const std::string of_format =
      unitless ? "the format has no unit" : "the unit of the format is the metre";
  if (!guess.plausible)
    log.report_file(Code("W6006"), file,
                    fmt::format("{}; the model is {:.4g} m large then, implausible for a "
                                "spacecraft in any unit: it is kept in metres",
                                unitless ? of_format + ", metres are assumed" : of_format, size),
                    "--units gives its unit");
  else if (guess.unit != 1)
    log.report_file(
        Code("W6006"), file,
        fmt::format("{}, but in metres the model would be {:.4g} m large: {} are assumed, {:.4g} m",
                    of_format, size, guess.name, size * guess.unit),
        fmt::format("--units m keeps {:.4g} m, --units {} says that {:.4g} m is right", size,
                    guess.name, size * guess.unit));
  else if (unitless || size < kLeastWhole)
    log.report_file(
        Code("W6006"), file,
        fmt::format("{}: the model is {:.4g} m large{}", of_format, size,
                    unitless ? fmt::format(" if that is metres, as is assumed, {:.4g} m if it is "
                                           "millimetres",
                                           1e-3 * size)
                             : std::string(", little for a spacecraft")),
        "--units m or --units mm says which");
}

// Name of a unit; a length of a number otherwise.
std::string unit_name(double metres) {
  for (const Unit& unit : kUnits)
    if (std::fabs(unit.metres / metres - 1) < kSameUnit) return std::string(unit.name);
  return fmt::format("{:.6g} m", metres);
}

// A file that states its unit, or should; lengths of the scene are metres.
double scale_of_stated(Imported& model, std::optional<double> unit, double size,
                       DiagnosticLog& log) {
  const std::string file = model.scene.inputs.empty() ? "" : model.scene.inputs.front().path;
  if (!unit) {
    if (!model.lacks_unit) return 1;
    model.assumed_unit = unit_name(model.file_unit);
    if (size > 0)
      log.report_file(Code("W6006"), file,
                      fmt::format("the file states no unit: the model is {:.4g} m large if it is "
                                  "{}, as is assumed, {:.4g} m if it is m",
                                  size, model.assumed_unit, size / model.file_unit),
                      "--units says which");
    return 1;
  }
  if (model.file_unit == 0) {
    log.report_file(
        Code("W6013"), file,
        fmt::format("the file states several units, and {} is not used", unit_name(*unit)));
    return 1;
  }
  const double scale = *unit / model.file_unit;
  if (std::fabs(scale - 1) < kSameUnit) return 1;
  if (!model.lacks_unit)
    log.report_file(
        Code("W6013"), file,
        fmt::format("the unit of the file is {}, and {} is used instead: the model is {:.4g} m "
                    "large, not {:.4g} m",
                    unit_name(model.file_unit), unit_name(*unit), size * scale, size));
  return scale;
}

// Metres of a length of the scene.
double scale_of(Imported& model, std::optional<double> unit, double size, DiagnosticLog& log) {
  if (model.in_metres) return scale_of_stated(model, unit, size, log);
  const UnitGuess guess = guessed_unit(size);
  if (!unit) {
    warn_of_unit(model, size, guess, log);
    if (is_unitless(model.format) || guess.unit != 1) model.assumed_unit = guess.name;
    return guess.unit;
  }
  // where metres are implausible, the file breaks the rule of its format
  const bool plausible = guess.plausible && guess.unit == 1 && size >= kLeastWhole;
  if (!is_unitless(model.format) && *unit != 1 && plausible)
    log.report_file(Code("W6013"),
                    model.scene.inputs.empty() ? "" : model.scene.inputs.front().path,
                    fmt::format("the unit of the format is the metre, and {} is used instead: the "
                                "model is {:.4g} m large, not {:.4g} m",
                                unit_name(*unit), size * *unit, size));
  return *unit;
}

}  // namespace

Vec3 place(Imported& model, std::optional<double> unit, std::optional<UpAxis> up, bool recentre,
           DiagnosticLog& log) {
  scene::Scene& scene = model.scene;
  if (scene.nodes.empty()) return Vec3(0);
  const bool contradicted = unit && *unit != (model.in_metres ? model.file_unit : 1.0);
  AxisBox bounds;
  if (recentre || contradicted || model.lacks_unit || !(unit || model.in_metres))
    bounds = bounds_of(scene);
  scene::Transform transform;
  transform.scale = Vec3(scale_of(model, unit, bounds.longest(), log));
  // quarter turns about x
  const bool y_up = up.value_or(usual_up(model.format)) == UpAxis::y;
  if (y_up && !model.z_up) transform.rotation = Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0);
  if (!y_up && model.z_up) transform.rotation = Quat(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);
  Vec3 moved(0);
  if (recentre && !bounds.empty()) {
    moved = Vec3(0) - Vec3(transform.matrix() * Vec4(bounds.centre(), 1));
    transform.translation = moved;
  }
  if (transform != scene::Transform{}) insert_model_node(scene, transform);
  return moved;
}

}  // namespace panwright::importers
