// What a new user meets: messages that name the one cause, and nothing of theirs lost.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "image/png.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::first_hour_test {
namespace {

using support::Outcome;
using support::panwright;
using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class FirstHour : public testing::Test {
 protected:
  std::string model(const std::string& name, const std::string& body,
                    const std::string& root = " ver=\"1\"") {
    return folder_.write(name, "<pangu_model" + root + ">\n" + body + "\n</pangu_model>\n");
  }
  // A plate of a given length in metres beside one of 1 m; named nodes.
  std::string plates(const std::string& length, const std::string& node = "long_one") {
    const auto plate = [](const std::string& name, const std::string& x, const std::string& y) {
      return "DEF " + name + " Transform { translation 0 " + y +
             " 0 children Shape { appearance Appearance { material DEF Steel Material { } } "
             "geometry IndexedFaceSet { solid FALSE coord Coordinate { point [ 0 0 0, " +
             x + " 0 0, " + x + " 1 0, 0 1 0 ] } coordIndex [ 0 1 2 3 ] } } }\n";
    };
    return folder_.write("plates.wrl", "#VRML V2.0 utf8\n" + plate(node, length, "0") +
                                           plate("short_one", "1", "3"));
  }
  support::TemporaryFolder folder_;
};

// What `new` writes is a model without a word to say against it, laid out as fmt would, that its
// schema takes; nothing that is there is touched.
TEST_F(FirstHour, NewWritesAModelToBeginWith) {
  const std::string folder = (folder_.path() / "models/probe-2").string();
  const Outcome made = panwright({"new", folder});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("next: panwright view " + folder + "/probe-2.pxn"));
  const std::string text = folder + "/probe-2.pxn";
  const Outcome check = panwright({"check", text});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(check.err, "");
  EXPECT_EQ(panwright({"fmt", "--check", text}).code, 0);
  EXPECT_EQ(support::contents(text).find("@NAME@"), std::string::npos);
  EXPECT_EQ(support::contents(folder + "/pxn.xsd"),
            support::contents(PANWRIGHT_SOURCE_DIR "/schemas/pxn.xsd"));
  EXPECT_EQ(support::run({"xmllint", "--noout", "--schema", folder + "/pxn.xsd", text}).code, 0);
  const Outcome joints = panwright({"joints", text, "--joint", "wing=@sun", "--sun", "1 0 1"});
  EXPECT_EQ(joints.code, 0) << joints.err;

  const std::string before = support::contents(text);
  const Outcome again = panwright({"new", folder});
  EXPECT_EQ(again.code, 3);
  EXPECT_THAT(again.err, HasSubstr("it already exists"));
  EXPECT_EQ(support::contents(text), before);
  for (const char* name : {"", ".", "..", "/", "a b", "-x", "a.pxn"})
    EXPECT_EQ(panwright({"new", "--", name}).code, 2) << name;
}

TEST_F(FirstHour, AnEditedTextIsNotReplacedByImport) {
  const std::string cad = plates("2"), text = folder_ / "t.pxn";
  const auto import = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"import", cad, "-o", text});
    return panwright(more);
  };
  ASSERT_EQ(import({}).code, 0);
  const std::string first = support::contents(text);
  // as it was written, it may be replaced, by itself and by another
  EXPECT_EQ(import({}).code, 0);
  EXPECT_EQ(support::contents(text), first);
  EXPECT_EQ(import({"--units", "cm"}).code, 0);
  EXPECT_NE(support::contents(text), first);
  EXPECT_EQ(import({}).code, 0);
  EXPECT_EQ(panwright({"check", text}).code, 0);

  std::string edited = first;
  edited.insert(edited.find("<import"), "<!-- mine -->\n  ");
  folder_.write("t.pxn", edited);
  const Outcome kept = import({});
  EXPECT_EQ(kept.code, 3) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("the file was edited, or not written by 'import'"));
  EXPECT_THAT(kept.err, HasSubstr("--force"));
  EXPECT_EQ(support::contents(text), edited);
  EXPECT_EQ(import({"--force"}).code, 0);
  EXPECT_EQ(support::contents(text), first);

  folder_.write("t.pxn", "<pangu_model ver=\"1\"/>\n");
  EXPECT_EQ(import({}).code, 3);
}

