// Values of settings, from texts and JSON and back.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <iterator>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "base/angle_text.h"
#include "base/text.h"
#include "image/image.h"
#include "workspace/internal/json_text.h"
#include "workspace/internal/setting_bounds.h"
#include "workspace/internal/setting_json.h"
#include "workspace/quantities.h"
#include "workspace/targets.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;

// Value as its author wrote it: a text, or JSON.
struct SettingValue {
  explicit SettingValue(std::string_view from) : text(from) {}
  explicit SettingValue(const json& from) {
    if (from.is_string())
      text = from.get_ref<const std::string&>();
    else
      other = &from;
  }
  std::optional<std::string_view> text;
  const json* other = nullptr;
};

std::string number_text(const json& value) {
  if (value.is_number_unsigned()) return fmt::format("{}", value.get<std::uint64_t>());
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  return value.is_number() ? format_double(value.get<double>()) : value.dump();
}

std::string value_text(const SettingValue& value, const char* between = " ") {
  if (value.text) return std::string(*value.text);
  if (!value.other->is_array()) return number_text(*value.other);
  std::string out;
  for (const json& item : *value.other)
    out += (out.empty() ? "" : between) +
           (item.is_string() ? item.get<std::string>() : number_text(item));
  return out;
}

std::optional<double> number_in(std::string_view text, SettingUnit unit) {
  switch (unit) {
    case SettingUnit::angle:
      return parse_angle(text);
    case SettingUnit::length:
      return parse_length(text);
    case SettingUnit::share:
      return parse_share(text);
    default:
      return parse_double(text);
  }
}

double bare_unit(SettingUnit unit) { return unit == SettingUnit::angle ? kDegree : 1; }

// Numbers in SI units; fewer or more than `count` are none.
template <std::size_t count>
std::optional<std::array<double, count>> numbers_of(const SettingValue& value, SettingUnit unit) {
  std::array<double, count> out{};
  if (value.text) {
    const auto words = words_of(*value.text);
    if (words.size() != count) return std::nullopt;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = number_in(words[i], unit);
      if (!number) return std::nullopt;
      out[i] = *number;
    }
    return out;
  }
  const bool list = value.other->is_array();
  if ((list ? value.other->size() : 1) != count) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    const json& item = list ? (*value.other)[i] : *value.other;
    if (!item.is_number()) return std::nullopt;
    out[i] = item.get<double>() * bare_unit(unit);
  }
  return out;
}

// ---- read(): each returns the accepted values; empty: it has been read

std::string read(const SettingInfo&, const SettingValue& value, std::string& out) {
  out = *value.text;
  return {};
}

std::string read(const SettingInfo& info, const SettingValue& value, bool& out) {
  const bool yes = value.text ? *value.text == "true" : value.other->get<bool>();
  if (value.text && !yes && *value.text != "false") return std::string(info.accepts);
  out = yes;
  return {};
}

std::string read(const SettingInfo& info, const SettingValue& value, double& out) {
  const auto number = numbers_of<1>(value, info.unit);
  if (!number || !in_bounds(info, (*number)[0])) return std::string(info.accepts);
  out = (*number)[0];
  return {};
}

template <std::unsigned_integral Integer>
std::string read(const SettingInfo& info, const SettingValue& value, Integer& out) {
  std::optional<std::uint64_t> number;
  if (value.text && info.unit == SettingUnit::bytes) {
    number = parse_bytes(*value.text);
  } else if (!value.text && value.other->is_number_unsigned()) {
    number = value.other->get<std::uint64_t>();
  } else {
    std::uint64_t whole = 0;
    const auto words = words_of(value.text.value_or(std::string_view()));
    const std::string_view word = words.size() == 1 ? words[0] : std::string_view();
    const char* end = word.data() + word.size();
    constexpr double kExact = 0x1p53;
    if (const auto [stop, error] = std::from_chars(word.data(), end, whole);
        !word.empty() && error == std::errc() && stop == end)
      number = whole;
    else if (const auto real = numbers_of<1>(value, SettingUnit::none);
             real && (*real)[0] >= 0 && (*real)[0] <= kExact &&
             std::floor((*real)[0]) == (*real)[0])
      number = static_cast<std::uint64_t>((*real)[0]);
  }
  const bool fits = number && *number <= std::numeric_limits<Integer>::max();
  if (!fits || !in_bounds(info, static_cast<Integer>(*number))) return std::string(info.accepts);
  out = static_cast<Integer>(*number);
  return {};
}

