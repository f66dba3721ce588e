#include "workspace/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/config_text.h"
#include "base/file.h"
#include "base/text.h"
#include "labels/convert.h"
#include "scenario/csv.h"
#include "scenario/formulas.h"
#include "scenario/kernels.h"
#include "scenario/sun.h"
#include "workspace/internal/config_json.h"
#include "workspace/internal/scenario_instruments.h"
#include "workspace/internal/scenario_source.h"
#include "workspace/internal/setting_json.h"
#include "workspace/quantities.h"
#include "workspace/sky_settings.h"
#include "workspace/targets.h"

namespace panwright::workspace {

namespace {

namespace fs = std::filesystem;
using Table = ConfigValue;

// ---- sources

// "camera" stands for the camera, which sources know as no target.
std::string owner(const std::optional<std::string>& target) {
  return !target || *target == "camera" ? std::string() : *target;
}

std::optional<scenario::Method> method_named(std::string_view name) {
  if (name == "linear") return scenario::Method::linear;
  if (name == "cubic") return scenario::Method::cubic;
  if (name == "lagrange") return scenario::Method::lagrange;
  if (name == "hermite") return scenario::Method::hermite;
  return std::nullopt;
}

class ScenarioReader {
 public:
  ScenarioReader(const fs::path& path, const ScenarioOptions& options, DiagnosticLog& log)
      : folder_(path.parent_path()), options_(options), log_(log) {
    files_.push_back(path.string());
  }

  Result<Scenario> read(const Table& root) {
    ConfigTable reader(root, "a scenario", Code("E8013"), log_);
    scenario::SequenceOptions sequence;
    read_epoch(reader, sequence);
    const auto begin = reader.number("begin"), end = reader.number("end"),
               step = reader.number("step");
    if (step && !(*step > 0)) reader.fail(*root.find("step"), "step is not above 0 seconds");
    if (begin && end && *begin > *end) reader.fail(*root.find("end"), "end is before begin");
    Settings settings;
    read_targets(reader, settings);
    read_mount(reader, sequence);
    read_look_at(reader, sequence);
    read_view(reader, settings);
    read_labels(reader);
    good_ = read_instruments(reader, folder_, instruments_, log_) && good_;
    read_sources(reader);
    reader.finish();
    if (!reader.ok() || !good_ || !given_once(parts_, places_, log_)) return failed;
    place_others(settings);
    auto made = scenario::Sequence::of(std::move(parts_), sequence, log_);
    if (!made || !is_covered(*made, root, log_)) return failed;
    return Scenario{*std::move(made),   std::move(settings),    begin, end, step, std::move(files_),
                    std::move(labels_), std::move(instruments_)};
  }

 private:
  void read_epoch(ConfigTable& reader, scenario::SequenceOptions& sequence) {
    const auto text = reader.text("epoch");
    if (!text) return;
    const Table& at = *reader.find("epoch");
    const std::size_t blank = text->find_last_of(' ');
    const auto system = scenario::time_system_named(
        blank == text->npos ? std::string_view("UTC") : std::string_view(*text).substr(blank + 1));
    if (!system)
      return reader.fail(at, "epoch has no known time system, as in \"2026-01-01T00:00:00 UTC\"");
    std::string problem;
    sequence.epoch =
        scenario::parse_epoch(std::string_view(*text).substr(0, blank), *system, problem);
    sequence.system = *system;
    if (!sequence.epoch) reader.fail(at, "epoch: " + problem);
    epoch_ = sequence.epoch;
    system_ = *system;
  }

  void read_mount(ConfigTable& reader, scenario::SequenceOptions& sequence) {
    const Table* table = reader.find("mount");
    if (table == nullptr) return;
    ConfigTable part(*table, "mount", Code("E8013"), log_);
    scenario::Mount mount;
    mount.target = part.text("target").value_or("");
    mount.turns = part.flag("turns").value_or(false);
    if (mount.target.empty()) part.fail(*table, "mount has no target");
    check_name(part, part.find("target"), mount.target);
    part.finish();
    good_ = good_ && part.ok();
    sequence.mount = mount;
  }