TEST_F(FirstHour, AModelTooLargeForASpacecraftIsSaidWhateverItIsReadFrom) {
  const std::string large = plates("250"), text = folder_ / "t.pxn";
  EXPECT_THAT(panwright({"check", large}).err, HasSubstr("[W2022]"));
  EXPECT_THAT(panwright({"import", large, "-o", folder_ / "a.pan"}).err, HasSubstr("[W2022]"));
  EXPECT_THAT(panwright({"import", large}).err, HasSubstr("[W2022]"));
  const Outcome written = panwright({"import", large, "-o", text});
  EXPECT_EQ(written.code, 0);
  EXPECT_THAT(written.err, HasSubstr("[W2022]"));
  EXPECT_THAT(panwright({"check", text}).err, HasSubstr("[W2022]"));
  // hidden parts count, as a single mesh may be a celestial body
  const std::string shell = folder_.write(
      "shell.wrl",
      "#VRML V2.0 utf8\nShape { geometry Box { size 250 250 250 } }\nShape { geometry "
      "Cone { bottomRadius 50 height 50 } }");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"check", shell}, {"import", shell, "-o", folder_ / "shell.pan"}})
    EXPECT_THAT(panwright(words).err, HasSubstr("[W2022]"));
  // one cause has one warning: a guessed unit has been said
  const std::string guessed = panwright({"check", plates("250000")}).err;
  EXPECT_THAT(guessed, HasSubstr("[W6006]"));
  EXPECT_THAT(guessed, Not(HasSubstr("[W2022]")));
  EXPECT_THAT(panwright({"check", plates("150")}).err, Not(HasSubstr("[W2022]")));
}

TEST_F(FirstHour, AMissingVersionIsTheOneError) {
  const std::string text =
      model("m.pxn",
            "<param name=\"n\" value=\"3\"/><part name=\"p\"><box size=\"1 1 1\"/></part>"
            "<repeat count=\"{n}\" var=\"i\"><use part=\"p\" translate=\"{2*i} 0 0\"/></repeat>",
            "");
  const Outcome outcome = panwright({"check", text});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(count_of(outcome.err, "error:"), 1u) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the attribute 'ver' of <pangu_model> is missing [E1103]"));
  EXPECT_THAT(outcome.err, HasSubstr("write ver=\"0\" or \"1\""));
}

TEST_F(FirstHour, AUnitThatWasNotReadBringsNoWarningOfTheSize) {
  const std::string boxes = "<box size=\"1000 1000 1000\"/><box size=\"9 9 9\"/>";
  const Outcome typo = panwright({"check", model("m.pxn", boxes, " ver=\"1\" units=\"mmm\"")});
  EXPECT_THAT(typo.err, HasSubstr("[E1204]"));
  EXPECT_THAT(typo.err, Not(HasSubstr("[W2022]")));
  EXPECT_THAT(panwright({"check", model("m.pxn", boxes)}).err, HasSubstr("[W2022]"));
}

TEST_F(FirstHour, ADecalSaysBothThatItsImageAndThatItsShapeAreMissing) {
  const Outcome outcome =
      panwright({"check", model("m.pxn",
                                "<box name=\"plate\" size=\"1 1 1\"/>\n<decal on=\"plaet\" "
                                "image=\"none.png\" at=\"0 0 0.5\" size=\"0.5\"/>")});
  EXPECT_THAT(outcome.err, HasSubstr("[E1301]"));
  EXPECT_THAT(outcome.err, HasSubstr("no shape of this file has the name 'plaet'"));
  EXPECT_EQ(count_of(outcome.err, "error:"), 2u) << outcome.err;
  // the shape is there: no word of it
  const Outcome image =
      panwright({"check", model("m.pxn",
                                "<box name=\"plate\" size=\"1 1 1\"/>\n<decal on=\"plate\" "
                                "image=\"none.png\" at=\"0 0 0.5\" size=\"0.5\"/>")});
  EXPECT_EQ(count_of(image.err, "error:"), 1u) << image.err;
}

TEST_F(FirstHour, AWrongProductSaysWhatItsFactorsAre) {
  const Outcome outcome =
      panwright({"check", model("m.pxn",
                                "<param name=\"w\" value=\"2m\"/><param name=\"n\" value=\"3\"/>\n"
                                "<box size=\"{w*w*n} 1 1\"/>")});
  EXPECT_THAT(outcome.err, HasSubstr("got an area ({w*w*n}) [E1212]"));
  EXPECT_THAT(outcome.err,
              HasSubstr("its units: m, mm, cm, km, um, nm, in or ft; w is a length, n is a "
                        "plain number"));
}

