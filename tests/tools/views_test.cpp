// Views and images made again, as a user sees them. What OpenGL draws is compared where there is
// some.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::views_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

class Views : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  const std::string ball_ = folder_.write(
      "ball.pxn",
      "<pangu_model ver=\"1\"><param name=\"r\" value=\"1m\"/><sphere radius=\"{r}\"/>"
      "</pangu_model>");
  const std::string box_ = folder_.write(
      "box.pxn",
      "<pangu_model ver=\"1\"><param name=\"r\" value=\"1m\"/><box size=\"{r}\"/></pangu_model>");
  Outcome render(const std::string& views, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"render", ball_, "--size", "32x24", "--engine", "reference",
                                 "--samples", "2", "--views", folder_.write("v.json", views)});
    return panwright(words);
  }
  std::string quoted(const std::string& name) const { return "\"" + (folder_ / name) + "\""; }
};

TEST_F(Views, SeveralOutputsAreFilesOfOneImage) {
  const Outcome both = render("[{\"camera\": [0, -5, 1], \"fov\": 40, \"outputs\": [" +
                              quoted("a.png") + ", " + quoted("a.npz") + "]}]");
  ASSERT_EQ(both.code, 0) << both.err;
  for (const char* name : {"png", "npz"}) {
    const Outcome one = panwright({"render", ball_, "--size", "32x24", "--engine", "reference",
                                   "--samples", "2", "--camera", "0 -5 1", "--fov", "40", "-o",
                                   folder_ / ("b." + std::string(name))});
    ASSERT_EQ(one.code, 0) << one.err;
    EXPECT_TRUE(contents(folder_ / ("a." + std::string(name))) ==
                contents(folder_ / ("b." + std::string(name))))
        << name;
  }
  // one line of both, and the summary
  EXPECT_THAT(both.out, HasSubstr("a.npz: 32 x 24, reference, "));
  EXPECT_THAT(both.out, HasSubstr("1 image in "));
  const Outcome quiet = render("[{\"output\": " + quoted("a.png") + "}]", {"-q"});
  EXPECT_EQ(quiet.out, "");
}

TEST_F(Views, HaveValuesOfParametersAndEnginesOfTheirOwn) {
  const Outcome many =
      render("[{\"ortho\": 6, \"output\": " + quoted("a.npy") +
             "}, {\"ortho\": 6, \"define\": {\"r\": \"2m\"}, \"output\": " + quoted("b.npy") +
             "}, {\"ortho\": 6, \"seed\": 1, \"output\": " + quoted("c.npy") + "}]");
  ASSERT_EQ(many.code, 0) << many.err;
  const Outcome one =
      panwright({"render", ball_, "--size", "32x24", "--engine", "reference", "--samples", "2",
                 "--ortho", "6", "-D", "r=2m", "-o", folder_ / "d.npy"});
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_TRUE(contents(folder_ / "b.npy") == contents(folder_ / "d.npy"));
  EXPECT_FALSE(contents(folder_ / "a.npy") == contents(folder_ / "b.npy"));
  EXPECT_FALSE(contents(folder_ / "a.npy") == contents(folder_ / "c.npy"));
}

TEST_F(Views, AreNamedWhereNothingIsInView) {
  const Outcome outcome = render("[{\"output\": " + quoted("a.npy") +
                                 "}, {\"name\": \"astray\", \"camera\": [0, 0, 50],"
                                 "\"look_at\": [0, 9, 90], \"fov\": 5, \"output\": " +
                                 quoted("b.npy") + "}]");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("view 1 ('astray'): "));
  EXPECT_THAT(outcome.err, HasSubstr("[W5006]"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("view 0")));
}