  void read_look_at(ConfigTable& reader, scenario::SequenceOptions& sequence) {
    const Table* table = reader.find("look_at");
    if (table == nullptr) return;
    scenario::LookAt look;
    if (const auto* name = std::get_if<std::string>(&table->data)) {
      look.target = *name;
      check_name(reader, table, look.target);
    } else {
      ConfigTable part(*table, "look_at", Code("E8013"), log_);
      look.target = part.text("target").value_or("");
      check_name(part, part.find("target"), look.target);
      look.point = vector(part, "point").value_or(Vec3(0));
      look.up = vector(part, "up");
      part.finish();
      good_ = good_ && part.ok();
    }
    sequence.look_at = look;
  }

  // Where the scenario names its targets, others are mistakes.
  void check_name(ConfigTable& part, const Table* at, const std::string& name) const {
    if (at == nullptr || name.empty() || names_.empty() ||
        std::ranges::find(names_, name) != names_.end())
      return;
    const std::vector<std::string_view> names(names_.begin(), names_.end());
    const auto near = nearest_name(name, names);
    part.fail(*at, fmt::format("no target has the name {}", in_quotes(name)),
              near ? fmt::format("did you mean '{}'?", *near)
                   : fmt::format("the targets are {}", fmt::join(names, ", ")));
  }

  void read_targets(ConfigTable& reader, Settings& settings) {
    const Table* table = reader.find("targets");
    if (table == nullptr) return;
    std::vector<std::string> targets;
    const auto add = [&](const std::string& name, const Table& value) {
      const auto* file = std::get_if<std::string>(&value.data);
      if (file == nullptr)
        return reader.fail(value, fmt::format("{} is {}, expected the file of a model",
                                              in_quotes(name), type_name(value)));
      targets.push_back(name + "=" + (folder_ / *file).string());
      names_.push_back(name);
      good_ = require_file(folder_ / *file, log_) && good_;
    };
    const auto* map = std::get_if<Table::Map>(&table->data);
    if (map == nullptr) return reader.fail(*table, "targets is not a table of files by name");
    for (const auto& [name, value] : *map) add(name, value);
    if (!targets.empty()) settings.targets = std::move(targets);
  }

  void read_labels(ConfigTable& reader) {
    const Table* table = reader.find("labels");
    if (table == nullptr) return;
    ConfigTable part(*table, "labels", Code("E8013"), log_);
    Labelling labels;
    labels.flow = part.flag("flow").value_or(false);
    if (const auto slack = part.number("keypoint_slack")) {
      labels.options.keypoint_slack = *slack;
      if (!(*slack > 0)) part.fail(*part.find("keypoint_slack"), "keypoint_slack is not above 0 m");
    }
    read_label_parts(part, labels.options.parts);
    read_formats(part, labels.formats);
    part.finish();
    good_ = good_ && part.ok();
    labels_ = std::move(labels);
  }

  static void read_formats(ConfigTable& part, std::vector<std::string>& formats) {
    const Table* table = part.find("formats");
    if (table == nullptr) return;
    std::vector<std::string_view> names;
    for (const labels::FormatInfo& info : labels::formats()) names.push_back(info.name);
    const auto add = [&](const Table& value) {
      const auto* name = std::get_if<std::string>(&value.data);
      if (name == nullptr)
        return part.fail(value, fmt::format("a format is {}, expected its name", type_name(value)));
      if (std::ranges::find(names, *name) == names.end()) {
        const auto near = nearest_name(*name, names);
        return part.fail(value,
                         fmt::format("{} is no format of labels, expected {}", in_quotes(*name),
                                     fmt::join(names, ", ")),
                         near ? fmt::format("did you mean '{}'?", *near) : "");
      }
      if (std::ranges::find(formats, *name) == formats.end()) formats.push_back(*name);
    };
    const auto* list = std::get_if<Table::List>(&table->data);
    if (list == nullptr) return add(*table);
    for (const Table& each : *list) add(each);
  }

