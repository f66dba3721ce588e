// Plans of data sets as TOML.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/config_text.h"
#include "base/file.h"
#include "base/text.h"
#include "labels/convert.h"
#include "workspace/dataset.h"
#include "workspace/internal/config_json.h"
#include "workspace/settings.h"

namespace panwright::workspace {

namespace {

constexpr std::uint32_t kMostPlanned = 10'000'000;
constexpr const char* kLawExample =
    "{ uniform = [a, b] }, { log_uniform = [a, b] }, { normal = [mean, deviation] } or { choice = "
    "[…] }";

class PlanReader {
 public:
  PlanReader(std::filesystem::path folder, DiagnosticLog& log)
      : folder_(std::move(folder)), log_(log) {}

  Result<DatasetPlan> read(const ConfigValue& root) {
    ConfigTable table(root, "a plan", Code("E8017"), log_);
    read_numbers(table);
    read_targets(table);
    if (const ConfigValue* view = table.find("view")) plan_.view = config_json(*view).dump();
    read_types(table);
    read_labels(table);
    if (const ConfigValue* camera = table.require("camera")) read_camera(*camera);
    if (const ConfigValue* list = table.find("keep_out")) read_keep_out(*list);
    if (const ConfigValue* sun = table.find("sun")) read_sun(*sun);
    if (const ConfigValue* lens = table.find("lens")) read_lens(*lens);
    read_sample(table);
    read_card(table);
    table.finish();
    if (!table.ok() || !good_) return failed;
    return std::move(plan_);
  }

 private:
  ConfigTable part(const ConfigValue& value, std::string_view what) {
    return {value, what, Code("E8017"), log_};
  }
  void end(ConfigTable& table) {
    table.finish();
    good_ = good_ && table.ok();
  }

  void read_numbers(ConfigTable& table) {
    const auto whole = [&](const char* name, double most) -> std::optional<double> {
      const auto value = table.number(table.require(name), name);
      if (value && !(*value >= 0 && *value <= most && *value == std::floor(*value))) {
        table.fail(*table.find(name), fmt::format("{} is {}, expected a whole number from 0 to {}",
                                                  name, format_double(*value), most));
        return std::nullopt;
      }
      return value;
    };
    if (const auto frames = whole("frames", kMostPlanned)) {
      plan_.frames = static_cast<std::uint32_t>(*frames);
      if (plan_.frames == 0) table.fail(*table.find("frames"), "frames is 0, expected 1 or more");
    }
    if (const auto seed = whole("seed", 9007199254740991.0))
      plan_.seed = static_cast<std::uint64_t>(*seed);
  }

  void read_targets(ConfigTable& table) {
    const ConfigValue* targets = table.require("targets");
    if (targets == nullptr) return;
    const auto* map = std::get_if<ConfigValue::Map>(&targets->data);
    if (map == nullptr || map->empty())
      return table.fail(*targets, "targets is not a table of files by name");
    for (const auto& [name, value] : *map) {
      const auto* file = std::get_if<std::string>(&value.data);
      if (file == nullptr)
        table.fail(value, fmt::format("{} is {}, expected the file of a model", in_quotes(name),
                                      type_name(value)));
      else if (require_file(folder_ / *file, log_))
        plan_.targets.emplace_back(name, *file);
      else
        good_ = false;
    }
  }

  static std::vector<std::string> texts(ConfigTable& table, const char* name) {
    const ConfigValue* member = table.find(name);
    std::vector<std::string> out;
    if (member == nullptr) return out;
    const auto add = [&](const ConfigValue& value) {
      const auto* text = std::get_if<std::string>(&value.data);
      if (text != nullptr)
        out.push_back(*text);
      else
        table.fail(value, fmt::format("{} has {}, expected texts", name, type_name(value)));
    };
    if (const auto* list = std::get_if<ConfigValue::List>(&member->data))
      for (const ConfigValue& each : *list) add(each);
    else
      add(*member);
    return out;
  }

  void read_types(ConfigTable& table) {
    auto types = texts(table, "types");
    if (types.empty()) return;
    constexpr std::string_view kTypes[] = {"png", "exr", "npy", "npz", "tif", "fits"};
    for (const std::string& type : types)
      if (std::ranges::find(kTypes, type) == std::end(kTypes))
        table.fail(*table.find("types"), fmt::format("types has {}, expected {}", in_quotes(type),
                                                     fmt::join(kTypes, ", ")));
    plan_.types = std::move(types);
  }

