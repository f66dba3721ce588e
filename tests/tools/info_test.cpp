// What `panwright info` says about budgets, keypoints, decals and maps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "compiler/tolerance.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::tools::info_test {
namespace {

using json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class Info : public testing::Test {
 protected:
  std::string text(const pan::Contents& contents, const std::vector<std::string>& more = {}) {
    return run(contents, more);
  }
  json object(const pan::Contents& contents) { return json::parse(run(contents, {"--json"})); }

 private:
  std::string run(const pan::Contents& contents, const std::vector<std::string>& more) {
    const std::string path = folder_ / "m.pan";
    DiagnosticLog log;
    EXPECT_TRUE(pan::write(contents, path, log)) << to_text(log);
    std::vector<std::string> words = {PANWRIGHT_BIN_DIR "/panwright", "info", path};
    words.insert(words.end(), more.begin(), more.end());
    return support::run(words).out;
  }
  support::TemporaryFolder folder_;
};

TEST_F(Info, SaysHowLargeAModelIs) {
  const support::TemporaryFolder folder;
  const auto model = [&](const std::string& root, const std::string& name) {
    return folder.write(name, "<pangu_model ver=\"1\"" + root +
                                  "><param name=\"W\" value=\"100\"/><box size=\"{W} 226.3 "
                                  "{W*3 + 40.5}\"/></pangu_model>");
  };
  const auto panwright = [](std::vector<std::string> words) {
    words.insert(words.begin(), PANWRIGHT_BIN_DIR "/panwright");
    return support::run(words);
  };
  const std::string meant = model(" units=\"mm\"", "meant.pxn"), meters = model("", "metres.pxn");
  const json read = json::parse(panwright({"info", meant, "--json"}).out);
  for (int k = 0; k < 3; ++k)
    // residual of single precision: 1.2e-8
    EXPECT_NEAR(read["size"]["extents"][k].get<double>(), (std::array{0.1, 0.2263, 0.3405}[k]),
                2e-8);
  EXPECT_EQ(read["size"]["largest"], read["size"]["extents"][2]);
  EXPECT_EQ(read["size"]["words"], "100 x 226 x 340 mm (about a shoe box)");
  EXPECT_THAT(panwright({"info", meant}).out,
              HasSubstr("size      100 x 226 x 340 mm (about a shoe box)\n"));
  const auto checked = panwright({"check", meant});
  EXPECT_EQ(checked.out, meant + ": ok, 100 x 226 x 340 mm (about a shoe box)\n");
  EXPECT_EQ(checked.err, "");
  EXPECT_EQ(json::parse(panwright({"check", meant, "--json"}).out)["files"][0]["size"],
            "100 x 226 x 340 mm (about a shoe box)");
  // what everybody meets who takes the wrong unit
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"info", meters}, {"check", meters}, {"compile", meters}}) {
    const auto outcome = panwright(words);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(
        outcome.err,
        HasSubstr(
            "the model is 340 m large, more than any spacecraft; read as millimetres it is 340 mm"))
        << words[0];
    EXPECT_THAT(outcome.err, HasSubstr("[W2022]"));
  }
  // an import whose unit is assumed has a warning for the same cause, and another file none of it
  folder.write("wall.obj", "v 0 0 0\nv 900 0 0\nv 0 900 0\nv 0 0 900\nf 1 2 3\nf 1 4 2\n");
  const std::string imported = folder.write(
      "imported.pxn", "<pangu_model ver=\"1\"><import file=\"wall.obj\"/><box/></pangu_model>");
  const std::string both = panwright({"check", imported}).err;
  EXPECT_THAT(both, HasSubstr("[W6006]"));
  EXPECT_THAT(both, Not(HasSubstr("[W2022]")));
  EXPECT_THAT(panwright({"check", imported, meters}).err, HasSubstr("[W2022]"));
  const std::string empty = folder.write("empty.pxn", "<pangu_model ver=\"1\"/>");
  EXPECT_EQ(json::parse(panwright({"info", empty, "--json"}).out)["size"], nullptr);
  EXPECT_EQ(panwright({"check", empty}).out, empty + ": ok\n");
}

TEST_F(Info, SaysWhatWasAskedAndWhatCameOfIt) {
  pan::Contents contents = support::small_contents();
  contents.budget = pan::layout::Budget{0, 50, 2e-4, 0.5, 0.02, 0.25, 1e-3, {}};
  contents.meshes[0].error = 2e-4;
  contents.mesh_tolerances = {
      {2.5e-4, static_cast<std::uint32_t>(pan::layout::ToleranceReason::flux), 0}, {}};
  const std::string out = text(contents);
  EXPECT_THAT(out, HasSubstr("budget    nearest 50 m, 0.2 mrad a pixel: a pixel covers 10 mm\n"));
  EXPECT_THAT(out, HasSubstr("silhouettes to 0.5 px, gives 5 mm\n"));
  EXPECT_THAT(out, HasSubstr("photocentres to 0.25 px, gives "));
  EXPECT_THAT(out, HasSubstr("flux to 2 %, gives "));
  EXPECT_THAT(out, HasSubstr("decided by as given for 1 mesh, flux for 1 mesh; finest 1 mm in the "
                             "world\n"));
  EXPECT_THAT(out, HasSubstr("error 200 µm of 250 µm allowed (80 %, flux)\n"));
  EXPECT_THAT(out, HasSubstr("error 0 (as given)\n"));

  const json read = object(contents);
  EXPECT_EQ(read["budget"]["tolerance"], nullptr);
  EXPECT_EQ(read["budget"]["nearest"], 50);
  EXPECT_EQ(read["budget"]["gives"]["pixels"], 0.5 * 2e-4 * 50);
  EXPECT_EQ(read["budget"]["gives"]["centroid"], 0.25 * 2e-4 * 50 / compiler::kCentroidFactor);
  EXPECT_EQ(read["budget"]["meshes_decided_by"], json({{"explicit_counts", 1}, {"flux", 1}}));
  EXPECT_EQ(read["meshes"][0]["budget"]["reason"], "flux");
  EXPECT_EQ(read["meshes"][0]["budget"]["ratio"], 2e-4 / 2.5e-4);
  EXPECT_EQ(read["meshes"][1]["budget"]["tolerance"], nullptr);
}