  void read_sources(ConfigTable& reader) {
    const Table* sources = reader.find("source");
    const auto* list = sources == nullptr ? nullptr : std::get_if<Table::List>(&sources->data);
    if (list == nullptr || list->empty()) {
      reader.fail(sources != nullptr ? *sources : reader.value(),
                  "no source, expected one [[source]] or more");
      return;
    }
    for (const Table& each : *list) read_part(each);
  }
  void read_part(const Table& table) {
    ConfigTable part(table, "a source", Code("E8013"), log_);
    const auto offset = part.number("offset");
    std::optional<scenario::SourcePtr> source;
    if (part.find("simulator") != nullptr)
      source = read_simulator(part, target_of(part), folder_, files_, log_);
    else if (const auto file = part.text("file"))
      source = of_file(part, *file);
    else if (const Table* kernels = part.find("kernels"))
      source = of_kernels(part, *kernels);
    else
      source = of_formula(part, table);
    part.finish();
    good_ = good_ && part.ok() && source.has_value();
    if (!source) return;
    parts_.push_back({*source, offset.value_or(0)});
    places_.push_back(table.where);
  }

  std::optional<scenario::SourcePtr> of_file(ConfigTable& part, const std::string& file) {
    SourceOptions options;
    options.strict = options_.strict;
    const std::string extension = lower_extension(file);
    if (extension == ".csv")
      read_csv_options(part, options.csv);
    else if (extension == ".fli")
      read_fli_options(part, options);
    else if (extension != ".json" && extension != ".jsonl")
      options.target = target_of(part);
    if (!part.ok()) return std::nullopt;
    const fs::path path = folder_ / file;
    files_.push_back(path.string());
    const auto text = scenario::read_text(path, log_);
    if (!text) return std::nullopt;
    auto source = read_source(path, *text, options, log_);
    if (!source) return std::nullopt;
    return *source;
  }

  // kernels: a file, or a list of them.
  std::optional<scenario::SourcePtr> of_kernels(ConfigTable& part, const Table& kernels) {
    std::vector<fs::path> paths;
    const auto add = [&](const Table& each) {
      if (const auto* file = std::get_if<std::string>(&each.data))
        paths.push_back(folder_ / *file);
      else
        part.fail(each, fmt::format("kernels has {}, expected files", type_name(each)));
    };
    if (const auto* list = std::get_if<Table::List>(&kernels.data))
      for (const Table& each : *list) add(each);
    else
      add(kernels);
    scenario::KernelOptions options;
    options.target = target_of(part);
    options.body = name_or_number(part, "body");
    options.observer = name_or_number(part, "observer");
    options.frame = part.text("frame").value_or(options.frame);
    options.aberration = part.text("aberration").value_or(options.aberration);
    options.attitude = part.text("attitude").value_or("");
    options.sun = part.flag("sun").value_or(false);
    options.epoch = epoch_;
    if (epoch_) options.system = system_;
    if (paths.empty()) part.fail(kernels, "kernels has no file");
    if (!part.ok()) return std::nullopt;
    for (const fs::path& path : paths) files_.push_back(path.string());
    auto read = ephemeris::Kernels::load(paths, log_);
    if (!read) return std::nullopt;
    auto source = scenario::kernel_source(paths.front().string(), *std::move(read), options, log_);
    if (!source) return std::nullopt;
    return *source;
  }

  // Bodies have names and numbers.
  static std::string name_or_number(ConfigTable& part, std::string_view name) {
    const Table* value = part.find(name);
    if (value == nullptr) return {};
    if (const auto* number = std::get_if<double>(&value->data)) return format_double(*number);
    return part.text(value, name).value_or("");
  }

  // Owner of a source's channels; empty: the camera.
  std::string target_of(ConfigTable& part) const {
    const std::string target = owner(part.text("target"));
    check_name(part, part.find("target"), target);
    return target;
  }

  static void read_csv_options(ConfigTable& part, scenario::CsvOptions& csv) {
    if (const auto method = part.text("interpolation")) {
      if (const auto named = method_named(*method))
        csv.method = *named;
      else
        part.fail(*part.find("interpolation"),
                  "interpolation is not linear, cubic, lagrange or hermite");
    }
    if (const auto degree = part.number("degree")) {
      if (*degree >= 1 && *degree <= 31 && *degree == std::floor(*degree))
        csv.degree = static_cast<std::size_t>(*degree);
      else
        part.fail(*part.find("degree"), "degree is not a whole number from 1 to 31");
    }
  }

