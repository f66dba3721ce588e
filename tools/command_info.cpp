#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string>
#include <variant>

#include "base/axis_box.h"
#include "base/text.h"
#include "compiler/size.h"
#include "compiler/tolerance.h"
#include "pan/fields.h"
#include "terrain/tiles.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/joint_list.h"
#include "tools/kernel_info.h"
#include "tools/model_json.h"
#include "tools/model_words.h"
#include "tools/node_list.h"
#include "tools/posed_model.h"
#include "tools/print.h"
#include "workspace/open.h"
#include "world/evaluation.h"
#include "world/lamps.h"

namespace panwright::tools {

namespace command_info {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  bool meshes = false;  // all of them
  bool nodes = false;   // those alone
  PoseOptions pose;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.input,
           "Model: a .pan, .pxn or CAD file; or a SPICE kernel, for its segments")
      .required()
      .type("FILE");
  arguments.flag("--meshes", options.meshes,
                 "List all meshes (default: those with the most triangles)");
  arguments.flag("--nodes", options.nodes,
                 "List only the nodes, a line each below a line of headings, separated by tabs: "
                 "name, triangles, materials, id in images, path");
  declare(arguments, options.pose);
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

using pan::layout::SectionKind;
using pan::layout::ToleranceReason;

// A length with the unit that keeps it readable.
std::string length_words(double metres) {
  constexpr struct {
    double size;
    const char* name;
  } kUnits[] = {{1, "m"}, {1e-3, "mm"}, {1e-6, "µm"}, {1e-9, "nm"}};
  for (const auto& unit : kUnits)
    if (metres >= unit.size) return fmt::format("{:.4g} {}", metres / unit.size, unit.name);
  return fmt::format("{:.4g} m", metres);
}

// A place in metres; what is left of sums that cancel is 0.
std::string place_words(const Vec3& place) {
  constexpr double kNothing = 1e-12;  // metres
  Vec3 p = place;
  for (int k = 0; k < 3; ++k)
    if (std::fabs(p[k]) < kNothing) p[k] = 0;
  return fmt::format("{:.6g} {:.6g} {:.6g}", p.x, p.y, p.z);
}

std::string angle_words(double radians) {
  if (radians >= 0.1) return fmt::format("{:.4g} rad", radians);
  return radians >= 1e-4 ? fmt::format("{:.4g} mrad", radians * 1e3)
                         : fmt::format("{:.4g} µrad", radians * 1e6);
}

// What decided a tolerance, for people.
std::string reason_words(const pan::Model& model, ToleranceReason reason) {
  switch (reason) {
    case ToleranceReason::explicit_counts:
      return "as given";
    case ToleranceReason::tolerance:
      return model.budget() && model.budget()->tolerance > 0 ? "tolerance" : "default";
    case ToleranceReason::shape:
      return "the shape's own";
    case ToleranceReason::command_line:
      return "--max-error";
    default:
      return std::string(pan::reason_name(reason));
  }
}

struct Totals {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t unique_triangles = 0;
  std::uint64_t unique_vertices = 0;
  double worst_error = 0;  // metres, world: transforms applied
};

Totals totals_of(const pan::Model& model) {
  Totals totals;
  const auto world = model.world_from_nodes();
  for (const auto& instance : model.instances()) {
    totals.triangles += model.meshes()[instance.mesh].triangle_count;
    totals.vertices += model.meshes()[instance.mesh].vertex_count;
    totals.worst_error = std::max(totals.worst_error, model.meshes()[instance.mesh].error *
                                                          stretch_of(world[instance.node]).largest);
  }
  for (const auto& mesh : model.meshes()) {
    totals.unique_triangles += mesh.triangle_count;
    totals.unique_vertices += mesh.vertex_count;
  }
  return totals;
}

std::string plural(std::uint64_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

constexpr double kRoundingAlone =
    5e-3;  // of what was asked: the chords of surfaces of revolution take most

// "error 0.21 mm of 0.25 mm asked (86 %, flux)"
std::string mesh_error_words(const pan::Model& model, std::size_t i) {
  const double error = model.meshes()[i].error;
  const std::string achieved = error > 0 ? length_words(error) : "0";
  if (model.mesh_tolerances().empty()) return fmt::format("error {} in its own frame", achieved);
  const auto& budget = model.mesh_tolerances()[i];
  const std::string reason = reason_words(model, ToleranceReason{budget.reason});
  if (!(budget.tolerance > 0)) return fmt::format("error {} ({})", achieved, reason);
  const double ratio = error / budget.tolerance;
  // what is flat is exact, whatever was asked
  return fmt::format(
      "error {} of {} allowed ({})", achieved, length_words(budget.tolerance),
      ratio < kRoundingAlone ? "rounding alone" : fmt::format("{:.0f} %, {}", 100 * ratio, reason));
}

void print_need(const pan::Model& model) {
  if (!model.budget()) return;
  const pan::layout::Budget& budget = *model.budget();
  std::vector<std::string> lines;
  if (budget.nearest > 0 && budget.ifov > 0)
    lines.push_back(fmt::format("nearest {}, {} a pixel: a pixel covers {}",
                                length_words(budget.nearest), angle_words(budget.ifov),
                                length_words(budget.nearest * budget.ifov)));
  if (budget.tolerance > 0)
    lines.push_back(fmt::format("tolerance {}", length_words(budget.tolerance)));
  if (budget.pixels > 0)
    lines.push_back(fmt::format(
        "silhouettes to {:.4g} px, gives {}", budget.pixels,
        length_words(compiler::tolerance_of_pixels(budget.pixels, budget.ifov, budget.nearest))));
  if (budget.centroid > 0)
    lines.push_back(fmt::format("photocentres to {:.4g} px, gives {}", budget.centroid,
                                length_words(compiler::tolerance_of_centroid(
                                    budget.centroid, budget.ifov, budget.nearest))));
  if (budget.flux > 0)
    lines.push_back(fmt::format("flux to {:.4g} %, gives {:.3g} % of a shape's radius",
                                100 * budget.flux, 100 * budget.flux / compiler::kFluxFactor));
  std::string decided;
  for (const auto& [reason, count] : decisions_of(model))
    decided += fmt::format("{}{} for {}", decided.empty() ? "decided by " : ", ",
                           reason_words(model, reason), plural(count, "mesh", "meshes"));
  if (budget.smallest > 0) decided += "; finest " + length_words(budget.smallest) + " in the world";
  if (!decided.empty()) lines.push_back(decided);
  const char* label = "budget";
  for (const std::string& line : lines) {
    print("{:<9} {}\n", label, line);
    label = "";
  }
}

void print_mesh(const pan::Model& model, std::size_t i) {
  const auto& mesh = model.meshes()[i];
  print("mesh      {}: {}, {}, {}, {}\n", model.mesh_name(i),
        counted(mesh.triangle_count, "triangle"), plural(mesh.vertex_count, "vertex", "vertices"),
        mesh.flags & pan::layout::kMeshClosed ? "closed" : "open", mesh_error_words(model, i));
}

// Of all meshes together: the number of triangles, the largest error of those that are no levels of
// detail, and the largest share of what was asked.
std::string meshes_words(const pan::Model& model, const Totals& totals) {
  std::string words = counted(totals.unique_triangles, "triangle");
  const auto meshes = model.meshes();
  std::vector<char> coarse(meshes.size());
  for (const pan::layout::Level& level : model.levels()) coarse[level.mesh] = 1;
  for (const pan::layout::Instance& instance : model.instances()) coarse[instance.mesh] = 0;
  const auto error = [&](const pan::layout::Mesh& mesh) {
    return coarse[static_cast<std::size_t>(&mesh - meshes.data())] ? -1 : mesh.error;
  };
  const auto worst =
      std::max_element(meshes.begin(), meshes.end(),
                       [&](const auto& a, const auto& b) { return error(a) < error(b); });
  if (worst == meshes.end()) return words;
  const auto name = [&](auto mesh) {
    return model.mesh_name(static_cast<std::size_t>(mesh - meshes.begin()));
  };
  words += worst->error > 0
               ? fmt::format("; largest error {} ({})", length_words(worst->error), name(worst))
               : "; no error";
  double ratio = 0;
  auto nearest = meshes.end();
  for (std::size_t i = 0; i < model.mesh_tolerances().size(); ++i) {
    const double tolerance = model.mesh_tolerances()[i].tolerance;
    if (!(tolerance > 0) || meshes[i].error / tolerance <= ratio) continue;
    ratio = meshes[i].error / tolerance;
    nearest = meshes.begin() + static_cast<std::ptrdiff_t>(i);
  }
  if (nearest != meshes.end() && ratio >= kRoundingAlone)
    words += fmt::format(", at most {:.0f} % of the tolerance ({})", 100 * ratio, name(nearest));
  return words;
}

// A summary and the heaviest ones, or all in their order.
void print_meshes(const pan::Model& model, const Totals& totals, bool all) {
  constexpr std::size_t kHeaviest = 5;
  const auto meshes = model.meshes();
  print("meshes    {}: {}\n", meshes.size(), meshes_words(model, totals));
  std::vector<std::size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!all) {
    const auto heavier = [&](std::size_t a, std::size_t b) {
      return meshes[a].triangle_count != meshes[b].triangle_count
                 ? meshes[a].triangle_count > meshes[b].triangle_count
                 : a < b;
    };
    const std::size_t shown = std::min(kHeaviest, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown),
                      order.end(), heavier);
    order.resize(shown);
  }
  for (const std::size_t i : order) print_mesh(model, i);
  if (order.size() < meshes.size())
    print("          and {} lighter; --meshes lists all\n",
          plural(meshes.size() - order.size(), "mesh", "meshes"));
}

