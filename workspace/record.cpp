#include "workspace/record.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <variant>
#include <vector>

#include "base/text.h"
#include "image/image.h"
#include "sensor/camera_file.h"
#include "workspace/internal/json_text.h"
#include "workspace/internal/setting_json.h"
#include "workspace/joints.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;
using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;
constexpr std::size_t kMaxRecordBytes = 64u << 20;

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

// Width of an orthographic image that an option gives, so that reading it makes the same double.
double ortho_of(const world::Camera& camera) {
  // focal = pixels / width: one of the few doubles around the quotient gives it back
  const double width = camera.width / camera.focal.x;
  double candidate = width;
  for (int i = 0; i < 3; ++i) candidate = std::nextafter(candidate, 0.0);
  for (int i = 0; i < 7; ++i) {
    world::Camera other = camera;
    world::set_orthographic(other, camera.width, camera.height, candidate);
    if (other.focal.x == camera.focal.x) return candidate;
    candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
  }
  return width;
}

// What a record has of one kind of instrument: overloads for each kind.

// Settings of the instrument, with all that was left to defaults.
void set_kind(const CameraInstrument& kind, Settings& made) {
  const world::Camera& camera = kind.camera;
  made.size = {camera.width, camera.height};
  made.camera = camera.position;
  made.quat = camera.world_from_camera;
  const Settings none;
  made.look_at = none.look_at;
  made.up = none.up;
  made.camera_frame = none.camera_frame;
  made.fov = none.fov;
  made.ifov = none.ifov;
  made.intrinsics = none.intrinsics;
  made.distortion = none.distortion;
  if (camera.distortion != nullptr)
    if (std::string text = sensor::distortion_text(camera.distortion->distortion()); !text.empty())
      made.distortion = std::move(text);
  made.ortho = none.ortho;
  if (camera.projection == world::Projection::perspective)
    made.intrinsics = {camera.focal.x, camera.focal.y, camera.principal.x, camera.principal.y};
  else
    made.ortho = ortho_of(camera);
}

bool keeps_field(const CameraInstrument& kind) {
  return kind.field_of_view && kind.camera.projection == world::Projection::perspective;
}

// Settings of a frame with all that was left to defaults of the instrument and the world.
Settings made_settings(const world::World& world, const Frame& frame) {
  Settings made = with_presets(frame.settings);
  std::visit([&](const auto& kind) { set_kind(kind, made); }, frame.instrument);
  const Settings none;
  const world::Sun& sun = world.sun();
  made.sun = sun.direction;
  made.sun_distance = sun.distance;
  made.sun_irradiance = none.sun_irradiance;
  if (sun.irradiance) made.sun_irradiance = *sun.irradiance;
  made.white = none.white;
  if (world.given_white()) made.white = *world.given_white();
  made.limb_darkening = sun.limb_darkening;
  made.quality = none.quality;
  if (!made.pixel_error && !made.samples->number) made.quality = Settings::Quality::standard;
  return made;
}

bool is_recorded(SettingId id, const Settings& settings) {
  switch (info_of(id).record) {
    case Recorded::never:
      return false;
    case Recorded::always:
      return is_effective(id, settings);
    case Recorded::given:
      return has_value(id, settings) && is_effective(id, settings);
    case Recorded::changed:
      return is_changed(id, settings) && is_effective(id, settings);
  }
  return false;
}

// A default that is given replaces what the scene of a model has, as `--stars off`.
bool replaces_scene(SettingId id, const Settings& settings) {
  return info_of(id).record == Recorded::changed && has_value(id, settings) &&
         is_effective(id, settings);
}

Json view_of(const world::World& world, const Frame& frame, const RecordSource& source) {
  const Settings settings = made_settings(world, frame);
  const bool has_scene = !frame.scene_target.empty();
  Json view;
  for (const SettingId id : kRecordOrder) {
    if (id == SettingId::pose) {
      for (const world::Instance& target : world.instances()) {
        const Vec3& at = target.pose().translation;
        const Quat& turn = target.pose().rotation;
        view["pose"][target.name()] = {at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z};
      }
    } else if (id == SettingId::joint) {
      for (const world::Instance& target : world.instances())
        for (const world::JointState& state : target.joint_states()) {
          const auto kind =
              static_cast<geometry::JointKind>(target.model()->joints()[state.joint].kind);
          const std::string name(target.model()->joint_name(state.joint));
          view["joint"][target.name() + "/" + name] = exact_value(kind, state.values);
        }
    } else if (id == SettingId::define) {
      for (const auto& [name, value] : source.open.parameters) view["define"][name] = value;
    } else if (is_recorded(id, settings) || (has_scene && replaces_scene(id, settings))) {
      view[std::string(info_of(id).name)] = setting_json(id, settings);
    }
  }
  return view;
}

// Every keypoint, whether it is in the image or not; one behind the camera has no pixel.
Json keypoints_of(const world::World& world, const CameraInstrument& kind) {
  const world::Camera& camera = kind.camera;
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
  if (targets == value.end() || !targets->is_array()) return "no targets";
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

std::string record_text(const world::World& world, const Frame& frame, const RecordSource& source,
                        preview::ContextKind context) {
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
  if (std::visit([](const auto& kind) { return keeps_field(kind); }, frame.instrument))
    record["field_of_view"] = true;
  if (const Json options = reading(source.open); !options.empty()) record["reading"] = options;
  if (*frame.settings.engine == Settings::Engine::gl && context != preview::ContextKind::automatic)
    record["context"] = context == preview::ContextKind::egl ? "egl" : "osmesa";
  record["view"] = view_of(world, frame, source);
  // rows of several times show them elsewhere
  Json keypoints;
  if (*frame.settings.line_time == 0)
    keypoints =
        std::visit([&](const auto& kind) { return keypoints_of(world, kind); }, frame.instrument);
  if (!keypoints.empty()) record["keypoints"] = std::move(keypoints);
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
  log.report_file(Code("E0207"), image.string(),
                  "the record of how the image was made cannot be read: " + wrong);
  return failed;
}

void keep_field_of_view(Settings& settings, const ImageSize& size) {
  if (!settings.intrinsics || *settings.size == size) return;
  const double times = static_cast<double>(size.width) / settings.size->width;
  settings.intrinsics = {times * settings.intrinsics->x, times * settings.intrinsics->y,
                         size.width / 2.0, size.height / 2.0};
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
    log.report_file(Code("W0208"), image.string(), message);
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