  void read_labels(ConfigTable& table) {
    const ConfigValue* member = table.find("labels");
    if (member == nullptr) return;
    ConfigTable own = part(*member, "labels");
    Labelling labels;
    if (const auto slack = own.number("keypoint_slack")) {
      labels.options.keypoint_slack = *slack;
      if (!(*slack > 0)) own.fail(*own.find("keypoint_slack"), "keypoint_slack is not above 0 m");
    }
    read_label_parts(own, labels.options.parts);
    plan_.labels_json = config_json(*member).dump();
    plan_.labels = std::make_shared<const Labelling>(std::move(labels));
    end(own);
  }

  // A law; a number alone is one that is always drawn.
  std::optional<Distribution> law(ConfigTable& table, const ConfigValue& value, const char* name,
                                  double unit = 1) {
    using Kind = Distribution::Kind;
    Distribution out;
    if (const auto* number = std::get_if<double>(&value.data)) {
      out.a = out.b = *number * unit;
      return out;
    }
    const auto* map = std::get_if<ConfigValue::Map>(&value.data);
    constexpr std::pair<std::string_view, Kind> kLaws[] = {{"uniform", Kind::uniform},
                                                           {"log_uniform", Kind::log_uniform},
                                                           {"normal", Kind::normal},
                                                           {"choice", Kind::choice}};
    const auto known = map != nullptr && map->size() == 1
                           ? std::ranges::find(kLaws, std::string_view(map->front().name),
                                               &std::pair<std::string_view, Kind>::first)
                           : std::end(kLaws);
    if (known == std::end(kLaws)) {
      table.fail(value, fmt::format("{} is no law", name),
                 fmt::format("expected a value, or {}", kLawExample));
      return std::nullopt;
    }
    out.kind = known->second;
    const ConfigValue& given = map->front().value;
    if (out.kind == Kind::choice) {
      const auto* list = std::get_if<ConfigValue::List>(&given.data);
      if (list == nullptr || list->empty()) {
        table.fail(given, fmt::format("choice of {} is no list of values", name));
        return std::nullopt;
      }
      for (const ConfigValue& each : *list) {
        auto json = config_json(each);
        if (unit != 1 && json.is_number()) json = json.get<double>() * unit;
        out.choices.push_back(json.dump());
      }
      return out;
    }
    const auto two = table.numbers(&given, name, {2});
    if (!two) return std::nullopt;
    out.a = (*two)[0] * unit, out.b = (*two)[1] * unit;
    const bool normal = out.kind == Kind::normal;
    if (normal ? out.b < 0 : out.a > out.b)
      table.fail(given, normal ? fmt::format("{}: a deviation below 0", name)
                               : fmt::format("{}: the first bound is above the second", name));
    else if (out.kind == Kind::log_uniform && !(out.a > 0))
      table.fail(given, fmt::format("{}: log_uniform needs bounds above 0", name));
    return out;
  }

  // A law of numbers alone.
  void number_law(ConfigTable& table, const char* name, Distribution& out, double unit = 1) {
    const ConfigValue* member = table.find(name);
    if (member == nullptr) return;
    const auto read = law(table, *member, name, unit);
    if (!read) return;
    for (const std::string& each : read->choices)
      if (!nlohmann::json::parse(each).is_number())
        table.fail(*member, fmt::format("choice of {} has {}, expected numbers", name, each));
    out = *read;
  }

  static bool least_is_positive(const Distribution& law) {
    if (law.kind == Distribution::Kind::choice)
      return std::ranges::all_of(law.choices, [](const std::string& each) {
        const auto value = nlohmann::json::parse(each);
        return value.is_number() && value.get<double>() > 0;
      });
    return law.a > 0;
  }

  std::optional<Vec3> vector(ConfigTable& table, const char* name) {
    const auto v = table.numbers(name, {3});
    if (!v) return std::nullopt;
    return Vec3((*v)[0], (*v)[1], (*v)[2]);
  }

  std::optional<double> angle(ConfigTable& table, const char* name, double most) {
    const auto degrees = table.number(name);
    if (!degrees) return std::nullopt;
    if (!(*degrees >= 0 && *degrees <= most)) {
      table.fail(*table.find(name), fmt::format("{} is {}, expected 0 to {} degrees", name,
                                                format_double(*degrees), most));
      return std::nullopt;
    }
    return *degrees * kDegree;
  }

