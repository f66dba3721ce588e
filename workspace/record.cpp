#include "workspace/record.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "base/text.h"
#include "image/image.h"
#include "workspace/internal/json_text.h"
#include "workspace/joints.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;
using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;
constexpr std::size_t kMaxRecordBytes = 64u << 20;

Json numbers(const Vec3& v) { return {v.x, v.y, v.z}; }

// Names of files may hold any bytes, JSON texts only UTF-8.
Json as_written(const std::string& name) {
  if (to_utf8(name, Encoding::utf8) == name) return name;
  std::string hex;
  for (const char c : name) hex += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return {{"bytes", hex}};
}

std::optional<std::string> from_hex(std::string_view hex) {
  std::string out;
  if (hex.size() % 2 != 0) return std::nullopt;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    unsigned value = 0;
    const char* const end = hex.data() + i + 2;
    if (std::from_chars(hex.data() + i, end, value, 16).ptr != end) return std::nullopt;
    out += static_cast<char>(value);
  }
  return out;
}

// Options of reading that are not as they are by default. `visit(name, member)` sees all of them.
template <class Open, class Visit>
void each_option(Open& open, Visit&& visit) {
  visit("max-error", open.max_error);
  visit("budget", open.budget);
  visit("root", open.root);
  auto& cad = open.cad;
  visit("units", cad.units);
  visit("up-axis", cad.up);
  visit("scene", cad.scene);
  visit("animation", cad.animation);
  visit("time", cad.time);
  visit("assume", cad.assume);
  visit("no-weld", cad.no_weld);
  visit("weld", cad.weld);
  visit("crease", cad.crease_deg);
  visit("primitives", cad.primitives);
  visit("deflection", cad.deflection);
  visit("crease-normals", cad.crease_normals);
  visit("keep-hidden", cad.keep_hidden);
  visit("recentre", cad.recentre);
}

Json reading(const OpenOptions& open) {
  Json given = Json::object();
  const auto write = [](Json& out) {
    return [&out](const char* name, const auto& value) {
      if constexpr (requires { value.has_value(); })
        out[name] = value ? Json(*value) : Json();
      else if constexpr (requires { value.size(); })
        out[name] = as_written(value);
      else
        out[name] = value;
    };
  };
  Json all;
  Json usual;
  each_option(open, write(all));
  const OpenOptions none;
  each_option(none, write(usual));
  for (const auto& [name, value] : all.items())
    if (value != usual[name]) given[name] = value;
  return given;
}

// Focal lengths as an option gives them, so that reading them makes the same doubles.
void add_lens(const world::Camera& camera, Json& view) {
  if (camera.projection == world::Projection::perspective) {
    view["intrinsics"] = {camera.focal.x, camera.focal.y, camera.principal.x, camera.principal.y};
    return;
  }
  // focal = pixels / width: one of the few doubles around the quotient gives it back
  double width = camera.width / camera.focal.x;
  double candidate = width;
  for (int i = 0; i < 3; ++i) candidate = std::nextafter(candidate, 0.0);
  for (int i = 0; i < 7; ++i) {
    world::Camera other = camera;
    world::set_orthographic(other, camera.width, camera.height, candidate);
    if (other.focal.x == camera.focal.x) {
      width = candidate;
      break;
    }
    candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
  }
  view["ortho"] = width;
}

void add_files(const image::FileOptions& files, Json& view) {
  if (files.layers != image::FileOptions().layers)
    for (std::size_t i = 0; i < std::size(image::kLayerNames); ++i)
      if (files.has(static_cast<image::FileLayer>(i)))
        view["layers"].push_back(std::string(image::kLayerNames[i]));
  if (files.compress) view["compress"] = true;
}