template <class Choice>
requires std::is_enum_v<Choice> std::string read(const SettingInfo& info, const SettingValue& value,
                                                 Choice& out) {
  const auto found = std::ranges::find(info.words, value.text.value_or(std::string_view()));
  if (found == info.words.end()) return std::string(info.accepts);
  out = static_cast<Choice>(found - info.words.begin());
  return {};
}

template <class Word, class Number>
std::string read(const SettingInfo& info, const SettingValue& value, NumberOr<Word, Number>& out) {
  Word word{};
  if (read(info, value, word).empty()) return out = word, std::string();
  Number number{};
  std::string expected = read(info, value, number);
  if (expected.empty()) out = number;
  return expected;
}

std::string read(const SettingInfo& info, const SettingValue& value, ImageSize& out) {
  const auto size = image_size(value_text(value, "x"));
  if (!size) return std::string(info.accepts);
  out = *size;
  return {};
}

// Bands may be one number.
std::string read(const SettingInfo& info, const SettingValue& value, Vec3& out) {
  const auto one = (info.forms & kFormNumber) != 0 ? numbers_of<1>(value, info.unit) : std::nullopt;
  const auto three = numbers_of<3>(value, info.unit);
  if (!one && !three) return std::string(info.accepts);
  out = one ? Vec3((*one)[0]) : Vec3((*three)[0], (*three)[1], (*three)[2]);
  return expected_instead(info, out);
}

std::string read(const SettingInfo& info, const SettingValue& value, Vec4& out) {
  const auto numbers = numbers_of<4>(value, info.unit);
  if (!numbers) return std::string(info.accepts);
  out = Vec4((*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]);
  return expected_instead(info, out);
}

std::string read(const SettingInfo& info, const SettingValue& value, Quat& out) {
  const auto numbers = numbers_of<4>(value, info.unit);
  if (!numbers) return std::string(info.accepts);
  out = Quat((*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]);
  const auto unit = unit_quaternion(out);
  if (unit) out = *unit;
  return expected_instead(info, out);
}

std::string read_layers(const SettingInfo& info, std::span<const std::string_view> names,
                        std::string& wrong, std::uint32_t& out) {
  std::uint32_t layers = 0;
  for (const std::string_view name : names) {
    const auto* found = std::ranges::find(image::kLayerNames, name);
    if (found == std::end(image::kLayerNames)) {
      const auto near = nearest_name(name, image::kLayerNames);
      wrong = name;
      return fmt::format("names of layers: {}{}", fmt::join(image::kLayerNames, ", "),
                         near ? fmt::format("; did you mean '{}'?", *near) : "");
    }
    layers |= 1u << (found - std::begin(image::kLayerNames));
  }
  if (layers == 0) return std::string(info.accepts);
  out = layers;
  return {};
}

// Three lengths, then four numbers.
std::string read_pose(const SettingValue& value, world::Pose& out) {
  const std::string expected =
      "seven numbers: a position x y z, with or without units, and a quaternion w x y z";
  std::array<double, 7> numbers{};
  if (value.text) {
    const auto words = words_of(*value.text);
    if (words.size() != numbers.size()) return expected;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto number = number_in(words[i], i < 3 ? SettingUnit::length : SettingUnit::none);
      if (!number) return expected;
      numbers[i] = *number;
    }
  } else if (const auto all = numbers_of<7>(value, SettingUnit::none)) {
    numbers = *all;
  } else {
    return expected;
  }
  const auto unit = unit_quaternion({numbers[3], numbers[4], numbers[5], numbers[6]});
  if (!unit) return "a unit quaternion w x y z";
  out = {{numbers[0], numbers[1], numbers[2]}, *unit};
  return {};
}

// ---- one setting

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;

class SettingReader {
 public:
  SettingReader(SettingId id, DiagnosticLog& log) : id_(id), info_(info_of(id)), log_(log) {}

  template <class T>
  requires(!is_list<T>) bool assign(const SettingValue& value, Setting<T>& out) {
    T read_value{};
    const std::string expected = read(info_, value, read_value);
    if (!expected.empty())
      return fail(info_.name, value_text(value, id_ == SettingId::size ? "x" : " "), expected);
    if (info_.unit == SettingUnit::angle) warn_of_radians(value_text(value));
    out = std::move(read_value);
    return true;
  }