// ", under a coat of index 1.41, slope 0.05"
std::string coat_words(const pan::layout::Material& material) {
  const auto coat = pan::material_from(material, {}).coat;
  if (!coat) return {};
  return fmt::format(", under a coat of index {:.4g}, {}", static_cast<float>(coat->index),
                     coat->alpha > 0 ? fmt::format("slope {:.3g}", coat->alpha) : "smooth");
}

void print_materials(const pan::Model& model) {
  for (std::size_t i = 0; i < model.materials().size(); ++i) {
    const auto& material = model.materials()[i];
    std::string maps;
    const auto add = [&](std::int32_t texture, const char* name) {
      if (texture >= 0) maps += fmt::format("{}{}", maps.empty() ? ", maps: " : ", ", name);
    };
    add(material.albedo_map, "albedo");
    add(material.normal_map, "normal");
    add(material.roughness_map, "roughness");
    add(material.reflectance_map, "reflectance");
    add(material.cutout_map, "cutout");
    print("material  {}: {} + {}{}{}\n", model.material_name(i),
          diffuse_word(material.diffuse_brdf), specular_word(material.specular_brdf),
          coat_words(material), maps);
  }
}

// "backs     foil: mli_aluminised (3 instances)": one line for each pair of materials.
void print_backs(const pan::Model& model) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> pairs;
  for (const pan::layout::Back& back : model.backs())
    ++pairs[{model.instances()[back.instance].material, back.material}];
  for (const auto& [sides, count] : pairs)
    print("backs     {}: {} ({})\n", model.material_name(sides.first),
          model.material_name(sides.second), plural(count, "instance", "instances"));
}