void add_engine(const DrawOptions& draw, Json& view) {
  const bool traced = draw.engine == Engine::reference;
  view["engine"] = traced ? "reference" : "gl";
  if (!traced) {
    const unsigned samples = draw.samples > 0 ? draw.samples : draw.gl.samples;
    if (samples > 0)
      view["samples"] = samples;
    else
      view["samples"] = "auto";
    if (samples == 0 && draw.gl.work > 0)
      view["quality"] = "standard";
    else if (samples == 0)
      view["pixel-error"] = draw.gl.pixel_error;
    if (draw.gl.adaptive && samples > 0) view["adaptive"] = true;
    if (draw.gl.flat) view["flat"] = true;
    if (!draw.gl.specular_filter) view["specular-filter"] = "off";
    const bool shadows = draw.gl.shadow_side != 0u;
    if (!shadows)
      view["shadows"] = "off";
    else if (draw.gl.shadow_side)
      view["shadow-side"] = *draw.gl.shadow_side;
    if (shadows && draw.gl.shadows != preview::Shadows::automatic)
      view["shadows"] = draw.gl.shadows == preview::Shadows::hard ? "hard" : "soft";
    if (shadows && draw.gl.shadows != preview::Shadows::hard)
      view["sun-points"] = draw.gl.sun_points;
    if (!draw.gl.levels)
      view["levels"] = "off";
    else if (draw.gl.level_pixel)
      view["levels"] = *draw.gl.level_pixel;
    if (draw.gl.imposters != preview::Imposters::automatic)
      view["imposters"] = draw.gl.imposters == preview::Imposters::off ? "off" : "always";
    else if (draw.gl.imposter_pixels)
      view["imposters"] = *draw.gl.imposter_pixels;
    if (draw.gl.imposters != preview::Imposters::off) view["flux-error"] = draw.gl.flux_error;
    if (draw.gl.psf_sigma > 0) view["psf"] = draw.gl.psf_sigma;
    return;
  }
  const preview::ReferenceOptions& reference = draw.reference;
  view["samples"] =
      draw.samples > 0
          ? draw.samples
          : static_cast<unsigned>(std::lround(std::sqrt(static_cast<double>(reference.samples))));
  if (reference.until_error > 0) {
    view["until-error"] = reference.until_error;
    view["max-samples"] = reference.max_samples;
  }
  view["bounces"] = reference.bounces;
  view["seed"] = reference.seed;
  if (reference.psf_sigma > 0) view["psf"] = reference.psf_sigma;
  if (!reference.sun_disc) view["no-sun-disc"] = true;
  if (reference.flat) view["flat"] = true;
}

Json view_of(const world::World& world, const world::Camera& camera, std::optional<double> ev,
             const DrawOptions& draw, const RecordSource& source) {
  Json view;
  view["size"] = fmt::format("{}x{}", camera.width, camera.height);
  if (ev)
    view["ev"] = *ev;
  else
    view["ev"] = "auto";
  if (draw.photo) view["tone"] = "photo";
  add_files(draw.files, view);
  view["camera"] = numbers(camera.position);
  const Quat& q = camera.world_from_camera;
  view["quat"] = {q.w, q.x, q.y, q.z};
  add_lens(camera, view);
  for (const world::Instance& target : world.instances()) {
    const Vec3& at = target.pose().translation;
    const Quat& turn = target.pose().rotation;
    view["pose"][target.name()] = {at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z};
  }
  for (const world::Instance& target : world.instances())
    for (const world::JointState& state : target.joint_states()) {
      const auto kind =
          static_cast<geometry::JointKind>(target.model()->joints()[state.joint].kind);
      view["joint"][target.name() + "/" + std::string(target.model()->joint_name(state.joint))] =
          exact_value(kind, state.values);
    }
  for (const auto& [name, value] : source.open.parameters) view["define"][name] = value;
  const world::Sun& sun = world.sun();
  view["sun"] = numbers(sun.direction);
  view["sun-distance"] = sun.distance;
  if (sun.irradiance) view["sun-irradiance"] = numbers(*sun.irradiance);
  if (world.given_white()) view["white"] = numbers(*world.given_white());
  if (sun.limb_darkening > 0) view["limb-darkening"] = sun.limb_darkening;
  add_engine(draw, view);
  return view;
}

// Every keypoint, whether it is in the image or not; one behind the camera has no pixel.
Json keypoints_of(const world::World& world, const world::Camera& camera) {
  Json out = Json::array();
  for (const world::Instance& target : world.instances()) {
    const pan::Model& model = *target.model();
    if (model.keypoints().empty() || !target.visible()) continue;
    const world::EvaluatedInstance nodes = world::evaluated(target);
    for (std::size_t i = 0; i < model.keypoints().size(); ++i) {
      const pan::layout::Keypoint& point = model.keypoints()[i];
      const Vec4 local(point.position[0], point.position[1], point.position[2], 1);
      const Vec3 place(target.pose().matrix() * (nodes.model_from_nodes[point.node] * local));
      Json one{{"target", target.name()}, {"name", std::string(model.keypoint_name(i))}};
      if (const auto pixel = world::project(camera, place)) one["pixel"] = {pixel->x, pixel->y};
      one["depth"] = (glm::conjugate(camera.world_from_camera) * (place - camera.position)).z;
      out.push_back(std::move(one));
    }
  }
  return out;
}

