#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/process.h"
#include "workspace/drawer.h"
#include "workspace/views.h"

namespace panwright::workspace::views_file_test {
namespace {

Result<std::vector<View>> read(const std::string& text, DiagnosticLog& log,
                               const Settings& defaults = {}) {
  const support::TemporaryFolder folder;
  return read_views(folder.write("v.json", text), defaults, log);
}

TEST(ReadViews, TakesTextNumbersAndLists) {
  DiagnosticLog log;
  const auto views =
      read(R"([{"camera": [0, -5, 1.5], "fov": 20, "sun": "1 0 0", "output": "a.png"},
                              {"look_at": "0 0 1", "output": "b.npy"}])",
           log);
  ASSERT_TRUE(views) << to_text(log);
  ASSERT_EQ(views->size(), 2u);
  EXPECT_EQ(*(*views)[0].settings.camera, Vec3(0, -5, 1.5));
  EXPECT_EQ(*(*views)[0].settings.fov, 20 * kDegree);
  EXPECT_EQ(*(*views)[1].settings.look_at, Vec3(0, 0, 1));
}

TEST(ReadViews, DefaultsFillInWithoutContradicting) {
  Settings defaults;
  defaults.fov = 20 * kDegree;
  defaults.look_at = Vec3(1, 1, 1);
  defaults.size = ImageSize{10, 10};
  defaults.camera = Vec3(5, 5, 5);
  DiagnosticLog log;
  const auto views = read(R"([{"ortho": 3, "quat": [1, 0, 0, 0], "output": "a.png"},
                              {"camera_frame": "f", "output": "b.png"}])",
                          log, defaults);
  ASSERT_TRUE(views);
  const Settings &first = (*views)[0].settings, &second = (*views)[1].settings;
  EXPECT_FALSE(first.fov);
  EXPECT_FALSE(first.look_at);
  EXPECT_EQ(*first.size, (ImageSize{10, 10}));
  EXPECT_EQ(*first.camera, Vec3(5, 5, 5));
  EXPECT_FALSE(second.camera);
  EXPECT_FALSE(second.look_at);
  EXPECT_EQ(*second.fov, 20 * kDegree);
}

std::vector<std::string> poses_of(const View& view) {
  return setting_texts(SettingId::pose, view.settings);
}

TEST(ReadViews, PosesAreTextsListsOrObjectsOfTargets) {
  Settings defaults;
  const Quat none(1, 0, 0, 0);
  defaults.pose = {{"a", {{9, 0, 0}, none}}, {"b", {{8, 0, 0}, none}}};
  DiagnosticLog log;
  const auto views = read(R"([{"pose": [1, 2, 3, 1, 0, 0, 0], "output": "a.png"},
                              {"pose": "1 2 3km 0 1 0 0", "output": "b.png"},
                              {"pose": {"b": "0 0 1 1 0 0 0", "c": [2, 0, 0, 0, 0, 0, 1]},
                               "output": "c.png"},
                              {"output": "d.png"}])",
                          log, defaults);
  ASSERT_TRUE(views) << to_text(log);
  using testing::ElementsAre;
  const std::string a = "a=9 0 0 1 0 0 0", b = "b=8 0 0 1 0 0 0";
  // the view's own come last, so that they are what counts
  EXPECT_THAT(poses_of((*views)[0]), ElementsAre(a, b, "1 2 3 1 0 0 0"));
  EXPECT_THAT(poses_of((*views)[1]), ElementsAre(a, b, "1 2 3000 0 1 0 0"));
  EXPECT_THAT(poses_of((*views)[2]), ElementsAre(a, b, "b=0 0 1 1 0 0 0", "c=2 0 0 0 0 0 1"));
  EXPECT_THAT(poses_of((*views)[3]), ElementsAre(a, b));
}