// "levels    mesh1: 57600 triangles, 14400 within 2.5 mm from 0.01 m, … a pixel": one line for each
// mesh, where it is placed largest.
void print_levels(const pan::Model& model, const std::vector<Mat4>& world) {
  std::map<std::uint32_t, double> stretches;  // by mesh
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    double& largest = stretches[model.instances()[i].mesh];
    largest = std::max(largest, stretch_of(world[model.instances()[i].node]).largest);
  }
  std::set<std::uint32_t> known;
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const auto levels = model.levels(i);
    const std::uint32_t mesh = model.instances()[i].mesh;
    if (levels.empty() || !known.insert(mesh).second) continue;
    const double stretch = stretches[mesh];
    std::string words;
    for (const pan::layout::Level& level : levels)
      words +=
          fmt::format(", {} within {} from {:.4g} m", model.meshes()[level.mesh].triangle_count,
                      length_words(stretch * level.error), stretch * level.detail);
    print("levels    {}: {}{} a pixel\n", model.mesh_name(mesh),
          counted(model.meshes()[mesh].triangle_count, "triangle"), words);
  }
}

// "docking, spot at 0 0 1 toward 0 0 1, intensity 40, half-angle 20deg; off".
std::string lamp_words(const world::Lamp& lamp, const Mat4& world_from_node) {
  const auto at = [&](const Vec3& p) { return place_words(Vec3(world_from_node * Vec4(p, 1.0))); };
  const auto along = [&](const Vec3& axis) {
    const Vec3 turned = glm::normalize(Mat3(world_from_node) * axis);
    return fmt::format(" along {:.4g} {:.4g} {:.4g}", turned.x, turned.y, turned.z);
  };
  const auto bands = [](const Vec3& v) {
    return v.x == v.y && v.y == v.z ? fmt::format("{:.4g}", v.x)
                                    : fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z);
  };
  std::string words = lamp.name;
  if (const auto* spot = std::get_if<light::Spot>(&lamp.source)) {
    words += fmt::format(", spot at {}{}, intensity {}, half-angle {:.4g}deg", at(spot->position),
                         along(spot->axis), bands(spot->intensity), spot->half_angle / kDegree);
    if (spot->exponent != 0) words += fmt::format(", exponent {:.4g}", spot->exponent);
  } else if (const auto* disc = std::get_if<light::Disc>(&lamp.source)) {
    words += fmt::format(", disc at {}{}, intensity {}, radius {:.4g} m", at(disc->position),
                         along(disc->axis), bands(disc->intensity), disc->radius);
  } else {
    const auto& point = std::get<light::Point>(lamp.source);
    words += fmt::format(", point at {}, intensity {}", at(point.position), bands(point.intensity));
  }
  return words + (lamp.on ? "" : "; off");
}

