#include "workspace/scene_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>

#include "base/text.h"
#include "scenario/time.h"
#include "workspace/orbit_text.h"
#include "workspace/sky_settings.h"

namespace panwright::workspace {
namespace {

constexpr SettingId kOfScenes[] = {SettingId::sun,
                                   SettingId::sun_distance,
                                   SettingId::sun_irradiance,
                                   SettingId::limb_darkening,
                                   SettingId::planet,
                                   SettingId::sky,
                                   SettingId::stars,
                                   SettingId::star_catalogue,
                                   SettingId::date,
                                   SettingId::orbit};

std::optional<SettingId> scene_setting(std::string_view name) {
  const auto at = std::ranges::find(kOfScenes, name, [](SettingId id) { return info_of(id).name; });
  return at == std::end(kOfScenes) ? std::nullopt : std::optional(*at);
}

// Messages of settings, as those of a scene in a file.
void forward_scene(const DiagnosticLog& from, const std::string& file, const std::string& place,
                   DiagnosticLog& log) {
  for (const Diagnostic& each : from.entries())
    log.report_file(Code("E0203"), file, place + each.message, each.hint);
}

// The elements are those at the scene's date; frames of other dates move on from there.
void complete_orbit(Settings& settings) {
  scenario::Orbit orbit;
  if (!settings.orbit || !settings.date || !read_orbit(*settings.orbit, orbit).empty() ||
      orbit.at_centre)
    return;
  std::string problem;
  const auto epoch = scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem);
  if (epoch) settings.orbit = completed_orbit(*settings.orbit, *epoch, "j2000");
}

}  // namespace

const Settings* SceneReader::read(const world::World& world, DiagnosticLog& log) {
  const auto has_scene = [](const world::Instance& target) {
    return !target.model()->scene().empty();
  };
  const auto instances = world.instances();
  const auto first = std::ranges::find_if(instances, has_scene);
  const world::ModelPtr model = first == instances.end() ? nullptr : first->model();
  if (model == model_ && sound_) return &settings_;
  model_ = model;
  target_ = model ? first->name() : std::string();
  settings_ = {};
  sound_ = true;
  if (!model) return &settings_;
  const std::filesystem::path folder = std::filesystem::path(model->name()).parent_path();
  DiagnosticLog apart = log.apart();
  for (std::size_t i = 0; i < model->scene().size(); ++i) {
    const std::string_view name = model->scene_setting_name(i);
    const std::string value(model->string(model->scene()[i].value));
    if (const auto id = scene_setting(name))
      read_setting(*id, std::string_view(value), settings_, apart);
    else
      log.report_file(Code("N1314"), model->name(),
                      fmt::format("the scene's {} is not known to this version and has no effect",
                                  in_quotes(name)));
  }
  if (!folder.empty()) place_sky_files(folder, settings_);  // files of a scene are beside the model
  if (apart.errors() == 0 && check(settings_, apart)) (void)check_sky(settings_, apart);
  sound_ = apart.errors() == 0;
  if (sound_) complete_orbit(settings_);
  forward_scene(apart, model->name(), "the scene: ", log);
  for (auto other = first + 1; other != instances.end(); ++other)
    if (has_scene(*other) && other->model() != model)
      log.report_file(Code("N1314"), other->model()->name(),
                      fmt::format("the scene of {} is not used; that of {} holds",
                                  in_quotes(other->name()), in_quotes(target_)));
  return sound_ ? &settings_ : nullptr;
}

bool check_scene(const scene::Scene& scene, DiagnosticLog& log) {
  bool good = true;
  for (const scene::Setting& setting : scene.settings) {
    DiagnosticLog apart = log.apart();
    Settings settings;
    if (const auto id = scene_setting(setting.name))
      if (read_setting(*id, std::string_view(setting.value), settings, apart))
        (void)check_sky(settings, apart);
    if (apart.errors() == 0) continue;
    good = false;
    forward_scene(apart, setting.source.file, fmt::format("line {}: ", setting.source.line), log);
  }
  return good;
}

}  // namespace panwright::workspace
