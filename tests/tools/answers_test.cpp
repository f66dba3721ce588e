// Answers to what beginners type: each names the cause and what to write.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::answers_test {
namespace {

using support::Outcome;
using support::panwright;
using testing::HasSubstr;
using testing::Not;

class Answers : public testing::Test {
 protected:
  std::string model(const std::string& body) {
    return folder_.write("m.pxn", "<pangu_model ver=\"1\">\n" + body + "\n</pangu_model>\n");
  }
  std::string check(const std::string& body) { return panwright({"check", model(body)}).err; }
  // Of a box, by the reference: without OpenGL.
  Outcome render(std::vector<std::string> words) {
    std::vector<std::string> all{"render",    model("<box name='bus' size='1'/>"),
                                 "-o",        folder_ / "a.npz",
                                 "--engine",  "reference",
                                 "--samples", "3",
                                 "--size",    "8"};
    all.insert(all.end(), words.begin(), words.end());
    return panwright(all);
  }
  support::TemporaryFolder folder_;
};

TEST_F(Answers, PresetsAreFoundByTheirWords) {
  EXPECT_THAT(check("<material name='m' preset='gold_kapton'/>"),
              HasSubstr("did you mean 'mli_gold_kapton'?"));
  EXPECT_THAT(panwright({"material", "kapton_tape"}).err, HasSubstr("'mli_kapton_tape'"));
}

TEST_F(Answers, LightsHaveTheirNamesAndCamerasArePartsOfNoModel) {
  for (const char* name : {"light", "Light", "SpotLight"})
    EXPECT_THAT(check("<" + std::string(name) + "/><box/>"),
                HasSubstr("a lamp on a node is <lamp>, the Sun that of <scene>"));
  EXPECT_THAT(check("<sun/><box/>"), HasSubstr("'sun' belongs in <scene>"));
  EXPECT_THAT(check("<camera/><box/>"), HasSubstr("takes --camera \"X Y Z\", and --camera-frame"));
}

TEST_F(Answers, CommasOfATextAreOneError) {
  const std::pair<const char*, const char*> texts[] = {
      {"<box size='1,2,3'/>", "commas in size of <box>, expected blanks between numbers"},
      {"<box size='1, 2, 3'/>", "write 1 2 3"},
      {"<box size='1m,2m,3m'/>", "write 1m 2m 3m"},
      {"<box size='1,5'/>", "write 1.5"},
      {"<box size='1' translate='0,5 1,5 0'/>", "write 0.5 1.5 0"},
      {"<material name='m'><diffuse>0.1,0.2,0.3</diffuse></material>", "write 0.1 0.2 0.3"},
      {"<polygons><vertices>0,0,0 1,0,0 0,1,0</vertices></polygons>", "write 0 0 0 1 0 0 0 1 0"}};
  for (const auto& [text, expected] : texts) {
    const std::string said = check(text);
    EXPECT_THAT(said, HasSubstr(expected)) << text;
    EXPECT_EQ(said.find("E1201"), said.rfind("E1201")) << said;
  }
  EXPECT_EQ(check("<box size='{max(1, 2)}'/>"), "");
}

TEST_F(Answers, RadiansWhereDegreesAreExpected) {
  EXPECT_THAT(check("<box size='1' rotate='1.5708 0 0'/>"),
              HasSubstr("1.5708 is read as degrees, and would be 90 degrees as radians [W1214]"));
  for (const char* good : {"rotate='1.5708rad 0 0'", "rotate='1.5708deg 0 0'", "rotate='1.5 0 90'",
                           "translate='1.5708 0 0'", "rotate='{pi/2*1rad} 0 0'"})
    EXPECT_EQ(check("<box size='1' " + std::string(good) + "/>"), "") << good;
  const std::string radians = folder_.write(
      "r.pxn",
      "<pangu_model ver='1' angle='rad'><box size='1' rotate='1.5708 0 0'/></pangu_model>");
  EXPECT_EQ(panwright({"check", radians}).err, "");
  EXPECT_THAT(render({"--camera", "0 -5 0", "--fov", "0.7854"}).err,
              HasSubstr("fov: 0.7854 is read as degrees, and would be 45 degrees as radians"));
  EXPECT_THAT(render({"--camera", "0 -5 0", "--fov", "45"}).err, Not(HasSubstr("W1214")));
}

TEST_F(Answers, ACameraInsideABody) {
  const Outcome inside = render({"--camera", "0.1 0.2 0.3"});
  EXPECT_THAT(inside.err, HasSubstr("the camera is inside 'm/root/bus'"));
  EXPECT_THAT(inside.err, HasSubstr("[W5016]"));
  EXPECT_THAT(render({"--camera", "0.1 -0.51 0.3"}).err, Not(HasSubstr("W5016")));
  EXPECT_THAT(render({"--camera", "0.1 -0.3 0.3", "--ortho", "3"}).err, Not(HasSubstr("W5016")));
}

TEST_F(Answers, PosesAndSizesTakeUnitsAndBlanks) {
  const Outcome far = render({"--pose", "0, 0 -2km 1 0 0 0", "--camera", "0 0 3", "--look-at",
                              "0 0 -2km", "--up", "0 1 0"});
  EXPECT_EQ(far.code, 0) << far.err;
  EXPECT_THAT(support::contents(folder_ / "a.npz"),
              HasSubstr("\"pose\":{\"m\":[0.0,0.0,-2000.0,1.0"));
  EXPECT_THAT(render({"--pose", "0 0 1 1m 0 0 0"}).err,
              HasSubstr("a position x y z, with or without units, and a quaternion w x y z"));
  const std::string box = folder_ / "m.pxn", image = folder_ / "s.npy";
  for (const char* size : {"8x6", "8 6", "8,6", "8, 6"})
    EXPECT_THAT(panwright({"render", box, "-o", image, "--engine", "reference", "--samples", "3",
                           "--size", size})
                    .out,
                HasSubstr("8 x 6"));
  EXPECT_EQ(panwright({"render", box, "-o", image, "--size", "8 6 4"}).code, 2);
}

TEST_F(Answers, TextsThatAreNoViews) {
  const std::string box = model("<box size='1'/>");
  const auto views = [&](const std::string& text) {
    return panwright({"render", box, "--views", folder_.write("v.txt", text)}).err;
  };
  for (const char* text : {"x,y,z\n0,0,3\n", "0,0,3\n", "time = 3"}) {
    EXPECT_THAT(views(text), HasSubstr(": it begins with "));
    EXPECT_THAT(views(text), HasSubstr("write a list of views, as [{\"camera\""));
  }
  EXPECT_THAT(views(""), HasSubstr("the text is empty"));
  EXPECT_THAT(views("{\"fov\": 3}\n{\"fov\": 4}\n"),
              HasSubstr("views, one a line, are a file .jsonl, or go to --views -"));
  EXPECT_THAT(views("[{\"noise\": 3, \"output\": \"a.png\"}]"),
              HasSubstr("makes numbers with noise"));
  EXPECT_THAT(
      panwright({"render", box, "-o", "a.png", "--joints", folder_.write("j.csv", "a,3")}).err,
      HasSubstr("write an object of joint values"));
}

TEST_F(Answers, MissingFilesOfEveryKind) {
  (void)model("<box size='1'/>");
  for (const char* name : {"n.pxn", "none.pan", "none.wrl", "none.glb", "none", "none.step"}) {
    const Outcome outcome = panwright({"info", folder_ / name});
    EXPECT_EQ(outcome.code, 3) << name;
    EXPECT_THAT(outcome.err, HasSubstr("No such file or directory [E0101]")) << name;
  }
  EXPECT_THAT(panwright({"info", folder_ / "n.pxn"}).err,
              HasSubstr("did you mean '" + folder_ / "m.pxn" + "'?"));
}

TEST_F(Answers, QuietRendersDoNotRepeatWhatFoilLost) {
  const std::string foil = model(
      "<box name='b' size='0.3'/><mli type='wrap' on='b' standoff='1mm'><mli_settings><width>1"
      "</width><height>1</height><xgrid>100</xgrid></mli_settings><mli_operations><random> 9mm "
      "</random></mli_operations></mli>");
  const std::vector<std::string> words{"render",   foil,        "-o",        folder_ / "a.npy",
                                       "--engine", "reference", "--samples", "3",
                                       "--size",   "8"};
  EXPECT_THAT(panwright(words).err, HasSubstr("[W7002]"));
  std::vector<std::string> quiet = words;
  quiet.push_back("-q");
  EXPECT_THAT(panwright(quiet).err, Not(HasSubstr("W7002")));
  EXPECT_THAT(panwright({"check", "-q", foil}).err, HasSubstr("[W7002]"));
}

// Pixels by the pinhole's equations: camera 5 m before the origin on -y, f = 100, centre (16, 12).
#ifdef PANWRIGHT_GL
// Light between surfaces: a box has none, a corner has more than 5 %.
TEST_F(Answers, ExplainTellsOfLightBetweenSurfaces) {
  const auto told = [&](const std::string& shapes, const char* indirect) {
    return panwright({"render", model(shapes), "-o", folder_ / "b.png", "--size", "16", "--samples",
                      "2", "--indirect", indirect, "--explain", "--camera", "4 3 5", "--sun",
                      "1 0.3 0.5"})
        .out;
  };
  const std::string corner =
      "<material name='m'><diffuse>0.7 0.7 0.7</diffuse></material><plane size='1' material='m'/>"
      "<plane size='1' translate='-0.5 0 0.5' rotate='0 90deg 0' material='m'/>";
  EXPECT_THAT(told("<box size='1'/>", "auto"),
              HasSubstr("light between surfaces: left out, about 0 % of the flux"));
  EXPECT_THAT(told(corner, "auto"), HasSubstr("light between surfaces: drawn, about "));
  EXPECT_THAT(told(corner, "off"), Not(HasSubstr("light between surfaces")));
}

TEST_F(Answers, ThatImagesAreDrawnInSoftwareIsSaidOnRequest) {
  const std::vector<std::string> words{PANWRIGHT_BIN_DIR "/panwright",
                                       "render",
                                       model("<box size='1'/>"),
                                       "-o",
                                       folder_ / "a.png",
                                       "--size",
                                       "8"};
  const auto with = [&](const char* option) {
    std::vector<std::string> all = words;
    if (*option != '\0') all.emplace_back(option);
    const Outcome done = support::run(all, {"__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent.json"});
    return done.out + done.err;
  };
  EXPECT_THAT(with(""), Not(HasSubstr("N5002")));
  EXPECT_THAT(with("--explain"), HasSubstr("N5002"));
  EXPECT_THAT(with("--json"), HasSubstr("N5002"));
}
#endif

TEST_F(Answers, RecordsNameIdsAndPlaceKeypoints) {
  const std::string text = model(
      "<material name='red'><diffuse>0.5 0.1 0.1</diffuse></material>"
      "<node name='arm'><box name='bus' size='1' material='red'/></node>"
      "<keypoint name='corner' at='0.5 -0.5 0.5'/><keypoint name='behind' at='0 -9 0'/>");
  const std::string image = folder_ / "a.npz";
  const std::vector<std::string> words{
      "render", text,     "-o",    image,      "--engine", "reference",    "--samples",
      "3",      "--size", "32x24", "--camera", "0 -5 0",   "--intrinsics", "100 100 16 12"};
  ASSERT_EQ(panwright(words).code, 0);
  const std::string bytes = support::contents(image);
  const std::size_t begin = bytes.find("{\"schema\"");
  const auto record = nlohmann::json::parse(
      bytes.substr(begin, bytes.find("PK\x03\x04", begin) - begin), nullptr, false);
  ASSERT_FALSE(record.is_discarded());
  ASSERT_EQ(record["keypoints"].size(), 2u);
  const auto& corner = record["keypoints"][0];
  EXPECT_EQ(corner["target"], "m");
  EXPECT_EQ(corner["name"], "corner");
  EXPECT_NEAR(corner["depth"].get<double>(), 4.5, 1e-12);
  EXPECT_NEAR(corner["pixel"][0].get<double>(), 16 + 100 * 0.5 / 4.5, 1e-10);
  EXPECT_NEAR(corner["pixel"][1].get<double>(), 12 - 100 * 0.5 / 4.5, 1e-10);
  EXPECT_FALSE(record["keypoints"][1].contains("pixel"));
  EXPECT_NEAR(record["keypoints"][1]["depth"].get<double>(), -4, 1e-12);
  EXPECT_EQ(record["names"]["targets"]["1"], "m");
  ASSERT_EQ(record["names"]["nodes"]["m"].size(), 1u);
  EXPECT_EQ(record["names"]["nodes"]["m"].begin().value(), "root/arm/bus");
  ASSERT_EQ(record["names"]["materials"]["m"].size(), 1u);
  EXPECT_EQ(record["names"]["materials"]["m"].begin().value(), "red");
  // again, with the layers and the compression of the record
  std::vector<std::string> few = words;
  few.insert(few.end(), {"--layers", "depth,range", "--compress"});
  ASSERT_EQ(panwright(few).code, 0);
  const std::string chosen = support::contents(image);
  EXPECT_EQ(chosen.find("radiance.npy"), chosen.npos);
  EXPECT_NE(chosen.find("range.npy"), chosen.npos);
  ASSERT_EQ(panwright({"render", "--again", image, "-o", folder_ / "b.npz"}).code, 0);
  EXPECT_TRUE(support::contents(folder_ / "b.npz") == chosen);
  few[few.size() - 2] = "dept";
  EXPECT_THAT(panwright(few).err, HasSubstr("did you mean 'depth'?"));
}

}  // namespace
}  // namespace panwright::answers_test