TEST_F(Info, WithoutABudgetThereIsNone) {
  pan::Contents contents = support::small_contents();
  contents.budget.reset();
  contents.mesh_tolerances.clear();
  EXPECT_THAT(text(contents), Not(HasSubstr("budget")));
  EXPECT_THAT(text(contents), HasSubstr("error 250 mm in its own frame\n"));
  EXPECT_EQ(object(contents)["budget"], nullptr);
  EXPECT_EQ(object(contents)["meshes"][0]["budget"], nullptr);
}

TEST_F(Info, ShowsTheHeaviestMeshes) {
  pan::Contents contents = support::small_contents();
  contents.mesh_tolerances.clear();
  contents.budget.reset();
  const auto lines = [](const std::string& out) {
    std::vector<std::string> found;
    for (std::size_t at = 0, end; (end = out.find('\n', at)) != std::string::npos; at = end + 1)
      if (out.compare(at, 10, "mesh      ") == 0)
        found.push_back(out.substr(at + 10, out.find(':', at) - at - 10));
    return found;
  };
  const std::string first = contents.meshes[0].name, second = contents.meshes[1].name;
  const bool swaps = contents.meshes[1].triangle_count() > contents.meshes[0].triangle_count();
  const std::vector<std::string> by_weight = {swaps ? second : first, swaps ? first : second};
  EXPECT_EQ(lines(text(contents)), by_weight);
  // lighter ones, of which some are not shown
  const std::size_t lighter = swaps ? 0 : 1;
  const std::string error = "largest error 250 mm (";
  EXPECT_THAT(text(contents), HasSubstr(error));
  for (const char* name : {"c", "d", "e", "f", "g"}) {
    contents.meshes.push_back(contents.meshes[lighter]);
    contents.meshes.back().name = name;
  }
  const std::string out = text(contents);
  EXPECT_EQ(lines(out), (std::vector<std::string>{by_weight[0], by_weight[1], "c", "d", "e"}));
  EXPECT_THAT(out, HasSubstr("meshes    7: "));
  EXPECT_THAT(out, HasSubstr("          and 2 meshes lighter; --meshes lists all\n"));
  EXPECT_EQ(lines(text(contents, {"--meshes"})),
            (std::vector<std::string>{first, second, "c", "d", "e", "f", "g"}));
  EXPECT_EQ(object(contents)["meshes"].size(), 7u);
}

TEST_F(Info, LevelsAreInMetresAsPlaced) {
  pan::Contents contents = support::small_contents();
  contents.decals.clear();
  contents.levels = {{0.25, 0.003, 0, 1, 1, 0}};
  // its node is scaled by 2 2 -2
  EXPECT_THAT(text(contents), HasSubstr("within 6 mm from 0.5 m a pixel\n"));
  const json read = object(contents);
  EXPECT_NEAR(read["levels"][0]["error"].get<double>(), 0.006, 1e-9);
  EXPECT_EQ(read["levels"][0]["detail"], 0.5);
}

TEST_F(Info, CountsAndListsKeypointsAndDecals) {
  pan::Contents contents = support::small_contents();
  contents.materials[1].maps.albedo = contents.materials[1].maps.cutout = 0;
  const std::string out = text(contents);
  EXPECT_THAT(out, HasSubstr("with      1 frame, 2 keypoints, 2 decals\n"));
  // by hand, as in tests/pan: node 1 turns x to -0.28 x - 0.96 z, scaled by 2 2 -2, moved by 1 2 3
  EXPECT_THAT(out, HasSubstr("keypoint  corner at -1.48 4 1.64\n"));
  EXPECT_THAT(out, HasSubstr("decal     flag, skin.png: 0.5 x 0.25 m on craft/body/[2]\n"));
  EXPECT_THAT(out, HasSubstr("material  paint: oren-nayar + none, maps: albedo, cutout\n"));
  const json read = object(contents);
  EXPECT_EQ(read["keypoints"][1]["name"], "tip");
  EXPECT_EQ(read["keypoints"][1]["position"], json({0, 0, 0.1}));
  EXPECT_EQ(read["decals"][0]["origin"], json({100.5, 0.5, 7}));
  EXPECT_EQ(read["decals"][1]["depth"], 1.5);
  EXPECT_EQ(read["materials"][1]["maps"]["cutout"], 0);
  EXPECT_EQ(read["materials"][1]["maps"]["normal"], nullptr);
}

}  // namespace
}  // namespace panwright::tools::info_test