void print_ground_truth(const pan::Model& model, const std::vector<Mat4>& world) {
  for (std::size_t i = 0; i < model.frames().size(); ++i) {
    const pan::layout::Frame& frame = model.frames()[i];
    print("frame     {} at {}\n", model.frame_name(i),
          place_words(Vec3((world[frame.node] * pan::node_from_frame(frame))[3])));
  }
  for (std::size_t i = 0; i < model.keypoints().size(); ++i) {
    const auto& point = model.keypoints()[i];
    const Vec4 p(point.position[0], point.position[1], point.position[2], 1.0);
    print("keypoint  {} at {}\n", model.keypoint_name(i), place_words(Vec3(world[point.node] * p)));
  }
  for (const world::Lamp& lamp : world::lamps_of({}, model))
    print("lamp      {}\n", lamp_words(lamp, world[lamp.node]));
  for (const pan::layout::Sheet& sheet : model.sheets())
    print("foil      {}, {}: {:.4g} x {:.4g} m, seed {}, height {:.3g} m RMS, slope {:.3g} RMS\n",
          model.mesh_name(sheet.mesh), form_word(sheet), sheet.width, sheet.height, sheet.seed,
          sheet.height_rms, sheet.slope_rms);
  print_levels(model, world);
  for (std::size_t i = 0; i < model.decals().size(); ++i) {
    const auto& decal = model.decals()[i];
    print("decal     {}{}: {:.4g} x {:.4g} m on {}\n",
          model.decal_name(i).empty() ? "" : fmt::format("{}, ", model.decal_name(i)),
          model.texture_name(decal.texture), decal.width, decal.height,
          model.node_path(model.instances()[decal.instance].node));
  }
}

