// Unsaved changes of materials.
#include "studio/edits.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "compiler/compile.h"
#include "pxn/edit.h"
#include "pxn/pxn.h"
#include "tests/support/process.h"

namespace panwright::studio {
namespace {

const std::string kEditedText =
    "<pangu_model ver=\"1\">\n  <!-- a -->\n  <material name=\"m\">\n    <diffuse>  0.1 0.2   0.3 "
    "</diffuse> <!-- b -->\n  </material>\n</pangu_model>\n";

class EditsTest : public testing::Test {
 protected:
  EditsTest() : path_(folder_.write("a.pxn", kEditedText)) { edits_.update({path_}); }
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
  EXPECT_EQ(text(), kEditedText);
  EXPECT_TRUE(edits_.unsaved().empty());
  EXPECT_FALSE(edits_.undo());
}

// A number of a preset: its element is written into the text, once for all of its numbers.
TEST(EditsOfPresets, WriteTheElementIntoTheText) {
  const support::TemporaryFolder folder;
  for (const bool open : {false, true}) {
    const std::string start = "<pangu_model ver=\"1\">\n<material name=\"m\" preset=\"cells_gaas\"";
    const std::string text = start + (open ? ">\n  <ggx> 0.2 </ggx>\n</material>" : "/>") +
                             "\n<box size=\"1\" material=\"m\"/>\n</pangu_model>\n";
    const std::string path = folder.write("p.pxn", text);
    Edits edits;
    edits.update({path});
    const auto change = [&](const char* element, std::size_t index, double value) {
      const MaterialFile file = edits.files().at(0);
      for (const auto* numbers : {&file.materials.at(0).numbers, &file.materials[0].inherited})
        for (const pxn::EditableNumber& number : *numbers)
          if (number.element == element && number.index == index && number.attribute.empty())
            return edits.change(file, file.materials[0], number, value);
      FAIL() << element;
    };
    for (const pxn::EditableNumber& number : edits.files()[0].materials.at(0).inherited)
      EXPECT_NE(number.element, open ? "ggx" : "provenance");
    change("diffuse", 2, 0.9);
    change("diffuse", 0, 0.4);
    edits.close();
    EXPECT_EQ(edits.files()[0].text,
              open ? start + ">\n  <ggx> 0.2 </ggx>\n<diffuse> 0.4 0.25 0.9 </diffuse></material>" +
                         "\n<box size=\"1\" material=\"m\"/>\n</pangu_model>\n"
                   : start + "><diffuse> 0.4 0.25 0.9 </diffuse></material>" +
                         "\n<box size=\"1\" material=\"m\"/>\n</pangu_model>\n");
    const std::vector<pxn::MemoryFile> files = {{"p.pxn", edits.files()[0].text}};
    DiagnosticLog log;
    const auto scene = pxn::read_memory(files, {}, log);
    ASSERT_TRUE(scene) << to_text(log);
    EXPECT_EQ(log.errors() + log.warnings(), 0u) << to_text(log);
    EXPECT_EQ(scene->materials.at(0).diffuse, Vec3(0.4, 0.25, 0.9));
    EXPECT_TRUE(edits.undo());
    EXPECT_TRUE(edits.undo());
    EXPECT_EQ(edits.files()[0].text, text);
  }
}

TEST_F(EditsTest, SavesTheEditedText) {
  change(2, 0.75);
  DiagnosticLog log;
  EXPECT_TRUE(edits_.save(log)) << to_text(log);
  EXPECT_FALSE(edits_.any());
  std::string expected = kEditedText;
  expected.replace(expected.find("0.3 "), 3, "0.75");
  EXPECT_EQ(support::contents(path_), expected);
}

// Another program changes the file: the edits apply to its new text.
TEST_F(EditsTest, SurvivesOtherEditors) {
  change(0, 0.5);
  folder_.write("a.pxn", "<!-- longer -->\n" + kEditedText);
  DiagnosticLog log;
  EXPECT_FALSE(edits_.save(log));  // not updated since
  EXPECT_EQ(support::contents(path_), "<!-- longer -->\n" + kEditedText);
  EXPECT_TRUE(edits_.any());
  edits_.update({path_});
  EXPECT_NE(text().find("<!-- longer -->"), std::string::npos);
  EXPECT_NE(text().find("  0.5 0.2"), std::string::npos);
  // half-written for a moment
  folder_.write("a.pxn", "<pangu_mo");
  edits_.update({path_});
  EXPECT_TRUE(edits_.any());
  folder_.write("a.pxn", kEditedText);
  edits_.update({path_});
  EXPECT_TRUE(edits_.any());
  // the material is gone
  folder_.write("a.pxn", "<pangu_model ver=\"1\"/>\n");
  edits_.update({path_});
  EXPECT_FALSE(edits_.any());
  EXPECT_NE(edits_.message(), "");
}

TEST_F(EditsTest, FileThatCannotBeWritten) {
  change(0, 0.5);
  std::filesystem::remove(path_);
  DiagnosticLog log;
  EXPECT_FALSE(edits_.save(log));
  EXPECT_TRUE(log.has_errors());
  EXPECT_TRUE(edits_.any());
}

// A thousand numbers typed into a text: each makes the pan file that the scene makes whose material
// has that number.
TEST(EditedTexts, CompileAsIfSetDirectly) {
  const std::string text =
      "<pangu_model ver=\"1\">\n<material name=\"m\">\n  <diffuse> 0.3 0.2 0.1 </diffuse> <!-- "
      "paint -->\n"
      "  <specular>0.9\t0.8 0.7</specular>\n  <emissive> 0.01 .02 3e-2 </emissive>\n  <reflect> "
      "0.5 0.4 0.1 </reflect>\n"
      "  <ggx> 0.2 </ggx>\n  <coat n=\"1.5\" slope=\"0.1\"/>\n</material>\n"
      "<sphere radius=\"1\" rings=\"5\" quads=\"6\" material=\"m\"/>\n</pangu_model>\n";
  const auto read = [](const std::string& bytes, DiagnosticLog& log) {
    const std::vector<pxn::MemoryFile> files = {{"a.pxn", bytes}};
    return pxn::read_memory(files, {}, log);
  };
  DiagnosticLog log;
  const auto found = pxn::editable_materials("a.pxn", text, log);
  auto direct = read(text, log);
  ASSERT_TRUE(found && direct) << to_text(log);
  ASSERT_EQ(found->size(), 1u);
  const std::vector<pxn::EditableNumber>& numbers = (*found)[0].numbers;
  ASSERT_EQ(numbers.size(), 15u);
  const materials::Material before = direct->materials[0];
  std::mt19937 random(11);
  for (int change = 0; change < 1000; ++change) {
    const pxn::EditableNumber& number = numbers[random() % numbers.size()];
    double value = std::ldexp(static_cast<double>(1 + random() % 4095), -12);
    if (number.element == "coat" && number.attribute == "n") value += 1;
    if (number.element == "reflect") value *= 0.1;  // more than 1 in all is refused
    // as the text has it
    value = std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
    materials::Material& material = direct->materials[0];
    material = before;
    const auto k = static_cast<int>(number.index);
    if (number.element == "diffuse") material.diffuse[k] = value;
    if (number.element == "specular") material.specular[k] = value;
    if (number.element == "emissive") material.emissive[k] = value;
    if (number.element == "reflect") material.weights[k] = value;
    if (number.element == "ggx")
      material.specular_brdf = materials::with_slopes(materials::SpecularModel::ggx, Vec2(value));
    if (number.element == "coat")
      (number.attribute == "n" ? material.coat->index : material.coat->alpha) = value;
    materials::fit(material);
    DiagnosticLog ignored;
    auto edited = read(pxn::with_number(text, number, value), ignored);
    ASSERT_TRUE(edited && !ignored.has_errors()) << to_text(ignored);
    // the file records its text
    edited->inputs = direct->inputs;
    const auto a = compiler::compiled(*edited, {}, ignored);
    const auto b = compiler::compiled(*direct, {}, ignored);
    ASSERT_TRUE(a && b) << to_text(ignored);
    EXPECT_TRUE(*a == *b) << number.element << ' ' << number.attribute << ' ' << number.index << ' '
                          << value;
  }
}

}  // namespace
}  // namespace panwright::studio