TEST(ReadViews, SaysWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "invalid JSON"},
      {"[{\"output\": \"a.png\"},\n {]", "line 2"},
      {"{}", "expected a list of"},
      {"[]", "expected a list of"},
      {"[3]", "view 0: expected an object of options, found a number"},
      {"[{\"fov\": 3}]", "view 0: no output"},
      {"[{\"fof\": 3, \"output\": \"a\"}]", "unknown option"},
      {"[{\"fov\": {}, \"output\": \"a\"}]",
       "view 0: 'fov' has the wrong type, expected a number of degrees, or text with a unit, found "
       "an object"},
      {R"([{"output": "a"}, {"fov": 3, "fov": 4, "output": "b"}])", "view 1: 'fov' is given twice"},
      {R"([{"pose": {"client": "1", "b": "2", "client": "3"}, "output": "a"}])",
       "view 0: 'client' is given twice"},
      {R"([{"output": "a"}, {"output": "b"}, {"output": "c/../a"}])",
       "view 0 and view 2 have the same output, 'c/../a'"},
      {"[{\"pose\": 1e, \"output\": \"a\"}]", "invalid JSON"},
      {"[{\"pose\": [], \"output\": \"a\"}]", "'pose' has the wrong type, expected seven numbers"},
      {"[{\"pose\": {\"client\": {}}, \"output\": \"a\"}]",
       "'pose' of 'client' has the wrong type"},
      {"[{\"poses\": {}, \"output\": \"a\"}]", "unknown option"},
      {"[{\"sun\": [1, \"x\"], \"output\": \"a\"}]", "'sun' has the wrong type, expected three"},
      {R"([{"output": "a"}, {"name": "far", "adaptive": 1, "output": "b"}])",
       "view 1 ('far'): 'adaptive' has the wrong type, expected true or false, found a number"},
      {R"([{"output": "a", "outputs": ["b"]}])", "view 0: expected output or outputs, not both"},
      {R"([{"outputs": ["a", "./a"]}])", "view 0 has the output './a' twice"},
      {R"([{"outputs": []}])", "'outputs' has the wrong type"},
      {R"([{"output": "a", "define": ["x=1"]}])",
       "'define' has the wrong type, expected an object"},
      {R"([{"output": "a", "look-at": "1 0 0", "look_at": "1 0 0"}])", "are one option"},
      {"[{\"output\": \"a\"},\n {\"fov\" 3}]", "invalid JSON at line 2, column 9: unexpected '3'"},
      {"[{\"output\": \"a\",}]", "invalid JSON at line 1, column 17: unexpected '}'"},
      {"[{\"output\": \"a\"}", "invalid JSON at line 1, column 17: the text ends"},
      {"[{\"fov\": 1e999}]", "invalid JSON at line 1, column 14: a number that is too large"},
      {"[[[[[[[[[[[[[[[[[[[[[[[[", "nested more than 16 deep"},
  };
  for (const auto& [text, words] : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(read(text, log)) << text;
    ASSERT_FALSE(log.entries().empty());
    // values are reported too, each where its view stands: here that "a" names no format
    EXPECT_TRUE(std::any_of(log.entries().begin(), log.entries().end(),
                            [part = words](const Diagnostic& entry) {
                              return entry.code == Code("E0203") &&
                                     entry.message.find(part) != std::string::npos;
                            }))
        << words << "\n"
        << to_text(log);
  }
  DiagnosticLog log;
  (void)read("[{\"fof\": 3, \"output\": \"a\"}]", log);
  EXPECT_EQ(log.entries()[0].hint, "did you mean 'fov'?");
  DiagnosticLog missing;
  EXPECT_FALSE(read_views("/nonexistent.json", {}, missing));
  EXPECT_TRUE(missing.contains(Code("E0101")));
}

// A quality fills in what is not given, and nothing else.
TEST(ReadViews, QualitiesArePresets) {
  DiagnosticLog log;
  const auto read_one = [&](const std::string& options) {
    const auto views = read(R"([{"output": "a.png", )" + options + "}]", log);
    return views ? Result<DrawOptions>(draw_options((*views)[0].settings, {}))
                 : Result<DrawOptions>(failed);
  };
  const auto draft = read_one(R"("quality": "draft")");
  ASSERT_TRUE(draft) << to_text(log);
  EXPECT_EQ(draft->gl.samples, 4u);
  EXPECT_TRUE(draft->gl.adaptive);
  EXPECT_EQ(draft->gl.shadows, preview::Shadows::hard);
  EXPECT_EQ(draft->gl.flux_error, 0.01);
  const auto soft = read_one(R"("quality": "draft", "pixel-error": "10%", "shadows": "soft")");
  ASSERT_TRUE(soft) << to_text(log);
  EXPECT_EQ(soft->gl.samples, 0u);
  EXPECT_FALSE(soft->gl.adaptive);
  EXPECT_EQ(soft->gl.pixel_error, 0.1);
  EXPECT_EQ(soft->gl.shadows, preview::Shadows::soft);
  const auto exact = read_one(R"("quality": "exact")");
  ASSERT_TRUE(exact) << to_text(log);
  EXPECT_EQ(exact->gl.samples, 0u);
  EXPECT_EQ(exact->gl.pixel_error, 0.01);
  EXPECT_EQ(exact->gl.sun_points, 64u);
  EXPECT_EQ(exact->gl.flux_error, 1e-4);
  const auto hard = read_one(R"("quality": "exact", "shadows": "hard", "samples": 8)");
  ASSERT_TRUE(hard) << to_text(log);
  EXPECT_EQ(hard->gl.samples, 8u);
  EXPECT_EQ(hard->gl.shadows, preview::Shadows::hard);
  EXPECT_FALSE(read_one(R"("quality": "best")"));
  EXPECT_FALSE(read_one(R"("quality": "draft", "engine": "reference")"));
}

