// Changes that are not saved yet.
#include "studio/edits.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

const std::string kText =
    "<pangu_model ver=\"1\">\n  <!-- a -->\n  <material name=\"m\">\n    <diffuse>  0.1 0.2   0.3 "
    "</diffuse> <!-- b -->\n  </material>\n</pangu_model>\n";

class EditsTest : public testing::Test {
 protected:
  EditsTest() : path_(folder_.write("a.pxn", kText)) { edits_.look({path_}); }
  void change(std::size_t number, double value) {
    const MaterialFile file = edits_.files().at(0);
    edits_.change(file, file.materials.at(0), file.materials[0].numbers.at(number), value);
  }
  const std::string& text() const { return edits_.files().at(0).text; }
  support::TemporaryFolder folder_;
  std::string path_;
  Edits edits_;
};

TEST_F(EditsTest, ChangesOfOneNumberAreUndoneTogether) {
  change(0, 0.5);
  change(0, 0.6);
  edits_.close();
  change(1, 0.9);
  EXPECT_EQ(edits_.size(), 2u);
  EXPECT_NE(text().find("  0.6 0.9   0.3 "), std::string::npos) << text();
  const auto difference = edits_.difference();
  ASSERT_EQ(difference.size(), 1u);
  ASSERT_EQ(difference[0].second.size(), 1u);
  EXPECT_EQ(difference[0].second[0].number, 4u);
  EXPECT_TRUE(edits_.undo());
  EXPECT_NE(text().find("  0.6 0.2   0.3 "), std::string::npos);
  EXPECT_TRUE(edits_.undo());
  EXPECT_EQ(text(), kText);
  EXPECT_TRUE(edits_.unsaved().empty());
  EXPECT_FALSE(edits_.undo());
}

TEST_F(EditsTest, SavesWhatIsShown) {
  change(2, 0.75);
  DiagnosticLog log;
  EXPECT_TRUE(edits_.save(log)) << to_text(log);
  EXPECT_FALSE(edits_.any());
  std::string expected = kText;
  expected.replace(expected.find("0.3 "), 3, "0.75");
  EXPECT_EQ(support::contents(path_), expected);
}

// Somebody else changes the file meanwhile: the changes go on in what it holds now.
TEST_F(EditsTest, SurvivesOtherEditors) {
  change(0, 0.5);
  folder_.write("a.pxn", "<!-- longer -->\n" + kText);
  DiagnosticLog log;
  EXPECT_FALSE(edits_.save(log));  // not looked at since
  EXPECT_EQ(support::contents(path_), "<!-- longer -->\n" + kText);
  EXPECT_TRUE(edits_.any());
  edits_.look({path_});
  EXPECT_NE(text().find("<!-- longer -->"), std::string::npos);
  EXPECT_NE(text().find("  0.5 0.2"), std::string::npos);
  // half-written for a moment
  folder_.write("a.pxn", "<pangu_mo");
  edits_.look({path_});
  EXPECT_TRUE(edits_.any());
  folder_.write("a.pxn", kText);
  edits_.look({path_});
  EXPECT_TRUE(edits_.any());
  // the material is gone
  folder_.write("a.pxn", "<pangu_model ver=\"1\"/>\n");
  edits_.look({path_});
  EXPECT_FALSE(edits_.any());
  EXPECT_NE(edits_.said(), "");
}

TEST_F(EditsTest, FileThatCannotBeWritten) {
  change(0, 0.5);
  std::filesystem::remove(path_);
  DiagnosticLog log;
  EXPECT_FALSE(edits_.save(log));
  EXPECT_TRUE(log.has_errors());
  EXPECT_TRUE(edits_.any());
}

}  // namespace
}  // namespace panwright::studio
