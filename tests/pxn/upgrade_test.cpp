// Level 0 → level 1: the words, the comments, and the same model.

#include "pxn/upgrade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "pxn/writer.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::upgrade_test {
namespace {

namespace fs = std::filesystem;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

struct Upgrading {
  DiagnosticLog log;
  Result<std::vector<UpgradedFile>> files = failed;
  std::size_t count(Code code) const {
    std::size_t n = 0;
    for (const Diagnostic& d : log.entries()) n += d.code == code ? 1 : 0;
    return n;
  }
};

Upgrading upgrade_of(const std::vector<std::string>& paths, const Options& options = {}) {
  Upgrading out;
  out.files = upgraded(paths, options, out.log);
  return out;
}

// The nodes of a model of level 0, upgraded: what stands below the root.
std::string upgraded_nodes(const std::string& nodes) {
  const TemporaryFolder folder;
  const Upgrading u =
      upgrade_of({folder.write("m.pxn", "<pangu_model ver='0'>" + nodes + "</pangu_model>")});
  EXPECT_TRUE(u.files) << to_text(u.log);
  if (!u.files) return {};
  const std::string& text = (*u.files)[0].text;
  const std::size_t begin = text.find('\n') + 1;
  return text.substr(begin, text.rfind("</pangu_model>") - begin);
}

TEST(Upgrade, TheWords) {
  EXPECT_EQ(upgraded_nodes("<transform><scaling>1 1 2</scaling><rotation>0 0\n90</rotation>"
                           "<translation> 0 &#49;.25 0 </translation><child><sphere rings='3' "
                           "quads='4'/></child></transform>"),
            "  <transform translate=\"0 1.25 0\" rotate=\"0 0 90\" scale=\"1 1 2\">\n"
            "    <sphere rings=\"3\" quads=\"4\"/>\n"
            "  </transform>\n");
  EXPECT_EQ(upgraded_nodes("<rotate><quat>0.6 0 0 0.8</quat><child><group count='2'><sphere "
                           "rings='3' quads='4'/><group><sphere rings='3' quads='5'/></group>"
                           "</group></child></rotate>"),
            "  <transform quat=\"0.6 0 0 0.8\">\n"
            "    <sphere rings=\"3\" quads=\"4\"/>\n"
            "    <group>\n"
            "      <sphere rings=\"3\" quads=\"5\"/>\n"
            "    </group>\n"
            "  </transform>\n");
  // appearances stay: what they leave out may come from around the file
  EXPECT_EQ(upgraded_nodes("<appearance><material><oren>0.3</oren></material><child><transform>"
                           "<child><sphere rings='3' quads='4'/></child></transform></child>"
                           "</appearance>"),
            "  <appearance>\n"
            "    <material>\n"
            "      <oren> 0.3 </oren>\n"
            "    </material>\n"
            "    <child>\n"
            "      <transform>\n"
            "        <sphere rings=\"3\" quads=\"4\"/>\n"
            "      </transform>\n"
            "    </child>\n"
            "  </appearance>\n");
}

TEST(Upgrade, AnglesKeepTheirBits) {
  // 15, 30 and 60 times the rounded π/180 are not what 15deg, 30deg and 60deg are rounded to
  EXPECT_EQ(upgraded_nodes("<transform><rotation>30 +15 6e1</rotation><child>"
                           "<sphere rings='3' quads='4'/></child></transform>"),
            "  <transform rotate=\"30 +15 6e1\">\n    <sphere rings=\"3\" quads=\"4\"/>\n"
            "  </transform>\n");
  for (const char* angles : {"0 0 90", "30 0 0", "1 2 3", "-60 15 45", "+30 1e1 0.125"}) {
    const std::string nodes = "<transform><rotation>" + std::string(angles) +
                              "</rotation><child><sphere rings='3' quads='4'/></child></transform>";
    const Reading before = read_nodes(nodes);
    const Reading after =
        read_files({{"m.pxn", "<pangu_model ver='1'>" + upgraded_nodes(nodes) + "</pangu_model>"}});
    ASSERT_TRUE(before.scene && after.scene) << after.summary();
    EXPECT_EQ(scene_difference(*before.scene, *after.scene, Likeness::looks), "") << angles;
  }
}

TEST(Upgrade, Comments) {
  EXPECT_EQ(upgraded_nodes("\n"
                           "  <!-- of the transform -->\n"
                           "  <transform> <!-- behind it -->\n"
                           "    <!-- of the scaling -->\n"
                           "    <scaling> 1 <!-- within --> 1 2 </scaling> <!-- behind -->\n"
                           "    <translation> 0 0 1 </translation>\n"
                           "\n"
                           "    <child> <!-- of the child -->\n"
                           "      <group>\n"
                           "        <!-- of the sphere -->\n"
                           "        <sphere rings='3' quads='4'/> <!-- behind the sphere -->\n"
                           "        <!-- last -->\n"
                           "      </group>\n"
                           "    </child>\n"
                           "  </transform>\n"),
            "  <!-- of the transform -->\n"
            "  <transform translate=\"0 0 1\" scale=\"1 1 2\"> <!-- behind it -->\n"
            "    <!-- of the scaling -->\n"
            "    <!-- within --> <!-- behind -->\n"
            "\n"
            "    <!-- of the child -->\n"
            "    <!-- of the sphere -->\n"
            "    <sphere rings=\"3\" quads=\"4\"/> <!-- behind the sphere -->\n"
            "    <!-- last -->\n"
            "  </transform>\n");
}

std::string frame_s(const std::string& label, const std::string& forward, const std::string& up,
                    const std::string& right) {
  return "<frame_s label=\"" + label + "\"><origin><vec3> 0 0 0.5 </vec3><!-- c --></origin>" +
         "<forward><vec3>" + forward + "</vec3></forward><up><vec3>" + up +
         "</vec3></up><right><vec3>" + right + "</vec3></right></frame_s>";
}

TEST(Upgrade, Frames) {
  EXPECT_EQ(upgraded_nodes(frame_s("a &amp; b", "0 0 1", "0 -1 0", "1 0 0")),
            "  <frame name=\"a &amp; b\" translate=\"0 0 0.5\" forward=\"0 0 1\" up=\"0 -1 0\"> "
            "<!-- c --> </frame>\n");
  // axes that are off by rounding are made exact in another way: their quaternion does
  EXPECT_THAT(upgraded_nodes(frame_s("f", "0.57735 0.57735 0.57735", "0.70711 -0.70711 0",
                                     "0.40825 0.40825 -0.81650")),
              HasSubstr(" quat=\""));
}

TEST(Upgrade, PathsBeginAtTheFile) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "parts");
  const std::string ball = "<sphere rings='3' quads='4'/>";
  const auto model = [](const std::string& nodes) {
    return "<pangu_model ver='0'>" + nodes + "</pangu_model>";
  };
  const std::string top =
      folder.write("top.pxn", model("<include type='pxn' file='parts/a.pxn'/>"));
  // from the top file's folder, and from its own
  const std::string a =
      folder.write("parts/a.pxn", model("<group><include type='pxn' file='parts/b.pxn'/>"
                                        "<include type='pxn' file='c.pxn'/></group>"));
  folder.write("parts/b.pxn", model(ball));
  folder.write("parts/c.pxn", model(ball));
  const Upgrading both = upgrade_of({top, a});
  ASSERT_TRUE(both.files) << to_text(both.log);
  EXPECT_THAT((*both.files)[0].text, HasSubstr("<include file=\"parts/a.pxn\"/>"));
  EXPECT_THAT((*both.files)[1].text, HasSubstr("<include file=\"b.pxn\"/>"));
  EXPECT_THAT((*both.files)[1].text, HasSubstr("<include file=\"c.pxn\"/>"));
  EXPECT_EQ((*both.files)[0].paths, 0u);
  EXPECT_EQ((*both.files)[1].paths, 1u);
  EXPECT_EQ(both.count(Code("N1318")), 1u);
  // by itself the part finds nothing
  EXPECT_FALSE(upgrade_of({a}).files);
  // once written, nothing is left to do
  for (const UpgradedFile& file : *both.files)
    folder.write(fs::relative(file.path, folder.path()).string(), file.text);
  const Upgrading again = upgrade_of({top, a});
  ASSERT_TRUE(again.files) << to_text(again.log);
  EXPECT_EQ((*again.files)[0].text, "");
  EXPECT_EQ((*again.files)[1].text, "");
}