bool read_option(const json& value, std::string& out) {
  if (value.is_string()) out = value.get<std::string>();
  if (value.is_string()) return true;
  const auto bytes = value.is_object() ? value.find("bytes") : value.end();
  const auto name = value.is_object() && bytes != value.end() && bytes->is_string()
                        ? from_hex(bytes->get_ref<const std::string&>())
                        : std::nullopt;
  if (name) out = *name;
  return name.has_value();
}
bool read_option(const json& value, bool& out) {
  if (value.is_boolean()) out = value.get<bool>();
  return value.is_boolean();
}
bool read_option(const json& value, double& out) {
  if (value.is_number()) out = value.get<double>();
  return value.is_number();
}
bool read_option(const json& value, std::optional<double>& out) {
  if (value.is_number()) out = value.get<double>();
  return value.is_number();
}
bool read_option(const json& value, std::uint32_t& out) {
  if (value.is_number_unsigned()) out = value.get<std::uint32_t>();
  return value.is_number_unsigned();
}

std::string text_of(const json& object, const char* name) {
  std::string out;
  if (const auto found = object.find(name); found != object.end()) (void)read_option(*found, out);
  return out;
}

// Why a record cannot be read; empty: it can.
std::string read_into(const json& value, Record& record, DiagnosticLog& log) {
  if (!value.is_object()) return "it is not an object";
  const auto schema = value.find("schema");
  if (schema == value.end() || *schema != kSchema) return "its schema is not 1";
  record.program = text_of(value, "program");
  record.context = text_of(value, "context");
  if (record.context.empty()) record.context = "auto";
  record.nodes_moved = value.contains("nodes_moved");
  const auto targets = value.find("targets");
  if (targets == value.end() || !targets->is_array() || targets->empty()) return "no targets";
  for (const json& target : *targets) {
    if (!target.is_object()) return "a target is not an object";
    record.targets.push_back(
        {text_of(target, "name"), text_of(target, "file"), text_of(target, "build_id")});
    if (record.targets.back().name.empty()) return "a target has no name";
  }
  if (const auto read = value.find("reading"); read != value.end() && read->is_object()) {
    std::string wrong;
    each_option(record.open, [&](const char* name, auto& member) {
      const auto given = read->find(name);
      if (given != read->end() && !read_option(*given, member)) wrong = name;
    });
    if (!wrong.empty()) return "its option " + wrong;
  }
  const auto view = value.find("view");
  if (view == value.end() || !view->is_object()) return "no view";
  if (!parse_view(view->dump(), 0, {}, record.view, log)) return "its view";
  record.view.label.clear();
  record.view.field_of_view = value.contains("field_of_view");
  return {};
}

}  // namespace

std::string recorded_program() { return "panwright " PANWRIGHT_VERSION; }

std::string record_text(const world::World& world, const world::Camera& camera,
                        std::optional<double> ev, const DrawOptions& draw,
                        const RecordSource& source, bool field_of_view) {
  Json record;
  record["schema"] = kSchema;
  record["program"] = recorded_program();
  bool moved = false;
  for (std::size_t i = 0; i < world.size(); ++i) {
    Json target;
    target["name"] = world[i].name();
    if (i < source.files.size()) target["file"] = as_written(source.files[i]);
    target["build_id"] = world[i].model()->build_id().hex();
    record["targets"].push_back(std::move(target));
    moved = moved || !world[i].node_states().empty() || !world[i].visible();
  }
  if (moved) record["nodes_moved"] = true;
  if (field_of_view && camera.projection == world::Projection::perspective)
    record["field_of_view"] = true;
  if (const Json options = reading(source.open); !options.empty()) record["reading"] = options;
  if (draw.engine == Engine::gl && draw.context != preview::ContextKind::automatic)
    record["context"] = draw.context == preview::ContextKind::egl ? "egl" : "osmesa";
  record["view"] = view_of(world, camera, ev, draw, source);
  if (Json keypoints = keypoints_of(world, camera); !keypoints.empty())
    record["keypoints"] = std::move(keypoints);
  return record.dump(-1, ' ', true, Json::error_handler_t::replace);
}