  bool layers(const SettingValue& value, Setting<std::uint32_t>& out) {
    std::vector<std::string_view> names;
    if (value.text)
      names = words_of(*value.text);
    else
      for (const json& item : *value.other) names.push_back(item.get_ref<const std::string&>());
    std::uint32_t mask = 0;
    std::string wrong = value_text(value);
    const std::string expected = read_layers(info_, names, wrong, mask);
    if (!expected.empty()) return fail(info_.name, wrong, expected);
    out = mask;
    return true;
  }

  bool add_pose(std::string target, const SettingValue& value,
                Setting<std::vector<PoseSetting>>& out) {
    PoseSetting pose{std::move(target), {}};
    const std::string expected = read_pose(value, pose.pose);
    if (!expected.empty())
      return fail(pose.target.empty() ? "pose" : "pose " + pose.target, value_text(value),
                  expected);
    return add(std::move(pose), out);
  }

  template <class T>
  bool add(T value, Setting<std::vector<T>>& out) {
    std::vector<T> all = *out;
    all.push_back(std::move(value));
    out = std::move(all);
    return true;
  }

 private:
  bool fail(std::string_view name, const std::string& value, std::string_view expected) {
    // "20m" where an angle belongs, "20deg" where metres do
    const char* kind = parse_double(value)   ? ""
                       : parse_length(value) ? ", a length"
                       : parse_angle(value)  ? ", an angle"
                                             : "";
    log_.report(Code("E0201"), {},
                fmt::format("--{} is {}{}, expected {}", name, in_quotes(value), kind, expected));
    return false;
  }
  void warn_of_radians(const std::string& text) {
    if (const auto warning = warning_of_radians(text))
      log_.report(Code("W1214"), {}, fmt::format("{}: {}", info_.name, warning->message),
                  warning->hint);
  }

  SettingId id_;
  const SettingInfo& info_;
  DiagnosticLog& log_;
};

bool has_form(const json& value, unsigned forms) {
  if (value.is_string()) return (forms & kFormText) != 0;
  if (value.is_boolean()) return (forms & kFormFlag) != 0;
  if (value.is_number()) return (forms & kFormNumber) != 0;
  if (value.is_object()) return (forms & kFormMap) != 0;
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [&](const json& item) {
           return item.is_number() ? (forms & kFormNumbers) != 0
                                   : item.is_string() && (forms & kFormTexts) != 0;
         });
}

std::string degrees_text(double radians) {
  for (int digits = 9; digits < 18; ++digits) {
    const std::string text = fmt::format("{:.{}g}", radians / kDegree, digits);
    if (parse_angle(text) == radians) return text;
  }
  return format_double(radians) + "rad";
}

}  // namespace

bool read_setting(SettingId id, std::string_view text, Settings& settings, DiagnosticLog& log) {
  SettingReader reader(id, log);
  const std::size_t sign = std::min(text.find('='), text.size());
  const std::string name(text.substr(0, sign)),
      rest(sign < text.size() ? text.substr(sign + 1) : std::string_view());
  if (id == SettingId::layers) return reader.layers(SettingValue(text), settings.layers);
  if (id == SettingId::pose)
    return sign == text.size()
               ? reader.add_pose({}, SettingValue(text), settings.pose)
               : reader.add_pose(name, SettingValue(std::string_view(rest)), settings.pose);
  if (id == SettingId::joint) return reader.add(joint_text(text), settings.joint);
  if (id == SettingId::define) return reader.add({name, rest}, settings.define);
  if (id == SettingId::planet)
    return sign < text.size() ? reader.add({name, rest}, settings.planet)
                              : reader.add({{}, std::string(text)}, settings.planet);
  return visit_setting(
      id,
      [&](SettingId, auto& member) {
        if constexpr (requires { reader.add(std::string(text), member); })
          return reader.add(std::string(text), member);
        else if constexpr (requires { reader.assign(SettingValue(text), member); })
          return reader.assign(SettingValue(text), member);
        else
          return false;
      },
      settings);
}