  void read_cone(const ConfigValue& value, std::string_view what, Cone& cone) {
    ConfigTable own = part(value, what);
    const auto axis = vector(own, "axis");
    const auto within = angle(own, "within", 180);
    if (!own.find("axis") || !own.find("within"))
      own.fail(
          value,
          fmt::format("{} needs axis and within, as {{ axis = [0, 0, 1], within = 30 }}", what));
    if (axis && !(glm::length(*axis) > 0)) own.fail(*own.find("axis"), "axis has no length");
    end(own);
    if (axis && within && own.ok()) cone = {glm::normalize(*axis), *within};
  }

  void read_keep_out(const ConfigValue& list) {
    const auto* cones = std::get_if<ConfigValue::List>(&list.data);
    if (cones == nullptr) {
      part(list, "keep_out").fail(list, "keep_out is no list, expected [[keep_out]]");
      good_ = false;
      return;
    }
    for (const ConfigValue& each : *cones)
      read_cone(each, "keep_out", plan_.keep_out.emplace_back());
  }

  void read_camera(const ConfigValue& value) {
    ConfigTable own = part(value, "camera");
    plan_.target = own.text("target").value_or(plan_.targets.empty() ? std::string()
                                                                     : plan_.targets.front().first);
    std::vector<std::string_view> names;
    for (const auto& each : plan_.targets) names.push_back(each.first);
    if (own.find("target") != nullptr && std::ranges::find(names, plan_.target) == names.end())
      own.fail(*own.find("target"),
               fmt::format("no target has the name {}", in_quotes(plan_.target)),
               fmt::format("the targets are {}", fmt::join(names, ", ")));
    plan_.point = vector(own, "point").value_or(Vec3(0));
    if (const auto attitude = own.text("attitude")) {
      plan_.turns = *attitude == "random";
      if (!plan_.turns && *attitude != "fixed")
        own.fail(*own.find("attitude"), "attitude is not fixed or random");
    }
    if (const ConfigValue* range = own.require("range")) {
      number_law(own, "range", plan_.range);
      if (own.ok() && !least_is_positive(plan_.range))
        own.fail(*range, "range is not above 0 metres");
      if (own.ok() && plan_.range.kind == Distribution::Kind::normal &&
          !(plan_.range.a > 6 * plan_.range.b))
        own.fail(*range, "range: the mean is not above six deviations, so that some are below 0");
    }
    if (const ConfigValue* direction = own.find("direction"))
      read_cone(*direction, "direction", plan_.direction);
    if (const auto share = own.number("placement")) {
      plan_.placement = *share;
      if (!(*share >= 0 && *share <= 1))
        own.fail(*own.find("placement"), "placement is not a share from 0 to 1 of the image");
    }
    number_law(own, "roll", plan_.roll, kDegree);
    if (const auto pixels = own.numbers("pixels", {2})) {
      plan_.pixels = {(*pixels)[0], (*pixels)[1]};
      if (!(plan_.pixels[0] <= plan_.pixels[1]))
        own.fail(*own.find("pixels"), "pixels: the first bound is above the second");
    }
    end(own);
  }

  void read_sun(const ConfigValue& value) {
    ConfigTable own = part(value, "sun");
    plan_.has_sun = true;
    plan_.phase = {Distribution::Kind::uniform, 0, kPi, {}};
    if (const ConfigValue* phase = own.find("phase")) {
      if (std::holds_alternative<ConfigValue::List>(phase->data)) {
        if (const auto bounds = own.numbers(phase, "phase", {2})) {
          plan_.phase.a = (*bounds)[0] * kDegree, plan_.phase.b = (*bounds)[1] * kDegree;
          if (!(0 <= plan_.phase.a && plan_.phase.a <= plan_.phase.b && plan_.phase.b <= kPi))
            own.fail(*phase, "phase: bounds are not 0 to 180 degrees, the lower one first");
        }
      } else {
        plan_.even_phase = false;
        number_law(own, "phase", plan_.phase, kDegree);
      }
    }
    plan_.sun_keep_out = angle(own, "keep_out", 180).value_or(0);
    end(own);
  }

  void read_lens(const ConfigValue& value) {
    ConfigTable own = part(value, "lens");
    plan_.has_lens = true;
    number_law(own, "focal", plan_.focal);
    if (own.ok() && !least_is_positive(plan_.focal))
      own.fail(value, "focal is a factor of the focal lengths, expected above 0");
    if (const ConfigValue* shift = own.find("principal")) {
      const auto* list = std::get_if<ConfigValue::List>(&shift->data);
      if (list == nullptr || list->size() != 2)
        own.fail(*shift, "principal is not a list of two laws, pixels right and down");
      else
        for (std::size_t k = 0; k < 2; ++k)
          if (const auto read = law(own, (*list)[k], "principal")) plan_.principal[k] = *read;
    }
    end(own);
  }

