// Bad inputs: the code, the place and the words.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "tests/pxn/reading.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::diagnostics_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kBad = PANWRIGHT_SOURCE_DIR "/tests/pxn/data/bad";
const fs::path kGood = PANWRIGHT_SOURCE_DIR "/tests/pxn/data/good";

std::string code_in(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.substr(0, name.find_first_of("-."));
}

TEST(Diagnostics, EachBadFileGivesTheCodeOfItsName) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kBad)) {
    if (!entry.is_regular_file()) continue;
    const std::string code = code_in(entry.path());
    // tessellation and compilation report them
    if (code == "E2003" || code == "W2022" || code == "W2023") continue;
    ++files;
    const Reading r = read_path(entry.path().string());
    EXPECT_TRUE(r.codes().contains(code)) << entry.path() << "\n" << r.summary();
    // nothing but errors makes a file bad
    EXPECT_EQ(r.log.has_errors(), code[0] == 'E') << entry.path() << "\n" << r.summary();
    for (const Diagnostic& d : r.log.entries()) {
      EXPECT_FALSE(d.message.empty());
      EXPECT_NE(d.where.file, kNoFile) << d.message;
      EXPECT_NE(d.message.back(), '.') << d.message;
    }
    EXPECT_NE(to_text(r.log), "");
    EXPECT_NE(to_json(r.log), "");
  }
  EXPECT_GT(files, 60u);
}

// Of the folder blankets only where it is asked for: it takes most of the time.
void expect_no_diagnostics(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".pxn") continue;
    if (folder.filename() == "examples" && entry.path().parent_path().filename() == "blankets")
      continue;
    std::optional<TerrainText> terrain;
    Options options;
    options.terrain = &terrain;
    const Reading r = read_path(entry.path().string(), options);
    EXPECT_TRUE(r.scene);
    EXPECT_FALSE(r.log.has_errors()) << entry.path() << r.summary();
    // the meaning of hapke is our reading, which is said each time
    if (entry.path().filename() == "figure6b.pxn") continue;
    // what is left out of CAD files and what cleaning does to them is said each time
    if (entry.path().parent_path().filename() == "cad") continue;
    EXPECT_EQ(r.summary(), "") << entry.path();
  }
}

TEST(Diagnostics, GoodFilesDeserveNone) {
  expect_no_diagnostics(kGood);
  expect_no_diagnostics(PANWRIGHT_SOURCE_DIR "/examples");
}

TEST(Diagnostics, BlanketsDeserveNone) {
  expect_no_diagnostics(PANWRIGHT_SOURCE_DIR "/examples/blankets");
}