TEST(ReadViews, TakesEveryOption) {
  DiagnosticLog log;
  const auto views = read(R"([{"name": "far", "outputs": ["a.png", "a.npz"], "size": [640, 480],
      "define": {"span": "2m", "n": 3}, "targets": {"b": "b.pan"}, "samples": 4, "adaptive": true,
      "shadow-side": 512, "flat": false, "limb-darkening": 0.6, "max-image-memory": "2GB",
      "imposters": 32, "flux-error": "0.1%", "psf": 0.5},
     {"output": "b.exr", "engine": "reference", "seed": 18446744073709551615, "psf": 0,
      "no_sun_disc": true, "until-error": 0.01, "max-samples": 64, "bounces": 0},
     {"output": "c.exr", "imposters": "off", "shadows": "soft", "sun-points": 128,
      "specular-filter": "off"},
     {"output": "d.exr", "imposters": "always", "shadows": "off"},
     {"output": "e.exr", "engine": "reference", "psf": "0.7"}])",
                          log);
  ASSERT_TRUE(views) << to_text(log);
  const View& far = (*views)[0];
  EXPECT_EQ(far.label, "view 0 ('far')");
  EXPECT_THAT(*far.settings.outputs, testing::ElementsAre("a.png", "a.npz"));
  EXPECT_EQ(*far.settings.size, (ImageSize{640, 480}));
  using Pair = std::pair<std::string, std::string>;
  EXPECT_THAT(*far.settings.define,
              testing::UnorderedElementsAre(Pair("span", "2m"), Pair("n", "3")));
  EXPECT_THAT(*far.settings.targets, testing::ElementsAre("b=b.pan"));
  const auto gl = draw_options(far.settings, {});
  EXPECT_EQ(gl.samples, 4u);
  EXPECT_TRUE(gl.gl.adaptive);
  EXPECT_FALSE(gl.gl.flat);
  EXPECT_EQ(gl.gl.shadow_side, 512u);
  EXPECT_EQ(gl.gl.max_bytes, 2ull << 30);
  const auto traced = draw_options((*views)[1].settings, {});
  EXPECT_EQ(traced.engine, Engine::reference);
  EXPECT_EQ(traced.reference.seed, ~std::uint64_t{0});
  EXPECT_EQ(traced.reference.bounces, 0u);
  EXPECT_EQ(traced.reference.max_samples, 64u);
  EXPECT_EQ(traced.reference.until_error, 0.01);
  EXPECT_FALSE(traced.reference.sun_disc);
  EXPECT_EQ(gl.gl.imposters, preview::Imposters::automatic);
  EXPECT_EQ(gl.gl.imposter_pixels, 32);
  EXPECT_EQ(gl.gl.flux_error, 1e-3);
  EXPECT_EQ(gl.gl.psf_sigma, 0.5);
  const auto none = draw_options((*views)[2].settings, {});
  const auto all = draw_options((*views)[3].settings, {});
  const auto blurred = draw_options((*views)[4].settings, {});
  EXPECT_EQ(none.gl.imposters, preview::Imposters::off);
  EXPECT_EQ(all.gl.imposters, preview::Imposters::always);
  EXPECT_EQ(gl.gl.shadows, preview::Shadows::automatic);
  EXPECT_EQ(none.gl.shadows, preview::Shadows::soft);
  EXPECT_EQ(none.gl.sun_points, 128u);
  EXPECT_FALSE(none.gl.specular_filter);
  EXPECT_TRUE(all.gl.specular_filter);
  EXPECT_EQ(all.gl.shadow_side, 0u);
  EXPECT_EQ(blurred.reference.psf_sigma, 0.7);
}