TEST_F(Views, AModelWithoutShapesIsSaidToShowNothing) {
  const std::string empty =
      folder_.write("empty.pxn", "<pangu_model ver=\"1\"><group name=\"a\"/></pangu_model>\n");
  const Outcome outcome = panwright({"render", empty, "-o", folder_ / "e.png", "--camera", "0 -9 0",
                                     "--size", "8x8", "--samples", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("[W5006]"));
}

// A mirror ball whose glint is narrower than any texel, and one that scatters: one warning for all
// images of the first, and none of the other.
TEST_F(Views, AreNamedWhereTheFluxOfAnImposterIsUncertain) {
  const std::string views =
      "[{\"output\": " + quoted("a.npy") + "}, {\"output\": " + quoted("b.npy") + "}]";
  for (const bool shiny : {false, true}) {
    const std::string file = folder_.write(
        "far.pxn", std::string("<pangu_model ver=\"1\"><material name=\"m\">") +
                       (shiny ? "<ggx>0.0005</ggx><conductor metal=\"Al\"/>" : "<lambert/>") +
                       "</material><sphere material=\"m\"/></pangu_model>");
    const Outcome done = panwright({"render", file, "--views", folder_.write("far.json", views),
                                    "--engine", "gl", "--camera", "0 -1km 0", "--look-at", "0 0 0",
                                    "--ifov", "0.5mrad", "--size", "16x16", "--sun", "1 -1 0.2"});
    if (done.err.find("[E5007]") != std::string::npos) return;  // without OpenGL
    ASSERT_EQ(done.code, 0) << done.err;
    if (shiny) {
      EXPECT_THAT(done.err,
                  HasSubstr("2 views, the worst view 0: the estimated flux error of an imposter"));
    } else {
      EXPECT_THAT(done.err, Not(HasSubstr("[W5008]")));
    }
  }
}

// Two targets, parameters, poses, irradiance: what is made again has the same bytes, record and
// all.
TEST_F(Views, AnImageIsMadeAgain) {
  const std::vector<std::string> engines[] = {
      {"--engine", "reference", "--samples", "2", "--seed", "9", "--psf", "0.7", "--limb-darkening",
       "0.6"},
      {"--engine", "gl", "--imposters", "20", "--flux-error", "1%", "--psf", "0.5"},
      {"--engine", "gl"},
      {"--engine", "gl", "--quality", "draft", "--tone", "photo"},
      {"--engine", "gl", "--shadows", "off"},
      {"--engine", "gl", "--shadows", "soft", "--sun-points", "9"},
      {"--engine", "gl", "--samples", "2", "--adaptive", "--shadow-side", "256", "--shadows",
       "hard", "--specular-filter", "off"}};
  for (const auto& engine : engines)
    for (const std::string format : {"png", "exr", "npz"})
      for (const bool ortho : {false, true}) {
        // how a format keeps the record does not depend on the engine
        if (format != "exr" && &engine != &engines[0]) continue;
        const std::string image = folder_ / ("a." + format);
        std::vector<std::string> words = {"render",
                                          "b=" + ball_,
                                          box_,
                                          "-o",
                                          image,
                                          "--size",
                                          "40x30",
                                          "-D",
                                          "r=0.7m",
                                          "--pose",
                                          "b=1.3 0.2 0 0.6 0 0.8 0",
                                          "--pose",
                                          "box=-1 0 0.1 1 0.02 0 0",
                                          "--sun-irradiance",
                                          "180,190.5,170",
                                          "--white",
                                          "150 0.25 3",
                                          "--ev",
                                          "0.3"};
        if (ortho) words.insert(words.end(), {"--ortho", "7.3"});
        words.insert(words.end(), engine.begin(), engine.end());
        const Outcome made = panwright(words);
        if (made.err.find("[E5007]") != std::string::npos) continue;  // without OpenGL
        ASSERT_EQ(made.code, 0) << made.err;
        const std::string again = folder_ / ("again." + format);
        const Outcome outcome = panwright({"render", "--again", image, "-o", again});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_THAT(outcome.err, Not(HasSubstr("W0208")));
        EXPECT_TRUE(contents(image) == contents(again)) << engine[1] << " " << format << ortho;
        // other options replace what is recorded
        const Outcome other =
            panwright({"render", "--again", image, "-o", again, "--ev", "2", "--sun", "1 0 0"});
        ASSERT_EQ(other.code, 0) << other.err;
        EXPECT_FALSE(contents(image) == contents(again));
      }
}

// The last sunlight through air is of the record: made again it is the same, without it another
// image.
TEST_F(Views, TheLastSunlightIsMadeAgain) {
  const std::string image = folder_ / "dusk.npz", again = folder_ / "again.npz";
  std::vector<std::string> words = {"render",    box_,
                                    "-o",        image,
                                    "--engine",  "reference",
                                    "--samples", "4",
                                    "--size",    "8x8",
                                    "--camera",  "9 0 1",
                                    "--look-at", "0 0 0",
                                    "--fov",     "10",
                                    "--planet",  "earth=0 0 -6778km radius=6371km air=sunset",
                                    "--sun",     "0.9399 0 -0.34145"};
  ASSERT_EQ(panwright(words).code, 0);
  const Outcome made = panwright({"render", "--again", image, "-o", again});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_TRUE(contents(image) == contents(again));
  const Outcome other = panwright(
      {"render", "--again", image, "-o", again, "--planet", "earth=0 0 -6778km radius=6371km"});
  ASSERT_EQ(other.code, 0) << other.err;
  EXPECT_FALSE(contents(image) == contents(again));
}

TEST_F(Views, AModelThatChangedIsSaidAndAnImageWithoutARecordToo) {
  const std::string image = folder_ / "a.png";
  const auto render = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--size", "16x12", "--engine", "reference", "--samples", "1"});
    return panwright(words);
  };
  ASSERT_EQ(render({"render", ball_, "-o", image}).code, 0);
  folder_.write("ball.pxn", "<pangu_model ver=\"1\"><sphere radius=\"0.5\"/></pangu_model>");
  const Outcome changed = panwright({"render", "--again", image, "-o", folder_ / "b.png"});
  EXPECT_EQ(changed.code, 0) << changed.err;
  EXPECT_THAT(changed.err, HasSubstr("[W0208]"));
  EXPECT_THAT(changed.err, HasSubstr("the model 'ball' has changed since"));
  ASSERT_EQ(render({"render", ball_, "-o", folder_ / "c.npy"}).code, 0);
  for (const std::string& bare : {folder_ / "c.npy", folder_.write("d.png", "\x89PNG\r\n\x1a\n"),
                                  folder_.write("e.exr", "x"), folder_.write("f.npz", "PK")}) {
    const Outcome outcome = panwright({"render", "--again", bare, "-o", folder_ / "g.png"});
    EXPECT_EQ(outcome.code, 2) << bare;
    EXPECT_THAT(outcome.err, HasSubstr("[E0207]")) << bare;
  }
}

}  // namespace
}  // namespace panwright::views_test