TEST(Upgrade, WhatWouldChangeIsRefused) {
  const TemporaryFolder folder;
  const auto upgrading = [&](const std::string& nodes) {
    return upgrade_of({folder.write("m.pxn", "<pangu_model ver='0'>" + nodes + "</pangu_model>")});
  };
  // braces are expressions in level 1
  const Upgrading braces = upgrading(frame_s("a{1}", "0 0 1", "0 -1 0", "1 0 0"));
  EXPECT_FALSE(braces.files);
  EXPECT_EQ(braces.count(Code("E1317")), 1u) << to_text(braces.log);
  const Upgrading unknown = upgrading(frame_s("a{x", "0 0 1", "0 -1 0", "1 0 0"));
  EXPECT_FALSE(unknown.files);
  EXPECT_EQ(unknown.count(Code("E1317")), 1u) << to_text(unknown.log);
  // errors come first
  const Upgrading wrong = upgrading("<spere/>");
  EXPECT_FALSE(wrong.files);
  EXPECT_EQ(wrong.count(Code("E1101")), 1u);
  EXPECT_FALSE(upgrade_of({folder / "none.pxn"}).files);
}

TEST(Upgrade, ShippedFiles) {
  std::size_t upgraded_files = 0;
  for (const char* folder : {"/examples/paper", "/tests/pxn/data/good"})
    for (const auto& entry : fs::directory_iterator(std::string(PANWRIGHT_SOURCE_DIR) + folder)) {
      if (entry.path().extension() != ".pxn") continue;
      const Upgrading u = upgrade_of({entry.path().string()});
      ASSERT_TRUE(u.files) << entry.path() << to_text(u.log);
      if ((*u.files)[0].text.empty()) continue;
      ++upgraded_files;
      EXPECT_THAT((*u.files)[0].text, HasSubstr("ver=\"1\""));
      for (const char* gone : {"<scaling", "<rotate>", "<frame_s", "type=\"pxn\""})
        EXPECT_THAT((*u.files)[0].text, Not(HasSubstr(gone))) << entry.path();
    }
  EXPECT_GE(upgraded_files, 10u);
}