// "draco, 14 to 16 bits; vertices moved by 1e-05 m, normals by 0.01 deg at most".
std::string stream_words(const pan::Model& model) {
  const auto streams = model.mesh_streams();
  if (streams.empty()) return {};
  constexpr const char* kForms[] = {"plain", "meshopt", "draco"};
  std::size_t count[3] = {};
  std::uint32_t least = 24, most = 0;
  double moved = 0, turned = 0;
  for (const pan::layout::MeshStream& stream : streams) {
    ++count[stream.form];
    least = std::min(least, stream.position_bits);
    most = std::max(most, stream.position_bits);
    moved = std::max(moved, stream.position_error);
    turned = std::max(turned, stream.normal_error);
  }
  std::string out;
  for (std::size_t k = 0; k < 3; ++k)
    if (count[k] > 0)
      out += fmt::format("{}{} as {}", out.empty() ? "" : ", ", plural(count[k], "mesh", "meshes"),
                         kForms[k]);
  if (most == 0) return out + ", floats";
  out +=
      least == most ? fmt::format(", {} bits", most) : fmt::format(", {} to {} bits", least, most);
  return out + fmt::format("; vertices moved by {:.3g} m, normals by {:.3g} deg at most", moved,
                           turned / kDegree);
}

void print_storage(const pan::Model& model) {
  std::size_t compressed = 0;
  std::uint64_t stored = 0, raw = 0;
  std::string others;
  for (const pan::layout::DirectoryEntry& entry : model.directory()) {
    if (entry.codec == static_cast<std::uint32_t>(pan::layout::Codec::chunks)) {
      ++compressed;
      stored += entry.stored_length;
      raw += entry.raw_length;
    }
    if (!model.reads(entry) && entry.kind != terrain::kTilesSection)
      others += (others.empty() ? "" : ", ") + pan::kind_name(entry.kind);
  }
  if (compressed > 0)
    print("format    {}.{}, {} compressed: {} bytes instead of {}\n", model.header().major,
          model.header().minor, counted(compressed, "section"), stored, raw);
  if (const auto words = stream_words(model); !words.empty()) print("stored    {}\n", words);
  if (!others.empty()) print("ignored   sections of this file: {}\n", others);
  for (const pan::layout::DirectoryEntry& entry : model.directory())
    if (entry.kind == terrain::kTilesSection)
      print("terrain   {} of tiles; panwright dem shows them\n", counted(entry.raw_length, "byte"));
}

// The records that the layout gives a line.
void print_table(const pan::Model& model, SectionKind kind) {
  if (pan::table_info(kind).info[0] == '\0') return;
  const std::size_t count = model.section(kind).size() / pan::section_info(kind).stride;
  for (std::size_t i = 0; i < count; ++i) print("{}\n", pan::info_line(model, kind, i));
}