  std::optional<Recipe> recipe(ConfigTable& table, const std::string& name,
                               const ConfigValue& value, bool named) {
    if (const auto* list = std::get_if<ConfigValue::List>(&value.data)) {
      std::vector<Recipe> parts;
      for (const ConfigValue& each : *list) {
        auto one = recipe(table, name, each, false);
        if (!one) return std::nullopt;
        parts.push_back(*std::move(one));
      }
      return Recipe{std::move(parts)};
    }
    const auto* map = std::get_if<ConfigValue::Map>(&value.data);
    if (map == nullptr) return Recipe{config_json(value).dump()};
    if (!named) {
      const auto read = law(table, value, name.c_str());
      if (!read) return std::nullopt;
      return Recipe{*read};
    }
    std::vector<NamedRecipe> members;
    for (const auto& [key, item] : *map) {
      auto one = recipe(table, key, item, false);
      if (!one) return std::nullopt;
      members.push_back({key, *std::move(one)});
    }
    return Recipe{std::move(members)};
  }

  void read_sample(ConfigTable& table) {
    const ConfigValue* sample = table.find("sample");
    if (sample == nullptr) return;
    const auto* map = std::get_if<ConfigValue::Map>(&sample->data);
    if (map == nullptr) return table.fail(*sample, "sample is not a table of settings");
    for (const auto& [name, value] : *map) {
      std::string member = name;
      std::ranges::replace(member, '_', '-');
      const auto found = std::ranges::find(kSettings, member, &SettingInfo::name);
      constexpr std::string_view kPlanned[] = {
          "name",       "output", "outputs",      "targets",     "camera",     "quat",
          "look-at",    "up",     "sun",          "pose",        "noise-seed", "frame-number",
          "seed",       "size",   "camera-frame", "camera-file", "fov",        "ifov",
          "intrinsics", "ortho",  "distortion"};
      if (found == std::end(kSettings) ||
          std::ranges::find(kPlanned, member) != std::end(kPlanned)) {
        std::vector<std::string_view> names;
        for (const SettingInfo& each : kSettings) names.push_back(each.name);
        const auto near = nearest_name(member, names);
        table.fail(
            value,
            found == std::end(kSettings)
                ? fmt::format("sample has no setting {}", in_quotes(name))
                : fmt::format("{} is drawn by [camera], [sun], [lens] and seed", in_quotes(name)),
            near && *near != member ? fmt::format("did you mean '{}'?", *near) : "");
        continue;
      }
      auto read = recipe(table, member, value, (found->forms & kFormMap) != 0);
      if (read) plan_.sample.push_back({member, *std::move(read)});
    }
  }

  void read_card(ConfigTable& table) {
    plan_.title = table.text("title").value_or("");
    plan_.limits = texts(table, "limits");
    const ConfigValue* licences = table.find("licences");
    if (licences == nullptr) return;
    const auto* map = std::get_if<ConfigValue::Map>(&licences->data);
    if (map == nullptr) return table.fail(*licences, "licences is not a table of texts by target");
    for (const auto& [name, value] : *map) {
      const auto* text = std::get_if<std::string>(&value.data);
      bool known = name == "set";
      for (const auto& target : plan_.targets) known = known || target.first == name;
      if (text == nullptr || !known)
        table.fail(value, fmt::format("licences has {}, expected texts of targets and of 'set'",
                                      in_quotes(name)));
      else
        plan_.licences.emplace_back(name, *text);
    }
  }

  std::filesystem::path folder_;
  DiagnosticLog& log_;
  DatasetPlan plan_;
  bool good_ = true;
};

}  // namespace

Result<DatasetPlan> read_dataset_plan(const std::filesystem::path& path, DiagnosticLog& log) {
  constexpr std::uint64_t kMostBytes = 16 << 20;
  auto text = read_file(path, kMostBytes, log);
  if (!text) return failed;
  SourceFile source;
  source.name = path.string();
  source.bytes = std::make_shared<const std::string>(*std::move(text));
  const auto bytes = source.bytes;
  const FileId file = log.sources().add(std::move(source));
  const auto root = parse_config(*bytes, ConfigFormat::toml, file, Code("E8017"), log);
  if (!root) return failed;
  return PlanReader(path.parent_path(), log).read(*root);
}

}  // namespace panwright::workspace