TEST_F(FirstHour, AParameterOfOneTargetIsNoErrorOfTheOthers) {
  const std::string box =
      model("box.pxn", "<param name=\"w\" value=\"2m\"/><box size=\"{w} 1 1\"/>");
  const std::string ball = model("ball.pxn", "<sphere radius=\"1\"/>");
  const auto render = [&](const std::string& define) {
    return panwright({"render", box, ball, "-D", define, "--engine", "reference", "--samples", "1",
                      "--size", "8x8", "-o", folder_ / "a.png"});
  };
  EXPECT_EQ(render("w=3m").code, 0) << render("w=3m").err;
  const Outcome none = render("v=3m");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("-D v=3m: no target has a parameter 'v'; there is w [E1225]"));
}

TEST_F(FirstHour, ViewsReportEveryProblemInOneRunAndInOrder) {
  const std::string ball = model("ball.pxn", "<sphere radius=\"1\"/>");
  const std::string views = folder_.write("v.json", R"([
    {"output": "a.png", "fov": 400}, {"output": "b.png", "camra": [0, 0, 5]},
    {"output": "c.png", "size": "0x32", "sun": "a"}, {"output": "d.png", "samples": 900}])");
  const std::string err = panwright({"render", ball, "--views", views}).err;
  const std::vector<std::string> wanted = {"view 0: fov is '400'", "view 1: unknown option 'camra'",
                                           "view 2: size is '0x32'", "view 2: sun is 'a'",
                                           "view 3: samples is '900'"};
  std::size_t last = 0;
  for (const std::string& each : wanted) {
    const std::size_t at = err.find(each);
    ASSERT_NE(at, err.npos) << each << "\n" << err;
    EXPECT_GE(at, last);
    last = at;
  }
  EXPECT_EQ(count_of(err, "error:"), wanted.size()) << err;
}