TEST(Diagnostics, PlacesAndWords) {
  const std::map<std::string, std::string> expected = {
      {"E1001-tag-not-closed", "4:32 E1001 the tag is not closed by '>'\n"},
      {"E1001-no-quotes", "3:17 E1001 the value of 'rings' needs quotes\n"},
      {"E1001-two-roots", "4:2 E1001 'pangu_model' after the root element; a file has one\n"},
      {"E1002", "6:5 E1002 no element 'grup' is open here (<group> of line 4 is)\n"},
      {"E1003-declared",
       "1:31 E1003 the encoding 'Shift_JIS' is not read; pxn files are UTF-8, US-ASCII or "
       "ISO-8859-1\n"},
      {"E1004",
       "3:11 E1004 the byte 0xE9 is not valid UTF-8 text here (if the file is ISO-8859-1, say so "
       "in its "
       "first line: <?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>)\n"},
      {"E1006", "3:1787 E1006 'group' is nested deeper than 256 elements\n"},
      {"E1007", "3:31 E1007 'rings' is given twice; the first one is used\n"},
      {"E1101",
       "3:4 E1101 unknown element 'spere' in <pangu_model>, expected group, include, transform, "
       "rotate, frame_s, appearance, texture, sphere, mesh or mli (did you mean 'sphere'?)\n"},
      {"E1101-belongs",
       "4:6 E1101 unknown element 'diffuse' in <appearance>, expected material or child ('diffuse' "
       "belongs in <material>)\n"},
      {"E1102",
       "3:11 E1102 unknown attribute 'ring' of <sphere>; it has rings and quads (did you mean "
       "'rings'?)\n"},
      {"E1103", "3:4 E1103 the attribute 'rings' of <sphere> is missing\n"},
      {"E1103-child", "3:4 E1103 <transform> needs <child>\n"},
      {"E1104",
       "6:8 E1104 <child> takes at most one node; this one is left out (put the nodes into "
       "a <group>)\n"},
      {"E1105", "3:11 E1105 <group> takes no text, found 'a sphere:'\n"},
      {"E1106", "3:4 E1106 'box' belongs to level 1 of the language, and this file says 0\n"},
      {"E1107-root",
       "1:2 E1107 the root element is <pangu>, not <pangu_model> (did you mean "
       "'pangu_model'?)\n"},
      {"E1107-version", "1:19 E1107 ver=\"2\" is not a known version; write ver=\"0\" or \"1\"\n"},
      {"E1201-nan",
       "3:31 E1201 'nan' is not a number, expected -1e+30 to 1e+30 for y of <translation>\n"},
      {"E1201-comma",
       "3:29 E1201 commas in <translation>, expected decimal points (write 0.5 1 0)\n"},
      {"E1201-fraction",
       "3:18 E1201 '4.0' is not a whole number, expected 2 to 100000 for rings of <sphere> (it has "
       "no "
       "decimal point or exponent)\n"},
      {"E1202-rings", "3:18 E1202 rings of <sphere> is 1000000000, expected 2 to 100000\n"},
      {"E1202-overflow", "3:33 E1202 z of <translation> is 1e999, expected -1e+30 to 1e+30\n"},
      {"E1203", "4:17 E1203 <diffuse>: expected 3 numbers (r g b), found 2\n"},
      {"E1204", "3:18 E1204 type of <include> is 'vrml', expected pxn\n"},
      {"W1205", "3:17 W1205 count is 3, and the group holds 1 node\n"},
      {"E1206",
       "3:12 E1206 the quaternion has length 1.41421, expected w x y z of length 1 to 1e-3\n"},
      {"E1210", "9:3 E1210 duplicate frame 'camera'; this one is left out\n"},
      {"E1301",
       "3:29 E1301 file 'parts/plat.pxn' not found, neither from the top file's folder nor from "
       "this file's\n"},
      {"E1303",
       "3:29 E1303 '../good/cube.pxn' leaves the project; included files lie in the top file's "
       "folder or below it (--root DIR takes files from all of DIR)\n"},
      {"E2001",
       "5:34 E2001 the index 4 is past the last position; there are 4 positions, expected 0 to "
       "3; the strip is left out\n"},
      {"W2007",
       "3:4 W2007 at 1 edge neighbouring triangles face opposite ways; strips alternate, beginning "
       "counter-clockwise from outside\n"},
      {"W2009", "3:4 W2009 the mesh is closed and inside out: its triangles enclose -0.1667 m³\n"},
  };
  for (const auto& [name, text] : expected)
    EXPECT_EQ(read_path((kBad / (name + ".pxn")).string()).summary(), text) << name;
}

TEST(Diagnostics, TheIncludeStackIsPrinted) {
  const Reading r = read_path((kBad / "E1302-two-files.pxn").string());
  const std::string text = to_text(r.log);
  EXPECT_THAT(text, HasSubstr("cycle-b.pxn:3:29: error: "));
  const std::size_t a =
      text.find("included from " + (kBad / "parts/cycle-a.pxn").string() + ":3:29");
  const std::size_t top =
      text.find("included from " + (kBad / "E1302-two-files.pxn").string() + ":3:29");
  EXPECT_NE(a, std::string::npos) << text;
  EXPECT_NE(top, std::string::npos) << text;
  EXPECT_LT(a, top);
}

