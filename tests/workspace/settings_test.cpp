// Settings of every kind through each of their doors.
#include "workspace/settings.h"

#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "workspace/drawer.h"
#include "workspace/run.h"

namespace panwright::workspace::settings_test {
namespace {

using Given = std::vector<std::pair<SettingId, std::string>>;

Settings settings_of(const Given& given) {
  Settings settings;
  DiagnosticLog log;
  for (const auto& [id, value] : given)
    EXPECT_TRUE(read_setting(id, value, settings, log)) << to_text(log);
  return settings;
}

// "--a requires --b" as a view says it.
std::string without_dashes(std::string text) {
  for (std::size_t at = text.find("--"); at != text.npos; at = text.find("--")) text.erase(at, 2);
  return text;
}

std::string only_message(const DiagnosticLog& log) {
  EXPECT_EQ(log.entries().size(), 1u) << to_text(log);
  return log.entries().empty() ? std::string() : log.entries()[0].message;
}

const std::pair<Given, std::string> kContradictions[] = {
    {{{SettingId::fov, "20"}, {SettingId::ortho, "3"}},
     "--fov, --ifov, --intrinsics and --ortho cannot be combined"},
    {{{SettingId::quat, "1 0 0 0"}, {SettingId::look_at, "0 0 1"}},
     "--quat cannot be combined with --look-at"},
    {{{SettingId::camera_frame, "eye"}, {SettingId::camera, "0 0 1"}},
     "--camera-frame cannot be combined with --camera, --quat or --look-at"},
    {{{SettingId::samples, "4"}, {SettingId::pixel_error, "1%"}},
     "--pixel-error requires --samples auto"},
    {{{SettingId::adaptive, "true"}}, "--adaptive requires --samples N; auto is always adaptive"},
    {{{SettingId::shadow_side, "64"}, {SettingId::shadows, "off"}},
     "--shadow-side cannot be combined with --shadows off"},
    {{{SettingId::sun_points, "8"}, {SettingId::shadows, "hard"}},
     "--sun-points needs --shadows auto or soft"},
    {{{SettingId::bounces, "1"}}, "--bounces requires --engine reference"},
    {{{SettingId::engine, "reference"}, {SettingId::quality, "draft"}},
     "--quality requires --engine gl"},
    {{{SettingId::engine, "reference"}, {SettingId::samples, "auto"}},
     "--samples is 'auto', expected a whole number from 1 to 64"},
};

TEST(Settings, ContradictionsHaveTheSameWordsThroughEachDoor) {
  const support::TemporaryFolder folder;
  const TargetFile ball{"ball",
                        folder.write("ball.pxn", "<pangu_model ver=\"1\"><sphere/></pangu_model>")};
  DiagnosticLog opening;
  const auto world = open_world({&ball, 1}, {}, opening);
  ASSERT_TRUE(world) << to_text(opening);
  for (const auto& [given, says] : kContradictions) {
    Settings settings = settings_of(given);
    settings.outputs = {folder / "a.png"};
    DiagnosticLog command;
    EXPECT_FALSE(check(View(settings), command));
    EXPECT_EQ(only_message(command), says);
    DiagnosticLog window;
    EXPECT_FALSE(FrameMaker(*world).frame(settings, window));
    EXPECT_EQ(only_message(window), says);
    Frame frame;
    frame.settings = settings;
    frame.outputs = {folder / "a.png"};
    DiagnosticLog library;
    EXPECT_FALSE(run_frames(*world, {&frame, 1}, {}, library));
    EXPECT_EQ(only_message(library), says);
    std::string members = "\"output\": \"a.png\"";
    for (const auto& [id, value] : given)
      members += ", \"" + std::string(info_of(id).name) +
                 "\": " + (id == SettingId::adaptive ? value : "\"" + value + "\"");
    DiagnosticLog json;
    EXPECT_FALSE(parse_views("[{" + members + "}]", "v.json", {}, json));
    EXPECT_EQ(only_message(json), "view 0: " + without_dashes(says));
  }
}

TEST(Settings, ValuesOfALibraryAreHeldToTheSameBounds) {
  Settings settings;
  settings.samples = 65;
  settings.psf = -1;
  settings.quat = Quat(2, 0, 0, 0);
  settings.sun = Vec3(0);
  settings.size = {0, 4};
  DiagnosticLog log;
  EXPECT_FALSE(check(settings, log));
  EXPECT_EQ(log.entries().size(), 5u) << to_text(log);
  EXPECT_NE(to_text(log).find("--samples is '65', expected a whole number from 1 to 64, or auto"),
            std::string::npos)
      << to_text(log);
}

// What is given stands before what a preset sets, and that before the default.
TEST(Settings, GivenBeatsPresetBeatsDefault) {
  Settings settings;
  EXPECT_EQ(*with_presets(settings).flux_error, 5e-4);
  settings.quality = Settings::Quality::draft;
  const Settings draft = with_presets(settings);
  EXPECT_EQ(*draft.flux_error, 0.01);
  EXPECT_FALSE(draft.flux_error.given());
  EXPECT_EQ(*draft.samples->number, 4u);
  settings.flux_error = 0.02;
  settings.samples = 2;
  EXPECT_EQ(*with_presets(settings).flux_error, 0.02);
  EXPECT_EQ(*with_presets(settings).samples->number, 2u);
  EXPECT_TRUE(*with_presets(settings).adaptive);
  Settings traced;
  traced.engine = Settings::Engine::reference;
  EXPECT_EQ(*with_presets(traced).samples->number, 8u);
}

TEST(Settings, DefaultsAreThoseOfTheEngines) {
  Settings one;
  one.samples = 1;
  const DrawOptions draw = draw_options(one, preview::ContextKind::automatic);
  const preview::RenderOptions gl;
  EXPECT_EQ(draw.gl.samples, gl.samples);
  EXPECT_EQ(draw.gl.sun_points, gl.sun_points);
  EXPECT_EQ(draw.gl.flux_error, gl.flux_error);
  EXPECT_EQ(draw.gl.pixel_error, gl.pixel_error);
  EXPECT_EQ(draw.gl.psf_sigma, gl.psf_sigma);
  EXPECT_EQ(draw.gl.max_bytes, gl.max_bytes);
  EXPECT_EQ(draw.gl.shadow_side, gl.shadow_side);
  EXPECT_EQ(draw.gl.levels, gl.levels);
  EXPECT_EQ(draw.gl.specular_filter, gl.specular_filter);
  one.engine = Settings::Engine::reference;
  const DrawOptions traced = draw_options(one, preview::ContextKind::automatic);
  const preview::ReferenceOptions reference;
  EXPECT_EQ(traced.reference.bounces, reference.bounces);
  EXPECT_EQ(traced.reference.seed, reference.seed);
  EXPECT_EQ(traced.reference.max_samples, reference.max_samples);
  EXPECT_EQ(traced.reference.until_error, reference.until_error);
  EXPECT_EQ(traced.reference.sun_disc, reference.sun_disc);
}

// A given option of one engine waits for the views of that engine.
TEST(Settings, DefaultsOfAnotherEngineAreKeptForIt) {
  Settings defaults;
  defaults.bounces = 2;
  defaults.shadows = Settings::Shadows::hard;
  Settings traced;
  traced.engine = Settings::Engine::reference;
  EXPECT_EQ(*with_defaults(traced, defaults).bounces, 2u);
  EXPECT_FALSE(with_defaults(traced, defaults).shadows);
}

// Printed values read back to the same bits.
TEST(Settings, TextsReadBack) {
  const Given values = {{SettingId::fov, "0.1rad"},       {SettingId::fov, "1e-11rad"},
                        {SettingId::fov, "20"},           {SettingId::camera, "0.1 1e-300 3km"},
                        {SettingId::pixel_error, "0.7%"}, {SettingId::seed, "18446744073709551615"},
                        {SettingId::size, "640x480"},     {SettingId::imposters, "always"},
                        {SettingId::levels, "2cm"},       {SettingId::layers, "depth,node_id"},
                        {SettingId::white, "3"},          {SettingId::quat, "0.6 0 0.8 0"},
                        {SettingId::ev, "auto"},          {SettingId::max_image_memory, "1.5GB"},
                        {SettingId::adaptive, "true"},    {SettingId::pose, "a=1 2 3 0.6 0 0.8 0"}};
  for (const auto& given : values) {
    const Settings settings = settings_of({given});
    const auto texts = setting_texts(given.first, settings);
    ASSERT_EQ(texts.size(), 1u) << given.second;
    EXPECT_EQ(settings_of({{given.first, texts[0]}}), settings) << given.second << texts[0];
  }
}

}  // namespace
}  // namespace panwright::workspace::settings_test
