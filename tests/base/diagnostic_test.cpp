#include "base/diagnostic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace panwright::diagnostic_test {
namespace {

using testing::HasSubstr;

constexpr std::array<std::string_view, 4> kNames = {"diffuse", "specular", "emissive", "refract"};

struct Sample {
  DiagnosticLog log;
  FileId top;
  FileId part;
  Sample() {
    top = log.sources().add(
        {"top.pxn", text("<a>\n  <include file=\"part.pxn\"/>\n</a>"), Encoding::utf8, {}});
    part = log.sources().add(
        {"part.pxn", text("<b>\n\t<difuse> 1 </difuse>\n</b>"), Encoding::utf8, {top, 6, 32}});
  }
  static std::shared_ptr<const std::string> text(std::string s) {
    return std::make_shared<const std::string>(std::move(s));
  }
};

TEST(Diagnostics, ExceptionsHaveCodesAndExitCodes) {
  const auto reported = [](const auto& exception) {
    DiagnosticLog log;
    try {
      throw exception;
    } catch (const std::exception&) {
      report_exception(log);
    }
    return std::pair(log.entries().at(0).code, exit_code(log));
  };
  const std::pair memory(Code("E0002"), 1), internal(Code("E0003"), 70);
  EXPECT_EQ(reported(std::bad_alloc()), memory);
  EXPECT_EQ(reported(std::system_error(EAGAIN, std::generic_category())), memory);
  EXPECT_EQ(reported(std::system_error(EIO, std::generic_category())), internal);
  EXPECT_EQ(reported(std::out_of_range("at")), internal);
}

TEST(Registry, CodesAreUniqueAndExplained) {
  std::set<std::string_view> names;
  for (const CodeInfo& info : all_codes()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(info.name.size(), 5u);
    EXPECT_NE(std::string_view("EWN").find(info.name[0]), std::string_view::npos);
    EXPECT_FALSE(info.title.empty());
    EXPECT_GE(info.explanation.size(), 20u) << info.name;
    EXPECT_EQ(info.explanation.back(), '.') << info.name;
    EXPECT_EQ(code_info(*code_from_name(info.name)).name, info.name);
  }
  EXPECT_EQ(code_from_name("e1101"), Code("E1101"));
  EXPECT_FALSE(code_from_name("E9999"));
}

TEST(ToText, ShowsPlaceLineCaretHintAndIncludes) {
  Sample s;
  s.log.report(Code("E1101"), {s.part, 6, 12}, "unknown element 'difuse' in <material>",
               "did you mean 'diffuse'?");
  EXPECT_EQ(to_text(s.log),
            "part.pxn:2:3: error: unknown element 'difuse' in <material> [E1101]\n"
            "     2 |  <difuse> 1 </difuse>\n"
            "       |   ^~~~~~\n"
            "    did you mean 'diffuse'?\n"
            "    included from top.pxn:2:3\n");
  EXPECT_THAT(to_text(s.log, {.color = true}), HasSubstr("\x1b[1;31m"));
}

TEST(ToText, CutsLongLinesAroundTheCaret) {
  DiagnosticLog log;
  std::string line(5000, 'x');
  line[4000] = '?';
  const FileId f = log.sources().add({"f", Sample::text(line), Encoding::utf8, {}});
  log.report(Code("E1001"), {f, 4000, 4001}, "m");
  const std::string text = to_text(log);
  EXPECT_LT(text.size(), 400u);
  // the caret stands below the question mark
  const std::size_t first = text.find('\n') + 1, second = text.find('\n', first) + 1;
  const auto column = [&](std::size_t from, std::string_view what) {
    std::size_t count = 0;
    for (std::size_t i = from; text.compare(i, what.size(), what) != 0; ++i)
      count += (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80;
    return count;
  };
  EXPECT_EQ(column(first, "?"), column(second, "^"));
}

TEST(DiagnosticLog, KeepsFiftyErrorsAndCountsTheRest) {
  DiagnosticLog log;
  for (int i = 0; i < 70; ++i) log.report(Code("E1201"), {}, "m");
  log.report(Code("W1205"), {}, "w");
  EXPECT_EQ(log.errors(), 70u);
  EXPECT_EQ(log.entries().size(), 51u);
  EXPECT_EQ(log.hidden(), 20u);
  EXPECT_THAT(to_text(log), HasSubstr("20 more problems not shown"));
}

TEST(DiagnosticLog, SortsByPlace) {
  Sample s;
  s.log.report(Code("E1201"), {}, "nowhere");
  s.log.report(Code("E1201"), {s.part, 6, 12}, "third");
  s.log.report(Code("E1201"), {s.top, 9, 12}, "second");
  s.log.report(Code("E1201"), {s.top, 2, 12}, "first");
  s.log.sort_by_place();
  std::string order;
  for (const Diagnostic& entry : s.log.entries()) order += entry.message + " ";
  EXPECT_EQ(order, "first second third nowhere ");
}

TEST(ExitCode, FollowsTheKindOfError) {
  const auto of = [](std::initializer_list<Code> codes) {
    DiagnosticLog log;
    for (const Code code : codes) log.report(code, {}, "m");
    return exit_code(log);
  };
  EXPECT_EQ(of({}), 0);
  EXPECT_EQ(of({Code("W1205")}), 0);
  EXPECT_EQ(of({Code("E1101")}), 1);
  EXPECT_EQ(of({Code("E0201")}), 2);
  EXPECT_EQ(of({Code("E0101")}), 3);
  EXPECT_EQ(of({Code("E4009")}), 4);
  EXPECT_EQ(of({Code("E9611")}), 4);
  EXPECT_EQ(of({Code("E1101"), Code("E0103")}), 3);
}

TEST(ToJson, HoldsTheSameFacts) {
  Sample s;
  s.log.report(Code("E1101"), {s.part, 6, 12}, "m", "h", "a/b");
  s.log.report_file(Code("E4001"), "f\xff.pan", "not a pan file");
  const auto json = nlohmann::json::parse(to_json(s.log));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["errors"], 2);
  const auto& first = json["diagnostics"][0];
  EXPECT_EQ(first["code"], "E1101");
  EXPECT_EQ(first["file"], "part.pxn");
  EXPECT_EQ(first["line"], 2);
  EXPECT_EQ(first["column"], 3);
  EXPECT_EQ(first["end_column"], 9);
  EXPECT_EQ(first["included_from"][0]["file"], "top.pxn");
  EXPECT_EQ(first["object"], "a/b");
  EXPECT_FALSE(json["diagnostics"][1].contains("line"));
}

TEST(ToSarif, IsAVersion210Log) {
  Sample s;
  s.log.report(Code("E1101"), {s.part, 6, 12}, "m", "h");
  s.log.report(Code("E1101"), {s.top, 0, 3}, "m2");
  s.log.report(Code("W1205"), {}, "w");
  const auto json = nlohmann::json::parse(to_sarif(s.log));
  EXPECT_EQ(json["version"], "2.1.0");
  const auto& run = json["runs"][0];
  EXPECT_EQ(run["tool"]["driver"]["rules"].size(), 2u);
  EXPECT_EQ(run["results"].size(), 3u);
  EXPECT_EQ(run["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"], 2);
  EXPECT_EQ(run["results"][0]["relatedLocations"].size(), 1u);
  EXPECT_EQ(run["results"][2]["level"], "warning");
  EXPECT_EQ(run["results"][2]["ruleIndex"], 1);
}

TEST(NearestName, AllowsOneErrorInThreeLetters) {
  EXPECT_EQ(nearest_name("difuse", kNames), "diffuse");
  EXPECT_EQ(nearest_name("Diffuse", kNames), "diffuse");
  EXPECT_EQ(nearest_name("dfifuse", kNames), "diffuse");
  EXPECT_EQ(nearest_name("refrcat", kNames), "refract");
  EXPECT_FALSE(nearest_name("sphere", kNames));
  EXPECT_FALSE(nearest_name("", kNames));
  const std::string_view options[] = {"--output", "--sun", "--size", "--samples", "--sampling"};
  EXPECT_EQ(nearest_name("--out", options), "--output");
  EXPECT_EQ(nearest_name("--sundirection", options), "--sun");
  EXPECT_FALSE(nearest_name("--sampl", std::span(options, 3)));
  EXPECT_FALSE(nearest_name("--sa", options)) << "two begin like it";
  const std::string_view letters[] = {"D", "W"};
  EXPECT_FALSE(nearest_name("Q", letters));
  EXPECT_EQ(nearest_name("d", letters), "D");
  EXPECT_FALSE(nearest_name(std::string(100000, 'd'), kNames));
  const std::vector<std::string_view> joints = {"left/inner/hinge", "right/hinge", "right/slew"};
  EXPECT_EQ(nearest_name("slew", joints), "right/slew");
  EXPECT_EQ(nearest_name("wings/slew", joints), "right/slew");
  EXPECT_FALSE(nearest_name("hinge", joints)) << "two end like it";
  EXPECT_FALSE(nearest_name("boom/", joints));
  const std::string_view presets[] = {"mli_gold_kapton", "mli_kapton_tape", "osr_silica"};
  EXPECT_EQ(nearest_name("gold_kapton", presets), "mli_gold_kapton");
  EXPECT_EQ(nearest_name("tape_kapton", presets), "mli_kapton_tape");
  EXPECT_FALSE(nearest_name("kapton", presets)) << "two have the word";
  EXPECT_FALSE(nearest_name("gold_paint", presets)) << "none has both";
}

}  // namespace
}  // namespace panwright::diagnostic_test