TEST(ReadViews, NamesTheViewOfAWrongValue) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("samples": 65)", "view 1 ('x'): samples is '65', expected a whole number from 1 to 64"},
      {R"("engine": "gpu")", "view 1 ('x'): engine is 'gpu', expected gl or reference"},
      {R"("bounces": 1)", "view 1 ('x'): bounces requires engine reference"},
      {R"("pixel-error": 1, "samples": "auto")", "view 1 ('x'): pixel-error is '1', expected"},
      {R"("engine": "reference", "bounces": 1.5)", "bounces is '1.5', expected a whole number"},
      {R"("shadow-side": 512, "shadows": "off")", "cannot be combined"},
      {R"("shadows": "off", "sun-points": 8)", "sun-points needs shadows auto or soft"},
      {R"("shadows": "blurred")", "shadows is 'blurred', expected auto, off, hard or soft"},
      {R"("shadows": "hard", "sun-points": 8)", "sun-points needs shadows auto or soft"},
      {R"("sun-points": 1)", "sun-points is '1', expected a whole number from 2 to 256"},
      {R"("imposters": "some")", "expected auto, off, always, or a number of pixels"},
      {R"("imposters": 9, "engine": "reference")", "imposters requires engine gl"},
      {R"("specular-filter": "on")", "specular-filter is 'on', expected auto or off"},
      {R"("specular-filter": "off", "engine": "reference")", "specular-filter requires engine gl"},
      {R"("flux-error": 2)", "flux-error is '2', expected a share"},
      {R"("psf": -1)", "psf is '-1', expected a number from 0 to 64"},
      {R"("psf": 65, "engine": "reference")", "psf is '65', expected a number from 0 to 64"},
      {R"("max-image-memory": "much")", "expected a number of bytes"},
  };
  for (const auto& [members, words] : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(read(
        std::string(R"([{"output": "a.png"}, {"name": "x", "output": "b.png", )") + members + "}]",
        log))
        << members;
    ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
    EXPECT_EQ(log.entries()[0].code, Code("E0203"));
    EXPECT_THAT(log.entries()[0].message, testing::HasSubstr(words));
  }
}

TEST(ReadViews, AViewReplacesTheEngineOfTheDefaults) {
  Settings defaults;
  defaults.engine = Settings::Engine::reference;
  defaults.bounces = 2;
  defaults.seed = 3;
  defaults.define = {{"a", "1"}, {"b", "2"}};
  DiagnosticLog log;
  const auto views = read(R"([{"engine": "gl", "define": {"a": 5}, "output": "a.png"},
                              {"samples": 3, "output": "b.png"}])",
                          log, defaults);
  ASSERT_TRUE(views);
  EXPECT_FALSE((*views)[0].settings.bounces);
  EXPECT_FALSE((*views)[0].settings.seed);
  using Pair = std::pair<std::string, std::string>;
  EXPECT_THAT(*(*views)[0].settings.define,
              testing::UnorderedElementsAre(Pair("a", "5"), Pair("b", "2")));
  EXPECT_EQ(*(*views)[1].settings.bounces, 2u);
  EXPECT_EQ(*(*views)[1].settings.seed, 3u);
}

TEST(ReadViews, AViewReplacesShadowsThatAreOff) {
  Settings defaults;
  defaults.shadows = Settings::Shadows::off;
  DiagnosticLog log;
  const auto views = read(R"([{"shadow-side": 64, "output": "a.png"},
                              {"sun-points": 3, "output": "b.png"}, {"output": "c.png"}])",
                          log, defaults);
  ASSERT_TRUE(views) << to_text(log);
  EXPECT_FALSE((*views)[0].settings.shadows);
  EXPECT_FALSE((*views)[1].settings.shadows);
  EXPECT_EQ(*(*views)[2].settings.shadows, Settings::Shadows::off);
}