TEST_F(FirstHour, ViewsOfNothingAreOneWarning) {
  const std::string ball = model("ball.pxn", "<sphere radius=\"1\"/>");
  std::string views = "[";
  for (int i = 0; i < 12; ++i)
    views += std::string(i > 0 ? "," : "") + "{\"output\": \"" + (folder_ / "a") +
             std::to_string(i) + ".png\", \"camera\": [0, -5, 0], \"look_at\": [0, " +
             (i == 3 ? "0" : "-9") + ", 0], \"fov\": 20, \"size\": \"8x8\"}";
  const Outcome outcome = panwright({"render", ball, "--engine", "reference", "--samples", "1",
                                     "--views", folder_.write("v.json", views + "]")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(count_of(outcome.err, "[W5006]"), 1u) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("11 views: nothing is in view"));
  EXPECT_THAT(outcome.err, HasSubstr("(view 0, view 1, view 2, view 4, "));
}

TEST_F(FirstHour, AnAngleThatIsALengthSaysWhatAnAngleIs) {
  const std::string ball = model("ball.pxn", "<sphere radius=\"1\"/>");
  const Outcome outcome = panwright({"render", ball, "--fov", "20m", "-o", folder_ / "a.png"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("--fov is '20m', a length, expected an angle above 0 and below 180 "
                        "degrees, as 20deg, 0.35rad or 20 (degrees) [E0201]"));
}

TEST_F(FirstHour, OptionsInMetresAndDegreesTakeUnits) {
  const std::string obj = folder_ / "plate.obj";
  folder_.write("plate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto bytes = [&](std::vector<std::string> options) {
    std::vector<std::string> line{"import", obj, "-o", folder_ / "plate.pan", "--units", "m"};
    line.insert(line.end(), options.begin(), options.end());
    EXPECT_EQ(panwright(line).code, 0);
    DiagnosticLog log;
    return *read_file(folder_ / "plate.pan", 1u << 24, log);
  };
  EXPECT_EQ(bytes({"--weld", "2mm", "--crease", "20deg", "--max-error", "1mm"}),
            bytes({"--weld", "0.002", "--crease", "20", "--max-error", "0.001"}));
  EXPECT_NE(bytes({"--max-error", "2mm"}), bytes({"--max-error", "0.001"}));
  EXPECT_THAT(panwright({"import", obj, "--weld", "2deg"}).err,
              HasSubstr("--weld is '2deg', expected a length, as 2mm or 0.002 (metres) [E0201]"));
  EXPECT_THAT(panwright({"import", obj, "--crease", "2mm"}).err,
              HasSubstr("--crease is '2mm', expected an angle, as 30deg or 30 (degrees) [E0201]"));
  const auto image = [&](const std::string& camera) {
    EXPECT_EQ(panwright({"render", obj, "--units", "m", "--camera", camera, "--size", "8", "-o",
                         folder_ / "a.npy"})
                  .code,
              0);
    DiagnosticLog log;
    return *read_file(folder_ / "a.npy", 1u << 24, log);
  };
  EXPECT_EQ(image("0.3 20cm 4m"), image("0.3 0.2 4"));
  EXPECT_THAT(panwright({"render", obj, "--camera", "0 1deg 2", "-o", folder_ / "a.png"}).err,
              HasSubstr("--camera is '0 1deg 2', expected three lengths"));
  EXPECT_THAT(panwright({"joints", obj, "--joint", "a=1", "--joint", "a=2"}).err,
              HasSubstr("--joint gives 'a' a value twice [E0201]"));
  EXPECT_THAT(panwright({"import", obj, "--max-error", "-1mm"}).err,
              HasSubstr("expected a number above 0 [E0201]"));
}

TEST_F(FirstHour, NamesOfNodesAreWholeAndListed) {
  const std::string name = std::string(70, 'n') + "_end";
  plates("2", name);
  const std::string text =
      model("t.pxn", "<import file=\"plates.wrl\" hidden=\"keep\"><remove nodes=\"" +
                         std::string(70, 'n') + "_edn\"/></import>");
  EXPECT_THAT(panwright({"check", text}).err, HasSubstr("'" + name + "'"));
  const Outcome list = panwright({"info", folder_ / "plates.wrl", "--nodes", "--keep-hidden"});
  EXPECT_TRUE(list.out.starts_with("name\ttriangles\tmaterials\tid\tpath\n")) << list.out;
  EXPECT_THAT(list.out, HasSubstr("\n" + name + "\t"));
  EXPECT_THAT(list.out, HasSubstr("Shape1\t2\tSteel\t4\tmodel/" + name + "/Shape1\n"));
  EXPECT_THAT(list.out, Not(HasSubstr("build id")));
}

TEST_F(FirstHour, ATableSaysWhichWordIsNoNumber) {
  std::string table;
  for (int i = 0; i < 10; ++i) table += "30 0 " + std::to_string(5 * i) + " 180 0.14\n";
  const std::string file = folder_.write("t.txt", table + "30 0 60 180 14%\n");
  const Outcome outcome = panwright({"material", "--fit", file});
  EXPECT_THAT(outcome.err, HasSubstr("t.txt:11:13: error: number 5 is '14%', expected a finite "
                                     "number: a reflectance is in 1/sr, not in percent"));
}

// Textures of the file that an assigned material hides or replaces.
TEST_F(FirstHour, TexturesThatAreNotSeenAreSaid) {
  const auto image = [&](const std::string& name, std::uint32_t side) {
    std::vector<std::uint8_t> rgba(std::size_t{4} * side * side, 90);
    for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 255;
    folder_.write(name, image::png_file(side, side, rgba));
  };
  image("small.png", 64);
  image("large.png", 65);
  folder_.write("sat.mtl",
                "newmtl a\nKd 1 1 1\nmap_Kd small.png\nnewmtl b\nKd 1 1 1\nmap_Kd large.png\n");
  folder_.write("sat.obj",
                "mtllib sat.mtl\no a\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0.1 0.1\nvt 0.2 0.2\n"
                "vt 0.3 0.4\nusemtl a\nf 1/1 2/2 3/3\no b\nv 0 2 0\nv 1 2 0\nv 0 3 0\nusemtl b\n"
                "f 5/1 6/2 7/3\n");
  const auto said = [&](const std::string& preset, const std::string& pictures) {
    return panwright({"check", model("m.pxn", "<material name=\"m\" preset=\"" + preset +
                                                  "\"/>\n<import file=\"sat.obj\" units=\"m\">"
                                                  "<assign material=\"m\" pictures=\"" +
                                                  pictures + "\"/></import>")})
        .err;
  };
  EXPECT_THAT(said("aluminium_bare", "keep"),
              HasSubstr("the textures of 2 parts have no effect: they multiply the diffuse "
                        "colour, and 'm' has none [W6008]"));
  EXPECT_EQ(said("white_silicone", "keep"), "");
  EXPECT_THAT(said("white_silicone", "drop"),
              HasSubstr("1 part has its colour from an image of at most 4096 texels, as from a "
                        "palette, which 'm' replaces by one colour [W6008]"));
}

// A colour of a palette is dressed as any other, without a word; or kept, with what it looks like.
TEST_F(FirstHour, ColoursOfPalettesAreDressed) {
  std::vector<std::uint8_t> rgba;  // two blocks of 4 x 4 texels
  for (int i = 0; i < 32; ++i) {
    const bool left = i % 8 < 4;
    for (const int code : {left ? 200 : 10, left ? 30 : 20, left ? 40 : 250, 255})
      rgba.push_back(static_cast<std::uint8_t>(code));
  }
  folder_.write("p.png", image::png_file(8, 4, rgba));
  folder_.write("p.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd p.png\n");
  folder_.write("p.obj",
                "mtllib p.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\nv 2 1 0\n"
                "vt 0.25 0.5\nvt 0.75 0.5\nf 1/1 2/1 3/1\nf 4/2 5/2 6/2\n");
  const auto text = [&](const std::string& name, const std::string& rules) {
    return model(name + ".pxn",
                 "<material name=\"white\"><diffuse> 1 1 1 </diffuse></material>"
                 "<material name=\"steel\" preset=\"aluminium_bare\"/>"
                 "<import file=\"p.obj\" units=\"m\">" +
                     rules + "</import>");
  };
  const auto flux = [&](const std::string& file) {
    const Outcome outcome =
        panwright({"render", file, "--engine", "reference", "--size", "16", "--bounces", "0",
                   "--samples", "8", "--camera", "1 -6 0.5", "--look-at", "1 0 0.5", "--sun",
                   "0.3 -1 0.2", "--json", "-o", folder_ / "f.npy"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const nlohmann::json json = nlohmann::json::parse(outcome.out);
    return json["images"][0]["flux"].get<std::vector<double>>();
  };
  const std::string dressed =
      text("dressed", "<assign materials=\"*_c81e28\" material=\"steel\"/>");
  EXPECT_THAT(panwright({"check", dressed}).err, Not(HasSubstr("W6008")));
  // white times the palette's colour is the palette's colour
  const std::string kept = text("kept", "<assign material=\"white\" pictures=\"keep\"/>");
  const std::vector<double> as_it_was = flux(text("plain", "")), now = flux(kept);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(now[k], as_it_was[k], 1e-6 * as_it_was[k]);
  EXPECT_GT(flux(text("white", "<assign material=\"white\"/>"))[1], 3 * now[1]);
}

TEST_F(FirstHour, WhatImportersFoundIsOneLineWhereATextIsShown) {
  // four open plates at one edge: holes, and an edge of more than two triangles
  folder_.write("fan.obj",
                "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\n"
                "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\n");
  const std::string text = model("m.pxn", "<import file=\"fan.obj\" units=\"m\"/>");
  const Outcome checked = panwright({"check", text});
  EXPECT_THAT(checked.err, HasSubstr("[W6302]"));
  const Outcome shown = panwright({"info", text});
  EXPECT_THAT(shown.err, Not(HasSubstr("[W6302]")));
  EXPECT_THAT(shown.err, HasSubstr("of imported files not shown (W6302"));
  EXPECT_THAT(shown.err, HasSubstr("'panwright check' of the same file shows them"));
  for (const Outcome& other :
       {panwright({"diff", text, text}), panwright({"export", text, "-o", folder_ / "m.glb"})}) {
    EXPECT_THAT(other.err, Not(HasSubstr("[W6302]")));
    EXPECT_THAT(other.err, HasSubstr("of imported files not shown (W6302"));
  }
  // all of it for programs, and where the file itself is shown
  EXPECT_THAT(panwright({"info", text, "--json"}).out, HasSubstr("\"W6302\""));
  EXPECT_THAT(panwright({"info", folder_ / "fan.obj", "--units", "m"}).err, HasSubstr("[W6302]"));
}

TEST_F(FirstHour, InfoSaysTheCoatOfAMaterial) {
  const std::string text =
      model("m.pxn",
            "<material name=\"m\"><diffuse> 0.5 0.5 0.5 </diffuse><coat n=\"1.45\" "
            "slope=\"0.1\"/></material><sphere radius=\"1\" material=\"m\"/>");
  const Outcome outcome = panwright({"info", text});
  EXPECT_THAT(outcome.out, HasSubstr(", under a coat of index 1.45, slope 0.1")) << outcome.err;
  const std::string bare = model(
      "m.pxn",
      "<material name=\"m\"><diffuse> 0.5 0.5 0.5 </diffuse></material><sphere material=\"m\"/>");
  EXPECT_THAT(panwright({"info", bare}).out, Not(HasSubstr("coat")));
}

}  // namespace
}  // namespace panwright::first_hour_test
