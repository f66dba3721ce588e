// Numbers of materials changed where they stand: against a search of the text by hand.
#include "pxn/edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>

#include "pxn/pxn.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::edit_test {
namespace {

// By hand: the n-th word of the first element of that name behind the material's.
std::string replaced(std::string text, const std::string& material, const EditableNumber& number,
                     const std::string& word) {
  std::size_t at = text.find("<material name=\"" + material + "\"");
  if (at == text.npos) at = text.find("name=\"" + material + "\"");
  at = text.find("<" + number.element, at);
  if (number.attribute.empty()) {
    at = text.find('>', at) + 1;
  } else {
    at = text.find(" " + number.attribute + "=", at);
    at = text.find_first_of("\"'", at) + 1;
  }
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == ','; };
  for (std::size_t i = 0;; ++i) {
    while (blank(text[at])) ++at;
    std::size_t end = at;
    while (std::string_view("0123456789.eE+-").find(text[end]) != std::string_view::npos) ++end;
    if (i == number.index) return text.replace(at, end - at, word);
    at = end;
    while (!blank(text[at])) ++at;
  }
}

TEST(Edit, AThousandChangesLeaveAllElse) {
  std::vector<std::string> texts;
  for (const auto& each :
       std::filesystem::recursive_directory_iterator(PANWRIGHT_SOURCE_DIR "/examples"))
    if (each.path().extension() == ".pxn") texts.push_back(support::contents(each.path().string()));
  std::mt19937 random(7);
  std::size_t changes = 0, numbers = 0;
  for (const std::string& text : texts) {
    DiagnosticLog log;
    const auto found = editable_materials("a.pxn", text, log);
    if (found)
      for (const EditableMaterial& material : *found) numbers += material.numbers.size();
  }
  ASSERT_GT(numbers, 200u);
  while (changes < 1000) {
    const std::string& text = texts[random() % texts.size()];
    DiagnosticLog log;
    const auto found = editable_materials("a.pxn", text, log);
    if (!found || found->empty()) continue;
    const EditableMaterial& material = (*found)[random() % found->size()];
    if (material.numbers.empty()) continue;
    // of two elements of one name the search by hand finds the first alone
    const EditableNumber& number = material.numbers[random() % material.numbers.size()];
    std::size_t alike = 0;
    for (const EditableNumber& other : material.numbers)
      alike += other.element == number.element && other.attribute == number.attribute &&
               other.index == number.index;
    if (alike != 1) continue;
    EXPECT_GE(number.value, number.low);
    EXPECT_LE(number.value, number.high);
    const double value = std::ldexp(static_cast<double>(random() % 4096), -12);
    const std::string edited = with_number(text, number, value);
    char word[32];
    std::snprintf(word, sizeof word, number.integer ? "%.0f" : "%.6g",
                  number.integer ? std::round(value) : value);
    EXPECT_EQ(edited, replaced(text, material.name, number, word)) << material.name;
    const auto again = editable_materials("a.pxn", edited, log);
    ASSERT_TRUE(again) << to_text(log);
    EXPECT_EQ(again->size(), found->size());
    ++changes;
  }
}

// What is not saved yet makes the same scene as a file that holds it, in included files too.
TEST(Edit, UnsavedTextsStandInForFiles) {
  const support::TemporaryFolder folder;
  const std::string part =
      "<pangu_model ver=\"1\"><material name=\"m\"><diffuse> 0.1 0.2 0.3 "
      "</diffuse></material></pangu_model>";
  const std::string included = folder.write("part.pxn", part);
  const std::string top = folder.write("top.pxn",
                                       "<pangu_model ver=\"1\"><include file=\"part.pxn\"/><sphere "
                                       "radius=\"1\" material=\"m\"/></pangu_model>");
  DiagnosticLog log;
  const auto found = editable_materials(included, part, log);
  ASSERT_TRUE(found && (*found)[0].numbers.size() == 3);
  const std::string edited = with_number(part, (*found)[0].numbers[1], 0.75);
  const std::map<std::filesystem::path, std::shared_ptr<const std::string>> unsaved = {
      {std::filesystem::canonical(included), std::make_shared<const std::string>(edited)}};
  Options options;
  options.unsaved = &unsaved;
  const auto scene = read(top, options, log);
  ASSERT_TRUE(scene && !log.has_errors()) << to_text(log);
  const auto before = read(top, {}, log);
  folder.write("part.pxn", edited);
  const auto after = read(top, {}, log);
  const auto green = [](const auto& of) {
    double most = 0;
    for (const auto& material : of->materials) most = std::max(most, double{material.diffuse.y});
    return most;
  };
  EXPECT_EQ(green(scene), 0.75);
  EXPECT_EQ(green(before), 0.2);
  EXPECT_EQ(green(after), 0.75);
  EXPECT_EQ(scene->inputs.size(), after->inputs.size());
}