void add_names(const world::World& world, const image::Image& image, std::string& record) {
  if (!image.has_ground_truth()) return;
  std::vector<std::vector<char>> nodes(world.size()), materials(world.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    nodes[i].resize(world[i].model()->nodes().size());
    materials[i].resize(world[i].model()->materials().size());
  }
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.target_id[i] == 0) continue;
    const std::size_t target = image.target_id[i] - 1;
    if (image.node_id[i] > 0) nodes[target][image.node_id[i] - 1] = 1;
    if (image.material_id[i] > 0) materials[target][image.material_id[i] - 1] = 1;
  }
  Json names;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const pan::Model& model = *world[i].model();
    names["targets"][std::to_string(i + 1)] = world[i].name();
    for (std::size_t n = 0; n < nodes[i].size(); ++n)
      if (nodes[i][n] != 0)
        names["nodes"][world[i].name()][std::to_string(n + 1)] = model.node_path(n);
    for (std::size_t m = 0; m < materials[i].size(); ++m)
      if (materials[i][m] != 0)
        names["materials"][world[i].name()][std::to_string(m + 1)] =
            std::string(model.material_name(m));
  }
  record.pop_back();  // the brace that ends the object
  record += ",\"names\":" + names.dump(-1, ' ', true, Json::error_handler_t::replace) + "}";
}

Result<Record> read_record(const std::filesystem::path& image, DiagnosticLog& log) {
  const auto text = image::read_image_record(image, log);
  if (!text) return failed;
  Record record;
  JsonProblem problem;
  DiagnosticLog inner = log.apart();
  std::string wrong;
  if (text->size() > kMaxRecordBytes) {
    wrong = "it is too long";
  } else if (const auto parsed = parse_json(*text, problem)) {
    wrong = read_into(parsed->value, record, inner);
  } else {
    wrong = problem.message;
  }
  if (wrong.empty()) return record;
  if (!inner.entries().empty()) wrong += ": " + inner.entries()[0].message;
  log.report_file(Code::E0207, image.string(),
                  "the record of how the image was made cannot be read: " + wrong);
  return failed;
}

void keep_field_of_view(ViewText& view, std::string_view size) {
  const auto before = image_size(view.size.value_or("")), now = image_size(size);
  const auto lens = parse_numbers(view.intrinsics.value_or(""), 4);
  if (!before || !now || !lens || *before == *now) return;
  const double times = static_cast<double>(now->first) / before->first;
  view.intrinsics = fmt::format("{} {} {} {}", times * (*lens)[0], times * (*lens)[1],
                                now->first / 2.0, now->second / 2.0);
}

std::filesystem::path find_recorded(const std::string& file, const std::filesystem::path& image) {
  namespace fs = std::filesystem;
  const fs::path path = file;
  std::error_code ignored;
  if (path.is_absolute() || fs::exists(path, ignored)) return path;
  fs::path folder = fs::absolute(image, ignored).parent_path();
  for (int i = 0; i < 8 && !folder.empty(); ++i) {
    if (fs::exists(folder / path, ignored)) return folder / path;
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  return path;
}

void compare_with_record(const Record& record, const world::World& world,
                         const std::filesystem::path& image, DiagnosticLog& log) {
  const auto warn = [&](const std::string& message) {
    log.report_file(Code::W0208, image.string(), message);
  };
  if (record.program != recorded_program())
    warn(fmt::format("made by {}, this is {}", in_quotes(record.program), recorded_program()));
  for (const RecordedTarget& target : record.targets) {
    const auto found = world.find(target.name);
    if (!found) {
      warn(fmt::format("the target {} is missing now", in_quotes(target.name)));
      continue;
    }
    const std::string now = world[*found].model()->build_id().hex();
    if (now != target.build_id)
      warn(fmt::format("the model {} has changed since: its build identity was {}, and is {}",
                       in_quotes(target.name), target.build_id, now));
  }
  if (record.nodes_moved)
    warn("nodes were moved or hidden through the library, which no option reproduces");
}

}  // namespace panwright::workspace