void print_text(const std::string& path, const world::Instance& target, const Totals& totals,
                bool all_meshes) {
  const pan::Model& model = *target.model();
  print("{}: {}, {}, {} in {}\n", path, counted(model.bytes().size(), "byte"),
        counted(totals.triangles, "triangle"), counted(model.instances().size(), "instance"),
        plural(model.meshes().size(), "mesh", "meshes"));
  std::string ground_truth;
  const auto add = [&](std::size_t count, const char* noun) {
    if (count > 0) ground_truth += (ground_truth.empty() ? "" : ", ") + counted(count, noun);
  };
  add(model.frames().size(), "frame");
  add(model.keypoints().size(), "keypoint");
  add(model.lamps().size(), "lamp");
  add(model.decals().size(), "decal");
  if (!ground_truth.empty()) print("with      {}\n", ground_truth);
  print("made by   {} ({})\n", model.version(), model.options());
  print("build id  {}\n", model.build_id().hex());
  print_storage(model);
  const auto bounds = world::exact_bounds(target);
  if (bounds) print("size      {}\n", compiler::size_in_words(bounds->extent()));
  if (bounds)
    print("bounds    {:.6g} {:.6g} {:.6g} .. {:.6g} {:.6g} {:.6g} m\n", bounds->low.x,
          bounds->low.y, bounds->low.z, bounds->high.x, bounds->high.y, bounds->high.z);
  print("error     {:.4g} m at most between mesh and shape\n", totals.worst_error);
  print_need(model);
  print_meshes(model, totals, all_meshes);
  print_materials(model);
  print_backs(model);
  print_table(model, SectionKind::textures);
  print_ground_truth(model, world::evaluated(target).model_from_nodes);
  for (const std::string& line : joint_lines(model, target.joint_values()))
    print("joint     {}\n", line);
  for (const pan::layout::SectionInfo& info : pan::layout::kSections)
    if (info.kind != SectionKind::textures && info.kind != SectionKind::inputs)
      print_table(model, info.kind);
  print_table(model, SectionKind::inputs);
}

int run(const Options& options, const Host& host) {
  CommandContext context("info", options.common, host);
  if (is_kernel_file(options.input)) {
    (void)show_kernel(options.input, !options.common.json, context.result(), context.log());
    return context.finish();
  }
  const auto read = options.read.opening(context.log());
  if (!read) return context.finish();
  if (workspace::extension_of(options.input) == ".pxn") context.summarise_imports();
  workspace::OpenReport report;
  const auto opened = workspace::open(options.input, *read, context.log(), context.job(), &report);
  context.add_timings(report.steps);
  if (!opened) return context.finish();
  const world::ModelPtr& model = *opened;
  const auto world = posed(options.input, model, options.pose, context.log());
  if (!world) return context.finish();
  const Totals totals = totals_of(*model);
  Json& out = context.result();
  out["file"] = options.input;
  out["bytes"] = model->bytes().size();
  out["format"] = fmt::format("{}.{}", model->header().major, model->header().minor);
  out["compressed"] = model->compressed();
  if (const auto words = stream_words(*model); !words.empty()) out["storage"] = words;
  out["build_id"] = model->build_id().hex();
  out["version"] = model->version();
  out["options"] = model->options();
  out["triangles"] = totals.triangles;
  out["vertices"] = totals.vertices;
  out["unique_triangles"] = totals.unique_triangles;
  out["unique_vertices"] = totals.unique_vertices;
  out["error"] = totals.worst_error;
  const world::Instance& target = (*world)[0];
  const std::vector<Mat4> matrices = world::evaluated(target).model_from_nodes;
  const auto bounds = world::exact_bounds(target);
  out["bounds"] = bounds_json(bounds);
  out["size"] = size_json(bounds);
  out["nodes"] = table_json(*model, pan::layout::SectionKind::nodes);
  out["joints"] = joints_json(*model, target.joint_values());
  out["instances"] = instances_json(*model);
  out["budget"] = budget_json(*model);
  out.update(tables_json(*model, matrices));
  out.update(ground_truth_json(*model, matrices));
  add_other_tables(*model, out);
  out["sections"] = sections_json(*model);
  if (options.nodes && !options.common.json)
    print("{}", node_list(*model));
  else if (!options.common.json)
    print_text(options.input, target, totals, options.meshes);
  return context.finish();
}

}  // namespace
}  // namespace command_info

Command info_command() {
  return command("info", "Show the contents of a model or of a SPICE kernel",
                 command_info::declare_all, command_info::run);
}

}  // namespace panwright::tools