bool read_setting(SettingId id, const json& value, Settings& settings, DiagnosticLog& log) {
  SettingReader reader(id, log);
  if (id == SettingId::layers) return reader.layers(SettingValue(value), settings.layers);
  if (id == SettingId::pose && !value.is_object())
    return reader.add_pose({}, SettingValue(value), settings.pose);
  if (value.is_object()) {
    bool good = true;
    for (const auto& [name, item] : value.items()) {
      if (id == SettingId::pose)
        good = reader.add_pose(name, SettingValue(item), settings.pose) && good;
      else if (id == SettingId::joint)
        reader.add({name, value_text(SettingValue(item))}, settings.joint);
      else if (id == SettingId::define)
        reader.add({name, value_text(SettingValue(item))}, settings.define);
      else if (id == SettingId::planet)
        reader.add({name, value_text(SettingValue(item))}, settings.planet);
      else
        reader.add(name + "=" + item.get<std::string>(), settings.targets);
    }
    return good;
  }
  return visit_setting(
      id,
      [&](SettingId, auto& member) {
        if constexpr (requires { reader.add(std::string(), member); }) {
          for (const json& item : value.is_array() ? value : json::array({value}))
            reader.add(item.get<std::string>(), member);
          return true;
        } else if constexpr (requires { reader.assign(SettingValue(value), member); }) {
          return reader.assign(SettingValue(value), member);
        } else {
          return false;
        }
      },
      settings);
}

std::string wrong_type(SettingId id, const json& value) {
  const SettingInfo& info = info_of(id);
  const auto words = [&](const std::string& part, const json& found) {
    return fmt::format("{} has the wrong type, expected {}, found {}", part, info.expect,
                       json_type(found));
  };
  if (value.is_array() && info.forms == kFormTexts)
    for (const json& item : value)
      if (!item.is_string()) return words(fmt::format(" holds {} and", json_type(item)), value);
  if (!has_form(value, info.forms)) return words("", value);
  if (value.is_object())
    for (const auto& [name, item] : value.items())
      if (!has_form(item, info.of)) return words(" of " + in_quotes(name), item);
  return {};
}

namespace {

template <class T>
nlohmann::ordered_json as_json(const SettingInfo& info, const T& value) {
  if constexpr (std::is_same_v<T, ImageSize>)
    return fmt::format("{}x{}", value.width, value.height);
  else if constexpr (std::is_same_v<T, Vec3>)
    return {value.x, value.y, value.z};
  else if constexpr (std::is_same_v<T, Vec4>)
    return {value.x, value.y, value.z, value.w};
  else if constexpr (std::is_same_v<T, Quat>)
    return {value.w, value.x, value.y, value.z};
  else if constexpr (std::is_enum_v<T>)
    return info.words[static_cast<std::size_t>(value)];
  else if constexpr (requires { value.word; })
    return value.number ? as_json(info, *value.number) : as_json(info, value.word);
  else if constexpr (std::is_same_v<T, double>)
    return info.unit == SettingUnit::angle ? nlohmann::ordered_json(degrees_text(value))
                                           : nlohmann::ordered_json(value);
  else if constexpr (std::is_constructible_v<nlohmann::ordered_json, T>)
    return value;
  else
    return {};
}

}  // namespace

nlohmann::ordered_json setting_json(SettingId id, const Settings& settings) {
  if (id == SettingId::layers) {
    auto names = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < std::size(image::kLayerNames); ++i)
      if ((*settings.layers >> i & 1u) != 0) names.push_back(std::string(image::kLayerNames[i]));
    return names;
  }
  if (id == SettingId::planet) {
    auto bodies = nlohmann::ordered_json::object();
    for (const auto& [name, text] : *settings.planet) bodies[name] = text;
    return bodies;
  }
  return visit_setting(
      id, [](SettingId each, const auto& member) { return as_json(info_of(each), *member); },
      settings);
}

std::string setting_text(SettingId id, const Settings& settings) {
  const json value = setting_json(id, settings);
  return value.is_null() ? std::string() : value_text(SettingValue(value));
}

std::vector<std::string> setting_texts(SettingId id, const Settings& settings) {
  std::vector<std::string> out;
  if (!has_value(id, settings)) return out;
  if (id == SettingId::joint)
    for (const JointText& joint : *settings.joint) out.push_back(joint.joint + "=" + joint.value);
  else if (id == SettingId::planet)
    for (const auto& [name, text] : *settings.planet) out.push_back(name + "=" + text);
  else if (id == SettingId::pose)
    for (const auto& [target, pose] : *settings.pose)
      out.push_back(fmt::format("{}{}{} {} {} {} {} {} {}", target, target.empty() ? "" : "=",
                                pose.translation.x, pose.translation.y, pose.translation.z,
                                pose.rotation.w, pose.rotation.x, pose.rotation.y,
                                pose.rotation.z));
  else if (id == SettingId::lamp)
    out = *settings.lamp;
  else
    out.push_back(setting_text(id, settings));
  return out;
}

}  // namespace panwright::workspace