// Every mutation is accepted, or refused with exit code 2 and a message of our own.
TEST(ReadViews, MutationsAreRefusedInOurOwnWords) {
  const std::string valid[] = {
      R"([{"name": "far", "camera": [0, -5, 1.5], "fov": 20, "sun": "1 0 0", "output": "a.png"},
 {"look_at": "0 0 1", "outputs": ["b.npy", "b.npz"], "samples": 4, "adaptive": true}])",
      R"([{"engine": "reference", "bounces": 1, "seed": 7, "psf": "0.7",
  "pose": {"m": [0, 0, 5, 1, 0, 0, 0]}, "define": {"span": "2.4m"}, "output": "c.exr"}])",
  };
  const std::string alphabet = "[]{}\",:' \\\n\t0e-+.x\x01\x7f\xc3\xff/";
  std::uint64_t state = 1;
  // Knuth's MMIX generator; the upper bits are the better ones
  const auto random = [&](std::size_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::size_t>((state >> 33) % below);
  };
  std::size_t refused = 0;
  std::size_t syntax = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = valid[i % 2];
    for (std::size_t edits = 1 + random(3); edits > 0; --edits) {
      const std::size_t at = random(text.size());
      const std::string piece = random(2) == 0 ? std::string(1, alphabet[random(alphabet.size())])
                                               : text.substr(random(text.size()), 1 + random(6));
      switch (random(4)) {
        case 0:
          text.insert(at, piece);
          break;
        case 1:
          text.replace(at, 1, piece);
          break;
        case 2:
          text.erase(at, 1 + random(8));
          break;
        default:
          text.resize(at + 1);
          break;
      }
    }
    DiagnosticLog log;
    const auto views = parse_views(text, "v.json", {}, log);
    if (!log.has_errors()) {
      EXPECT_TRUE(views) << text;
      continue;
    }
    ++refused;
    EXPECT_EQ(exit_code(log), 2) << text;
    const std::string said = to_text(log);
    EXPECT_THAT(said, testing::Not(testing::HasSubstr("json."))) << text;
    EXPECT_THAT(said, testing::Not(testing::HasSubstr("exception"))) << text;
    for (const Diagnostic& each : log.entries()) {
      const bool json = each.message.starts_with("invalid JSON at line ");
      syntax += json;
      EXPECT_TRUE(!json || log.entries().size() == 1) << said;
      EXPECT_TRUE(json || each.message.find("view ") == 0 ||
                  each.message.starts_with("expected a list of"))
          << each.message;
    }
  }
  // measured: 973 refused, 910 of the messages about syntax
  EXPECT_GT(refused, 800u);
  EXPECT_GT(syntax, 600u);
  RecordProperty("refused", static_cast<int>(refused));
  RecordProperty("syntax", static_cast<int>(syntax));
}

// JSON Lines are the same as a list of them.
TEST(ReadViews, OneALine) {
  const auto parsed = [](const std::string& text, DiagnosticLog& log) {
    return parse_views(text, "v.jsonl", {}, log);
  };
  DiagnosticLog log;
  const auto views = parsed(
      "{\"fov\": 20, \"output\": \"a.png\"}\n\n{\"name\": \"x\", \"output\": \"b.npy\"}\r\n", log);
  ASSERT_TRUE(views) << to_text(log);
  ASSERT_EQ(views->size(), 2u);
  EXPECT_EQ(*(*views)[0].settings.fov, 20 * kDegree);
  EXPECT_EQ((*views)[1].label, "view 1 ('x')");
  const std::pair<const char*, const char*> cases[] = {
      {"", "expected a view or more, one a line"},
      {"\n \n", "expected a view or more, one a line"},
      {"{\"output\": \"a.png\"}\n\n{\"output\"}\n", "invalid JSON at line 3, column 10"},
      {"[{\"output\": \"a.png\"}]\n", "view 0: expected an object of options, found a list"},
      {"{\"output\": \"a.png\"}\n{\"fov\": 3, \"fov\": 4, \"output\": \"b.png\"}",
       "view 1: 'fov' is given twice"},
  };
  for (const auto& [text, words] : cases) {
    DiagnosticLog problems;
    EXPECT_FALSE(parsed(text, problems)) << text;
    EXPECT_THAT(to_text(problems), testing::HasSubstr(words));
  }
  DiagnosticLog list;
  EXPECT_FALSE(parse_views("{\"output\": \"a.png\"}\n{\"output\": \"b.png\"}", "v.json", {}, list));
  EXPECT_THAT(to_text(list), testing::HasSubstr(".json"));
}

}  // namespace
}  // namespace panwright::workspace::views_file_test