TEST(Diagnostics, ColumnsCountCharactersAndObjectsArePaths) {
  for (const bool latin : {false, true}) {
    const std::string e = latin ? "\xe9" : "\xc3\xa9";
    const std::string text = std::string("<?xml version=\"1.0\" encoding=\"") +
                             (latin ? "ISO-8859-1" : "UTF-8") +
                             "\"?>\n<pangu_model ver=\"0\"><group/><group>\n<!-- " + e + e +
                             " --><sphere rings=\"4\" quads=\"" + e + "\"/></group></pangu_model>";
    const Reading r = read_files({{"m.pxn", text}});
    EXPECT_EQ(r.summary(),
              "3:37 E1201 '\xc3\xa9' is not a whole number, expected 3 to 100000 for quads of "
              "<sphere>\n");
    EXPECT_EQ(r.log.entries().at(0).object, "pangu_model/group[2]/sphere");
  }
}

TEST(Diagnostics, CaretsInsideCommentsReferencesAndCdata) {
  const auto places = [](const std::string& text) {
    return read_nodes("<transform><translation>" + text +
                      "</translation><child><group/></child></transform>")
        .summary();
  };
  EXPECT_THAT(places("1 <!-- 2 --> x 3"), HasSubstr("2:38 E1201 'x'"));
  EXPECT_THAT(places("1 <![CDATA[ x ]]> 3"), HasSubstr("2:37 E1201 'x'"));
  EXPECT_THAT(places("&#49; &#120; 3"), HasSubstr("2:31 E1201 'x'"));
  EXPECT_EQ(places("1<!-- -->2 3 4"), "") << "a comment parts no number";
  EXPECT_THAT(places("1<!-- --> <!-- -->2 3 4"), HasSubstr("E1203"));
}

TEST(Diagnostics, NumbersAreDecimalAndNothingElse) {
  const auto reads = [](const std::string& number) {
    return read_nodes("<transform><translation>" + number +
                      " 0 0</translation><child><group/></child></transform>");
  };
  for (const char* good : {"1", "-1", "+1", "1.", ".5", "-.5e3", "1E+2", "1e-400", "00012", "0e999",
                           "0.000000000000000000000000000000000000000000000000000000000000001"}) {
    EXPECT_EQ(reads(good).summary(), "") << good;
  }
  for (const char* bad : {"nan", "NaN", "inf", "-Infinity", "0x10", "1e", "e1", ".", "+", "--1",
                          "+-1", "1_0", "1f", "\xd9\xa1", "1e5.0", "½"}) {
    EXPECT_EQ(reads(bad).codes(), std::multiset<std::string>{"E1201"})
        << bad << reads(bad).summary();
  }
  for (const std::string& bad : {std::string("1e999"), std::string("-1e999"), std::string("1e31"),
                                 std::string(400, '9'), std::string("1e99999999999999999999")}) {
    EXPECT_EQ(reads(bad).codes(), std::multiset<std::string>{"E1202"})
        << bad << reads(bad).summary();
  }
}

TEST(Diagnostics, WhatIsReadableIsStillBuilt) {
  const Reading r = read_nodes(
      "<sphere rings=\"4\" quads=\"4\"/><spere/><group><sphere rings=\"x\" quads=\"4\"/>"
      "<transform><scaling>0 1 1</scaling><translation>1 2 3</translation>"
      "<child><sphere rings=\"6\" quads=\"6\"/></child></transform></group>");
  EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E1101", "E1201", "E1211"}));
  ASSERT_TRUE(r.scene);
  EXPECT_EQ(r.scene->instances.size(), 2u);
  const auto world = scene::world_from_nodes(*r.scene);
  EXPECT_EQ(Vec3(world[static_cast<std::size_t>(r.scene->instances[1].node)][3]), Vec3(1, 2, 3));
}

TEST(Diagnostics, FilesThatAreNotThere) {
  const support::TemporaryFolder folder;
  const Reading none = read_path(folder / "none.pxn");
  EXPECT_FALSE(none.scene);
  EXPECT_EQ(none.codes(), std::multiset<std::string>{"E0101"});
  EXPECT_EQ(exit_code(none.log), 3);
  EXPECT_EQ(read_path(folder.path().string()).codes(), std::multiset<std::string>{"E0101"});
}

}  // namespace
}  // namespace panwright::pxn::diagnostics_test