TEST(Edit, FoilsByTheirOperations) {
  const std::string text =
      "<pangu_model ver=\"1\"><mli name=\"door\" type=\"flat\" seed=\"7\" translate=\"1 2 "
      "3\"><mli_settings> <width> 0.5m </width>"
      " <xgrid> 20 </xgrid> </mli_settings><mli_operations> <crease density=\"300\" depth=\"2mm\" "
      "length=\"{1mm*9}\"/>"
      "<smooth> 4 </smooth><crease density=\"50\" depth=\"1mm\" "
      "length=\"9mm\"/></mli_operations></mli>"
      "<mli type=\"flat\"><mli_operations preset=\"crinkled\"/></mli><mli "
      "type=\"flat\"><mli_operations preset=\"smooth\"/></mli>"
      "</pangu_model>";
  DiagnosticLog log;
  const auto found = editable_foils("a.pxn", text, log);
  ASSERT_TRUE(found) << to_text(log);
  ASSERT_EQ(found->size(), 3u);
  EXPECT_EQ((*found)[0].name, "door");
  EXPECT_EQ((*found)[1].name, "foil");
  EXPECT_EQ((*found)[2].name, "foil 2");
  EXPECT_TRUE((*found)[1].numbers.empty());
  std::vector<std::string> names;
  for (const EditableNumber& number : (*found)[0].numbers)
    names.push_back(number.element + " " + number.attribute + "=" +
                    text.substr(number.begin, number.end - number.begin) + number.unit);
  EXPECT_THAT(names,
              ::testing::ElementsAre("mli seed=7", "width =0.5m", "xgrid =20", "crease density=300",
                                     "crease depth=2mm", "smooth =4", "crease 2 density=50",
                                     "crease 2 depth=1mm", "crease 2 length=9mm"));
  EXPECT_EQ(with_number(text, (*found)[0].numbers[7], 2.5), [&] {
    std::string other = text;
    return other.replace(other.find("depth=\"1mm") + 7, 1, "2.5");
  }());
  EXPECT_TRUE((*found)[0].numbers[0].integer);
  // materials are not foil, and foil is no material
  const auto materials = editable_materials("a.pxn", text, log);
  ASSERT_TRUE(materials);
  EXPECT_TRUE(materials->empty());
}

TEST(Edit, NoNumbersWhereNoneStand) {
  DiagnosticLog log;
  const auto found = editable_materials(
      "a.pxn",
      "<pangu_model ver='1'><param name='a' value='1'/><material name='m'>"
      "<diffuse> {a} 0.2 0.3 </diffuse><specular shine='30'> 1 <!-- x --> 1 1 </specular>"
      "<oren> 20deg </oren><emissive> 1 &#49; 1 </emissive></material><material name='n'/>"
      "</pangu_model>",
      log);
  ASSERT_TRUE(found) << to_text(log);
  ASSERT_EQ(found->size(), 2u);
  std::vector<std::string> places;
  for (const EditableNumber& each : (*found)[0].numbers)
    places.push_back(each.element + " " + each.attribute + each.unit);
  EXPECT_THAT(places, testing::ElementsAre("specular shine", "oren deg"));
  for (const char* bad :
       {"", "<a>", "<pangu_model ver='1'><material", "\xff\xfe", "<pangu_model ver='9'/>"})
    EXPECT_FALSE(editable_materials("a.pxn", bad, log)) << bad;
}

}  // namespace
}  // namespace panwright::pxn::edit_test
