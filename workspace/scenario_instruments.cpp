#include "workspace/internal/scenario_instruments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/text.h"
#include "instruments/point_files.h"
#include "instruments/radar_files.h"
#include "workspace/settings.h"

namespace panwright::workspace {

namespace {

constexpr std::size_t kMostInstruments = 64;

// Names of files that labels have.
constexpr std::string_view kTaken[] = {"labels", "masks", "forward", "backward"};

bool is_plain(std::string_view name) {
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

bool has_writer(InstrumentKind kind, const std::string& type) {
  const std::filesystem::path file = "x." + type;
  return kind == InstrumentKind::lidar ? instruments::is_point_file(file)
                                       : instruments::is_histogram_file(file);
}

void read_types(ConfigTable& part, ScenarioInstrument& out) {
  const ConfigValue* member = part.find("types");
  if (member == nullptr) {
    out.types = {"npz"};
    return;
  }
  const auto add = [&](const ConfigValue& value) {
    const auto* type = std::get_if<std::string>(&value.data);
    if (type == nullptr || !is_plain(*type) || !has_writer(out.kind, *type))
      return part.fail(
          value, fmt::format("a type of files is {}, expected {}",
                             type == nullptr ? std::string(type_name(value)) : in_quotes(*type),
                             out.kind == InstrumentKind::lidar ? instruments::kPointFileTypes
                                                               : instruments::kHistogramFileTypes));
    if (std::ranges::find(out.types, *type) == out.types.end()) out.types.push_back(*type);
  };
  const auto* list = std::get_if<ConfigValue::List>(&member->data);
  if (list == nullptr) return add(*member);
  if (list->empty()) part.fail(*member, "types is empty");
  for (const ConfigValue& each : *list) add(each);
}

void read_mount(ConfigTable& part, world::Pose& mount) {
  if (const auto p = part.numbers("position", {3})) mount.translation = {(*p)[0], (*p)[1], (*p)[2]};
  if (const auto q = part.numbers("quat", {4})) {
    const auto unit = unit_quaternion(Quat((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
    if (!unit) return part.fail(*part.find("quat"), "quat is not of length 1");
    mount.rotation = *unit;
  }
}

ScenarioInstrument read_one(ConfigTable& part, const std::filesystem::path& folder,
                            DiagnosticLog& log) {
  ScenarioInstrument out;
  const auto lidar = part.text("lidar"), radar = part.text("radar");
  if (lidar.has_value() == radar.has_value()) {
    part.fail(part.value(), "an instrument has one of lidar and radar, a file");
    return out;
  }
  out.kind = lidar ? InstrumentKind::lidar : InstrumentKind::radar;
  const std::string kind = lidar ? "lidar" : "radar";
  const auto path = folder / (lidar ? *lidar : *radar);
  if (!require_file(path, log)) part.fail(*part.find(kind), kind + " names no file");
  out.file = path.string();
  out.name = part.text("name").value_or(kind);
  if (const ConfigValue* name = part.find("name"); name != nullptr) {
    if (!is_plain(out.name))
      part.fail(*name, fmt::format("{} is no name of files, expected letters, digits, - and _",
                                   in_quotes(out.name)));
    if (std::ranges::find(kTaken, out.name) != std::end(kTaken))
      part.fail(*name, fmt::format("{} is a name of labels", in_quotes(out.name)));
  }
  read_types(part, out);
  read_mount(part, out.mount);
  out.ideal = part.flag("ideal").value_or(false);
  out.frame = "instrument";
  if (lidar) out.frame = part.text("frame").value_or(out.frame);
  return out;
}

}  // namespace

bool read_instruments(ConfigTable& scenario, const std::filesystem::path& folder,
                      std::vector<ScenarioInstrument>& instruments, DiagnosticLog& log) {
  const ConfigValue* member = scenario.find("instrument");
  if (member == nullptr) return true;
  const auto* list = std::get_if<ConfigValue::List>(&member->data);
  if (list == nullptr || list->empty() || list->size() > kMostInstruments) {
    scenario.fail(*member, fmt::format("instrument is not a list, of [[instrument]], at most {}",
                                       kMostInstruments));
    return false;
  }
  bool good = true;
  for (const ConfigValue& each : *list) {
    ConfigTable part(each, "an instrument", Code("E8013"), log);
    ScenarioInstrument one = read_one(part, folder, log);
    part.finish();
    if (std::ranges::find(instruments, one.name, &ScenarioInstrument::name) != instruments.end())
      part.fail(each, fmt::format("two instruments have the name {}", in_quotes(one.name)));
    good = good && part.ok();
    instruments.push_back(std::move(one));
  }
  return good;
}

}  // namespace panwright::workspace