  void read_fli_options(ConfigTable& part, SourceOptions& options) const {
    options.frame_rate = part.number("frame_rate");
    const Table* objects = part.find("objects");
    if (objects == nullptr) return;
    const auto* map = std::get_if<Table::Map>(&objects->data);
    if (map == nullptr) return part.fail(*objects, "objects is not a table of targets by number");
    for (const auto& [number, value] : *map) {
      const auto* name = std::get_if<std::string>(&value.data);
      if (name == nullptr) return part.fail(value, "expected the name of a target");
      check_name(part, &value, *name);
      options.objects[number] = *name;
    }
  }

  std::optional<scenario::SourcePtr> of_formula(ConfigTable& part, const Table& table) {
    const auto formula = part.text("formula");
    const std::string target = target_of(part);
    if (!formula) {
      part.fail(table, "a source has neither file, kernels, simulator nor formula");
      return std::nullopt;
    }
    if (*formula == "clohessy_wiltshire") {
      const auto rate = part.number("rate");
      if (!rate || !(*rate > 0)) {
        part.fail(table, "clohessy_wiltshire needs the rate of the orbit, rad/s, above 0");
        return std::nullopt;
      }
      return scenario::clohessy_wiltshire_source(target, orbit_state(part), *rate);
    }
    if (*formula == "two_body") {
      const double mu = part.number("mu").value_or(scenario::kEarthGravity);
      const auto span = part.number("span");
      const scenario::OrbitState state = orbit_state(part);
      if (!(mu > 0)) part.fail(table, "mu is not above 0 m³/s²");
      if (!part.ok()) return std::nullopt;
      auto source = scenario::two_body_source(target, state, mu, {0, span.value_or(86400)},
                                              table.where, log_);
      if (!source) return std::nullopt;
      return *source;
    }
    if (*formula == "fixed") {
      scenario::Frame frame;
      const scenario::Placement place{vector(part, "position"), quaternion(part, "quat")};
      if (place.position || place.rotation)
        (target.empty() ? frame.camera : frame.target(target).placement) = place;
      frame.sun_direction = vector(part, "sun");
      if (frame.sun_direction && glm::length(*frame.sun_direction) > 0)
        frame.sun_direction = glm::normalize(*frame.sun_direction);
      return scenario::fixed_source("fixed", frame);
    }
    if (*formula == "spin") {
      const auto rate = vector(part, "rate_deg_s");
      if (!rate) {
        part.fail(table, "spin needs rate_deg_s, three numbers in the axes of the target");
        return std::nullopt;
      }
      return scenario::spin_source(target, quaternion(part, "quat").value_or(Quat(1, 0, 0, 0)),
                                   kDegree * *rate);
    }
    if (*formula == "hold_points") return hold_points(part, table, target);
    if (*formula == "sun") {
      if (epoch_) return scenario::sun_source(*epoch_, system_);
      part.fail(table, "the Sun by its date needs the scenario's epoch",
                "epoch = \"2026-01-01T00:00:00 UTC\"");
      return std::nullopt;
    }
    constexpr std::string_view kFormulas[] = {"clohessy_wiltshire", "two_body", "fixed", "spin",
                                              "hold_points",        "sun"};
    part.fail(*part.find("formula"), fmt::format("formula is {}, expected {}", in_quotes(*formula),
                                                 fmt::join(kFormulas, ", ")));
    return std::nullopt;
  }

  static scenario::OrbitState orbit_state(ConfigTable& part) {
    return {vector(part, "position").value_or(Vec3(0)), vector(part, "velocity").value_or(Vec3(0))};
  }

  static std::optional<Vec3> vector(ConfigTable& part, std::string_view name) {
    const auto v = part.numbers(name, {3});
    if (!v) return std::nullopt;
    return Vec3((*v)[0], (*v)[1], (*v)[2]);
  }

