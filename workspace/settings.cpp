// Defaults, presets and rules of settings.
#include "workspace/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "base/text.h"
#include "workspace/internal/setting_bounds.h"

namespace panwright::workspace {

namespace {

// Settings that are given, or as well those of presets. A flag that is false is neither.
SettingSet set_of(const Settings& settings, bool with_presets) {
  SettingSet out;
  visit_settings(
      [&](SettingId id, const auto& member) {
        bool set = with_presets ? bool(member) : member.given();
        if constexpr (std::is_same_v<decltype(*member), const bool&>) set = set && *member;
        if (set) out.insert(id);
      },
      settings);
  return out;
}

void reset(SettingId id, Settings& settings) {
  static const Settings standard;
  visit_setting(
      id, [](SettingId, auto& member, const auto& to) { member = to; }, settings, standard);
}

void reset(const SettingSet& those, Settings& settings) {
  for (std::size_t i = 0; i < std::size(kSettings); ++i)
    if (const auto id = static_cast<SettingId>(i); those.has(id)) reset(id, settings);
}

bool takes(const Settings& settings, SettingId id) {
  const EngineSet engine = info_of(id).engine;
  return engine == EngineSet::both ||
         static_cast<int>(engine) == static_cast<int>(*settings.engine);
}

bool fails(const Requirement& rule, const Settings& settings) {
  return rule.applies(settings) && !rule.holds(settings);
}

// Those of lists stand beside the defaults, and count as they come later.
template <class T>
void add_defaults(Setting<std::vector<T>>& own, const Setting<std::vector<T>>& defaults) {
  if (!defaults) return;
  std::vector<T> all = *defaults;
  all.insert(all.end(), own->begin(), own->end());
  own = std::move(all);
}

void add_defaults(Setting<std::vector<std::pair<std::string, std::string>>>& own,
                  const Setting<std::vector<std::pair<std::string, std::string>>>& defaults) {
  auto all = *own;
  for (const auto& define : *defaults)
    if (std::none_of(all.begin(), all.end(),
                     [&](const auto& each) { return each.first == define.first; }))
      all.push_back(define);
  if (!all.empty()) own = std::move(all);
}

template <class T>
void add_defaults(Setting<T>& own, const Setting<T>& defaults) {
  if (!own && defaults) own = defaults;
}
void add_defaults(Setting<std::vector<std::string>>& own,
                  const Setting<std::vector<std::string>>& defaults) {
  if (!own) own = defaults;
}

}  // namespace

Settings with_defaults(Settings own, const Settings& defaults) {
  const SettingSet given = set_of(own, false);
  Settings base = defaults;
  for (const Exclusion& rule : kExclusions) {
    if (given.meets(rule.first)) reset(rule.others.without(given), base);
    if (given.meets(rule.others)) reset(rule.first.without(given), base);
  }
  if (own.engine) {
    SettingSet other;
    for (std::size_t i = 0; i < std::size(kSettings); ++i)
      if (const auto id = static_cast<SettingId>(i); !takes(own, id)) other.insert(id);
    reset(other, base);
  }
  const SettingSet of_base = set_of(base, true);
  visit_settings([](SettingId, auto& member, const auto& from) { add_defaults(member, from); }, own,
                 base);
  for (const Requirement& rule : kRequirements) {
    if (!fails(rule, own)) continue;
    const bool setting = given.has(rule.setting), other = given.has(rule.other);
    if (!setting && other) reset(rule.setting, own);
    // an engine does not yield
    if (setting && !other && rule.other != SettingId::engine && of_base.has(rule.other))
      reset(rule.other, own);
  }
  return own;
}

Settings with_presets(Settings settings) {
  const SettingSet given = set_of(settings, false);
  for (const Preset& preset : kPresets) {
    if (!preset.applies(settings)) continue;
    bool free = !visit_setting(
        preset.setting, [](SettingId, const auto& member) { return member.given(); }, settings);
    for (const Exclusion& rule : kExclusions)
      if (const SettingSet both = rule.first | rule.others; both.has(preset.setting))
        free = free && !given.meets(both);
    if (!free) continue;
    preset.set(settings);
    for (const Requirement& rule : kRequirements)
      if ((rule.setting == preset.setting || rule.other == preset.setting) && fails(rule, settings))
        free = false;
    if (!free) reset(preset.setting, settings);
  }
  return settings;
}

bool has_value(SettingId id, const Settings& settings) {
  return visit_setting(
      id, [](SettingId, const auto& member) { return bool(member); }, settings);
}

bool is_changed(SettingId id, const Settings& settings) {
  static const Settings standard;
  return visit_setting(
      id,
      [](SettingId, const auto& member, const auto& from) { return member && *member != *from; },
      settings, standard);
}

bool is_effective(SettingId id, const Settings& settings) {
  if (!takes(settings, id)) return false;
  for (const Requirement& rule : kRequirements)
    if (rule.setting == id && rule.any && !rule.holds(settings)) return false;
  return std::none_of(std::begin(kIdle), std::end(kIdle), [&](const Idle& each) {
    return each.setting == id && each.applies(settings);
  });
}

std::optional<Quat> unit_quaternion(const Quat& q) {
  const double length = glm::length(q);
  if (!(std::abs(length - 1) <= 1e-3)) return std::nullopt;
  // what is unit to a few roundings stays: the record of an image is read back to the same bits
  return std::abs(length - 1) <= 1e-15 ? q : q / length;
}

bool check(const Settings& settings, DiagnosticLog& log) {
  bool good = true;
  const auto fail = [&](std::string_view message) {
    log.report(Code("E0201"), {}, std::string(message));
    good = false;
  };
  const SettingSet set = set_of(settings, true);
  visit_settings(
      [&](SettingId id, const auto& member) {
        if (!member) return;
        const std::string expected = expected_instead(info_of(id), *member);
        if (!expected.empty())
          fail(fmt::format("--{} is {}, expected {}", info_of(id).name,
                           in_quotes(setting_text(id, settings)), expected));
      },
      settings);
  for (const Exclusion& rule : kExclusions)
    if (!rule.says.empty() && set.meets(rule.first) && set.meets(rule.others) &&
        (set & (rule.first | rule.others)).count() > 1)
      fail(rule.says);
  bool stray = false;
  for (std::size_t i = 0; i < std::size(kSettings); ++i) {
    const auto id = static_cast<SettingId>(i);
    if (!set.has(id) || takes(settings, id)) continue;
    stray = true;
    fail(fmt::format("--{} requires --engine {}", info_of(id).name,
                     *settings.engine == Settings::Engine::gl ? "reference" : "gl"));
  }
  if (!stray)
    for (const Requirement& rule : kRequirements)
      if (fails(rule, settings)) fail(rule.says);
  return good;
}

}  // namespace panwright::workspace