// Random trees of level 0 against a reading of their own: not the comparison within upgraded().
class Author {
 public:
  explicit Author(std::uint32_t seed) : random_(seed) {}

  std::string nodes(int depth) {
    std::string out;
    for (std::uint32_t n = 1 + below(3); n > 0; --n) out += node(depth);
    return out;
  }

 private:
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  std::string number() { return std::to_string((static_cast<double>(below(20000)) - 1e4) / 777); }
  std::string vector() { return " " + number() + " " + number() + "\n" + number() + " "; }
  std::string comment() { return below(3) == 0 ? " <!-- c -->\n" : ""; }
  std::string child(int depth) {
    return "<child>" + comment() +
           (below(2) == 0 ? "<group>" + nodes(depth) + "</group>" : node(depth)) + "</child>";
  }
  std::string node(int depth) {
    const std::string text = comment();
    switch (depth > 5 ? 0 : below(6)) {
      case 1:
        return text + "<transform>" + (below(2) == 0 ? "<scaling>1 2.5 -3</scaling>" : "") +
               comment() + child(depth + 1) +
               (below(2) == 0 ? "<rotation>" + vector() + "</rotation>" : "") +
               (below(2) == 0 ? "<translation>" + vector() + "</translation>" : "") +
               "</transform>";
      case 2:
        return text + "<rotate>" + child(depth + 1) + "<quat>0.1826 0.3651 0.5477 0.7303</quat>" +
               comment() + "</rotate>";
      case 3:
        return "<appearance>" + child(depth + 1) + "<material><diffuse>0.1 0.2 0." +
               std::to_string(below(9)) + "</diffuse></material></appearance>";
      case 4:
        return "<group>" + nodes(depth + 1) + "</group>";
      case 5:
        return frame_s("f" + std::to_string(frames_++), "0.6 0 0.8", "0 -1 0", "0.8 0 -0.6");
      default:
        return text + "<sphere rings='" + std::to_string(2 + below(3)) + "' quads='3'/>";
    }
  }

  std::mt19937 random_;
  int frames_ = 0;
};

TEST(Upgrade, RandomTreesLookTheSame) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 200 && !HasFailure(); ++seed) {
    const std::string text = "<pangu_model ver='0'>" + Author(seed).nodes(0) + "</pangu_model>";
    const Upgrading u = upgrade_of({folder.write("m.pxn", text)});
    ASSERT_TRUE(u.files) << "seed " << seed << to_text(u.log) << text;
    const Reading before = read_files({{"m.pxn", text}});
    const Reading after = read_files({{"m.pxn", (*u.files)[0].text}});
    ASSERT_TRUE(before.scene && after.scene);
    EXPECT_FALSE(after.log.has_errors()) << after.summary();
    EXPECT_EQ(scene_difference(*before.scene, *after.scene, Likeness::looks), "") << text;
    const auto comments = [](const std::string& s) {
      std::size_t n = 0;
      for (std::size_t at = s.find("<!--"); at != std::string::npos; at = s.find("<!--", at + 1))
        ++n;
      return n;
    };
    EXPECT_EQ(comments((*u.files)[0].text), comments(text)) << text;
  }
}

}  // namespace
}  // namespace panwright::pxn::upgrade_test