  // Unit quaternion w x y z.
  static std::optional<Quat> quaternion(ConfigTable& part, std::string_view name) {
    const auto q = part.numbers(name, {4});
    if (!q) return std::nullopt;
    const auto unit = unit_quaternion(Quat((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
    if (!unit) part.fail(*part.find(name), fmt::format("{} is not of length 1", name));
    return unit;
  }

  std::optional<scenario::SourcePtr> hold_points(ConfigTable& part, const Table& table,
                                                 const std::string& target) {
    const Table* points = part.find("points");
    const auto* list = points == nullptr ? nullptr : std::get_if<Table::List>(&points->data);
    if (list == nullptr) {
      part.fail(table, "hold_points needs points, a list of tables");
      return std::nullopt;
    }
    std::vector<scenario::HoldPoint> all;
    for (const Table& each : *list) {
      ConfigTable one(each, "a hold point", Code("E8013"), log_);
      const auto arrive = one.number("arrive"), leave = one.number("leave");
      const auto position = vector(one, "position");
      if (!arrive || !position) one.fail(each, "a hold point has arrive and position");
      one.finish();
      if (!one.ok()) {
        good_ = false;
        return std::nullopt;
      }
      all.push_back({*arrive, leave.value_or(*arrive), *position});
    }
    auto source = scenario::hold_point_source(target, std::move(all), log_);
    if (!source) return std::nullopt;
    return *source;
  }

  // Targets that nothing places stand at the origin.
  void place_others(const Settings& settings) {
    scenario::Frame frame;
    for (const std::string& target : *settings.targets) {
      const std::string name = target_file(target).name;
      const scenario::Channel position{scenario::Quantity::position, name, {}};
      const bool placed =
          std::ranges::any_of(parts_,
                              [&](const scenario::Part& part) {
                                return std::ranges::count(part.source->info().channels, position) >
                                       0;
                              }) ||
          std::ranges::any_of(*settings.pose, [&](const PoseSetting& pose) {
            return pose.target == name || pose.target.empty();
          });
      if (!placed) frame.target(name).placement.position = Vec3(0);
    }
    if (!frame.targets.empty()) parts_.push_back({scenario::fixed_source("the origin", frame), 0});
  }

  // Settings of all frames, as members of a view.
  void read_view(ConfigTable& reader, Settings& settings) {
    const Table* table = reader.find("view");
    if (table == nullptr) return;
    const auto* map = std::get_if<Table::Map>(&table->data);
    if (map == nullptr) return reader.fail(*table, "view is not a table of settings");
    for (const auto& [name, value] : *map) read_setting_of(reader, name, value, settings);
    place_sky_files(folder_, settings);
    if (!settings.camera_file) return;
    settings.camera_file = (folder_ / *settings.camera_file).string();
    good_ = require_file(*settings.camera_file, log_) && good_;
  }

  void read_setting_of(ConfigTable& reader, const std::string& name, const Table& value,
                       Settings& settings) {
    std::string member = name;
    std::ranges::replace(member, '_', '-');
    const auto found = std::ranges::find(kSettings, member, &SettingInfo::name);
    const auto id = static_cast<SettingId>(found - std::begin(kSettings));
    constexpr SettingId kOfFrames[] = {SettingId::name, SettingId::output, SettingId::outputs,
                                       SettingId::targets};
    if (found == std::end(kSettings) || std::ranges::find(kOfFrames, id) != std::end(kOfFrames)) {
      std::vector<std::string_view> names;
      for (const SettingInfo& each : kSettings) names.push_back(each.name);
      const auto near = nearest_name(member, names);
      return reader.fail(value, fmt::format("view has no setting {}", in_quotes(name)),
                         near && *near != member ? fmt::format("did you mean '{}'?", *near) : "");
    }
    const nlohmann::json read = config_json(value);
    if (const std::string wrong = wrong_type(id, read); !wrong.empty())
      return reader.fail(value, in_quotes(name) + wrong);
    DiagnosticLog apart = log_.apart();
    if (!read_setting(id, read, settings, apart))
      for (const Diagnostic& problem : apart.entries()) reader.fail(value, problem.message);
  }

  fs::path folder_;
  const ScenarioOptions& options_;
  DiagnosticLog& log_;
  std::vector<std::string> files_;
  std::vector<std::string> names_;  // of the targets
  std::vector<scenario::Part> parts_;
  std::vector<SourceSpan> places_;        // of these in the text
  std::optional<scenario::Epoch> epoch_;  // of the scenario
  scenario::TimeSystem system_ = scenario::TimeSystem::utc;
  std::optional<Labelling> labels_;
  std::vector<ScenarioInstrument> instruments_;
  bool good_ = true;
};

}  // namespace

void read_label_parts(ConfigTable& part, std::vector<labels::ChosenPart>& parts) {
  const Table* table = part.find("parts");
  if (table == nullptr) return;
  const auto* map = std::get_if<Table::Map>(&table->data);
  if (map == nullptr) return part.fail(*table, "parts is not a table of nodes by label");
  const auto add = [&](const std::string& label, const Table& value) {
    const auto* node = std::get_if<std::string>(&value.data);
    if (node == nullptr || node->empty() || label.empty())
      return part.fail(value, fmt::format("{} is {}, expected the path of a node", in_quotes(label),
                                          type_name(value)));
    parts.push_back({label, *node});
  };
  for (const auto& [label, value] : *map) {
    const auto* list = std::get_if<Table::List>(&value.data);
    if (list == nullptr) {
      add(label, value);
      continue;
    }
    for (const Table& each : *list) add(label, each);
  }
}

nlohmann::json config_json(const ConfigValue& value) {
  if (const auto* flag = std::get_if<bool>(&value.data)) return *flag;
  if (const auto* number = std::get_if<double>(&value.data)) {
    // whole numbers are integers of JSON
    if (*number == std::floor(*number) && std::fabs(*number) < 0x1p53)
      return static_cast<std::int64_t>(*number);
    return *number;
  }
  if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
  if (const auto* list = std::get_if<ConfigValue::List>(&value.data)) {
    nlohmann::json out = nlohmann::json::array();
    for (const ConfigValue& item : *list) out.push_back(config_json(item));
    return out;
  }
  nlohmann::json out = nlohmann::json::object();
  if (const auto* map = std::get_if<ConfigValue::Map>(&value.data))
    for (const auto& [name, item] : *map) out[name] = config_json(item);
  return out;
}

bool is_scenario(const fs::path& path) {
  constexpr std::string_view kExtensions[] = {".toml", ".csv",   ".fli", ".json",
                                              ".oem",  ".jsonl", ".aem"};
  if (std::ranges::find(kExtensions, lower_extension(path)) != std::end(kExtensions)) return true;
  std::string head(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return begins_with_keyword(head, "CCSDS_OEM_VERS") || begins_with_keyword(head, "CCSDS_AEM_VERS");
}

Result<Scenario> open_scenario(const fs::path& path, const ScenarioOptions& options,
                               DiagnosticLog& log) {
  const std::string extension = lower_extension(path);
  const auto text = scenario::read_text(path, log);
  if (!text) return failed;
  const bool json = extension == ".json" && is_json_scenario(*text->bytes);
  if (extension != ".toml" && !json) {
    SourceOptions of_source;
    of_source.strict = options.strict;
    of_source.target = options.target;
    const auto source = read_source(path, *text, of_source, log);
    if (!source) return failed;
    auto sequence = scenario::Sequence::of({{*source, 0}}, {}, log);
    if (!sequence) return failed;
    return Scenario{*std::move(sequence), {}, {}, {}, {}, {path.string()}, {}, {}};
  }
  SourceFile source;
  source.name = text->name;
  source.bytes = text->bytes;
  const FileId file = log.sources().add(std::move(source));
  const auto root = parse_config(*text->bytes, json ? ConfigFormat::yaml : ConfigFormat::toml, file,
                                 Code("E8013"), log);
  if (!root) return failed;
  return ScenarioReader(path, options, log).read(*root);
}

}  // namespace panwright::workspace
