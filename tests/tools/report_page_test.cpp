// HTML pages of reports.

#include "tools/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::report_page_test {
namespace {

using nlohmann::json;
using support::contents;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

// The report in a page; discarded if there is none.
json report_of(const std::string& page) {
  const std::string mark = "id=\"report\">";
  const std::size_t start = page.find(mark) + mark.size();
  return json::parse(page.substr(start, page.find("</script>", start) - start), nullptr, false);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t out = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++out;
  return out;
}

TEST(ReportPage, HoldsAnyTextAsData) {
  const std::string hostile = "</script><script>alert('&\"\\')</script><!-- \xe2\x80\xa8 \xff";
  const auto page_of = [](const std::string& text) {
    return tools::report_page(text, {{"a", text}, {"b", {{text, text}}}, {"c", {{{"d", text}}}}});
  };
  const std::string page = page_of(hostile);
  for (const char* part : {"</script>", "<script", "<!--", "\xe2\x80\xa8", "\xff"})
    EXPECT_EQ(count(page, part), count(page_of(""), part)) << part;
  EXPECT_EQ(report_of(page)["title"], hostile.substr(0, hostile.size() - 1) + "\xef\xbf\xbd");
}

TEST(ReportPage, NeedsNothingElse) {
  const std::string page = tools::report_page("", nlohmann::ordered_json::object());
  for (const char* part : {"://", "src=", "href=", "@"}) EXPECT_THAT(page, Not(HasSubstr(part)));
}

TEST(ReportPage, OfABudget) {
  const TemporaryFolder folder;
  const std::string model =
      folder.write("<b>.pxn",
                   "<pangu_model ver=\"1\"><sphere radius=\"1\" name=\"&lt;i>\"/>"
                   "</pangu_model>");
  const auto compile = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {PANWRIGHT_BIN_DIR "/panwright",
                                      "compile",
                                      model,
                                      "-o",
                                      folder / "a.pan",
                                      "--budget-report",
                                      folder / "r.html"};
    words.insert(words.end(), more.begin(), more.end());
    const support::Outcome done = support::run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    const json out = report_of(contents(folder / "r.html"));
    EXPECT_EQ(out["title"], "<b>.pxn: budget");
    return out;
  };
  EXPECT_THAT(compile({})["asked_and_achieved"].dump(), HasSubstr("no budget"));
  const json report = compile({"--budget", "nearest=1km ifov=0.1mrad pixels=0.25"});
  EXPECT_EQ(report["asked_and_achieved"].size(), 2u) << "camera, silhouettes";
  ASSERT_EQ(report["parts"].size(), 1u);
  const json& part = report["parts"][0];
  EXPECT_EQ(part["triangles"], report["summary"]["triangles"]);
  EXPECT_GT(part["share_of_tolerance"], 0.0);
  EXPECT_LE(part["share_of_tolerance"], 1.0);
}

}  // namespace
}  // namespace panwright::report_page_test
