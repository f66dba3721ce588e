// Files made to hurt: each gives a positioned diagnostic, soon and in bounded memory.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "base/clock.h"
#include "tests/pxn/reading.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::pxn::hostile_test {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

std::string repeated(const std::string& text, std::size_t count) {
  std::string out;
  out.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) out += text;
  return out;
}

double processor_seconds(std::clock_t since) {
  return static_cast<double>(std::clock() - since) / CLOCKS_PER_SEC;
}

// How many times longer work of this kind, strings and a sort, takes now than on the machine of the
// bounds: other work slows processors down too.
double slowness() {
  const std::clock_t start = std::clock();
  std::vector<std::string> all;
  for (unsigned i = 0; i < 100000; ++i)
    all.push_back(std::to_string(i * 2654435761u) + " and more than a small string holds");
  std::ranges::sort(all);
  return std::max(1.0, processor_seconds(start) / 0.3);
}

Reading timed(const std::string& bytes, double seconds, const Options& options = {}) {
  const std::clock_t start = std::clock();
  Reading r = read_files({{"m.pxn", bytes}}, options);
  const double took = processor_seconds(start);
#ifdef PANWRIGHT_SANITIZED
  seconds *= 20;
#endif
  // a bound on growth, many times what is measured: a quadratic step would pass it by far
  EXPECT_TRUE(took < seconds || took < seconds * slowness()) << took << " s";
  return r;
}

TEST(Hostile, NestingOfAHundredThousand) {
  const std::size_t n = 100000;
  const std::string open = repeated("<group>", n);
  // measured 2 ms
  const Reading closed =
      timed("<pangu_model ver=\"0\">" + open + repeated("</group>", n) + "</pangu_model>", 1);
  EXPECT_EQ(closed.summary(), "1:1808 E1006 'group' is nested deeper than 256 elements\n");
  // not closed at all
  const Reading cut = timed("<pangu_model ver=\"0\">" + open, 1);
  EXPECT_THAT(cut.summary(), HasSubstr("1:1808 E1006"));
  EXPECT_EQ(cut.log.errors(), 2u);
}

TEST(Hostile, TwoHundredMegabytesOfText) {
  const support::TemporaryFolder folder;
  const std::string path = folder / "large.pxn";
  {
    std::FILE* file = std::fopen(path.c_str(), "w");
    ASSERT_NE(file, nullptr);
    ASSERT_EQ(std::fseek(file, 200l << 20, SEEK_SET), 0);
    std::fputs("x", file);
    std::fclose(file);
  }
  const auto start = Clock::now();
  const Reading r = read_path(path);
  EXPECT_LT(seconds_since(start), 1);
  EXPECT_FALSE(r.scene);
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E0104"});
}

TEST(Hostile, EntityBombs) {
  std::string bomb = "<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [\n<!ENTITY l0 \"lol\">\n";
  for (int i = 1; i < 10; ++i)
    bomb += "<!ENTITY l" + std::to_string(i) + " \"" +
            repeated("&l" + std::to_string(i - 1) + ";", 10) + "\">\n";
  bomb += "]>\n<pangu_model ver=\"0\">\n<group>&l9;</group></pangu_model>";
  const Reading r = timed(bomb, 0.5);
  EXPECT_THAT(r.summary(), HasSubstr("2:1 E1005 document types are not read"));
  EXPECT_THAT(r.summary(), HasSubstr("15:8 E1005 the entity '&l9;' is not read"));
  const Reading external = timed(
      "<!DOCTYPE a SYSTEM \"file:///etc/passwd\" [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>"
      "<pangu_model ver=\"0\"><frame_s label=\"&x;\"/></pangu_model>",
      0.5);
  EXPECT_EQ(external.codes().count("E1005"), 2u);
}

TEST(Hostile, WideEncodings) {
  const std::string text = "<?xml version=\"1.0\"?><pangu_model ver=\"0\"/>";
  for (const bool mark : {false, true})
    for (const int width : {2, 4})
      for (const bool little : {false, true}) {
        std::string bytes;
        const auto put = [&](std::uint32_t c) {
          for (int k = 0; k < width; ++k)
            bytes.push_back(static_cast<char>(c >> 8 * (little ? k : width - 1 - k)));
        };
        if (mark) put(0xfeff);
        for (const char c : text) put(static_cast<unsigned char>(c));
        const Reading r = timed(bytes, 0.5);
        EXPECT_FALSE(r.scene);
        EXPECT_THAT(r.summary(), HasSubstr(width == 2 ? "1:1 E1003 the file is UTF-16"
                                                      : "1:1 E1003 the file is UTF-32"));
      }
}

TEST(Hostile, ACommaDecimalLocale) {
  // a locale of our own making, since few machines have one installed
  const support::TemporaryFolder folder;
  const std::string source = folder.write(
      "source",
      "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3;3\nEND LC_NUMERIC\n");
  support::run({"localedef", "-c", "-i", source, folder / "comma"});
  setenv("LOCPATH", folder.path().c_str(), 1);
  ASSERT_NE(std::setlocale(LC_NUMERIC, "comma"), nullptr) << "Debian's package locales is needed";
  char printed[16];
  std::snprintf(printed, sizeof printed, "%.1f", 1.5);
  ASSERT_STREQ(printed, "1,5");
  const Reading r = read_nodes(
      "<transform><translation> 1.5 -2.25e1 0,5 </translation><child><group/></child></transform>"
      "<transform><translation> 1.5 -2.25e1 .5 </translation><child><group/></child></transform>");
  std::setlocale(LC_NUMERIC, "C");
  unsetenv("LOCPATH");
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E1201"});
  EXPECT_THAT(
      r.summary(),
      HasSubstr("commas in <translation>, expected decimal points (write 1.5 -2.25e1 0.5)"));
  ASSERT_TRUE(r.scene);
  EXPECT_EQ(r.scene->nodes[3].parent_from_node.translation, Vec3(1.5, -22.5, 0.5));
}

TEST(Hostile, AMillionProblems) {
  const std::string begin = "<pangu_model ver=\"0\">", end = "</pangu_model>";
  const std::size_t n = 1000000;
  // each kind of problem, on one line; measured 0.1 to 0.5 s
  for (const std::string& bad :
       {std::string("<a/>"), std::string("<sphere/>"), std::string("<group x='1'/>"),
        std::string("<group>x</group>"), std::string("<sphere rings='1' quads='x'/>"),
        std::string("<include type='pxn' file='x'/>")}) {
    const std::size_t count = bad.starts_with("<include") ? n / 100 : n;
    const Reading r = timed(begin + repeated(bad, count) + end, 8);
    EXPECT_GE(r.log.errors(), count) << bad;
    EXPECT_EQ(r.log.entries().size(), 50u);
  }
  // broken XML: the scanner gives up after a thousand
  for (const char* bad : {"<", "</", "</a>", "<a x", "<a x='<", "&", "<!", "<?", "]]>", "<a x=1/>",
                          "<![CDATA[", "<!--"}) {
    const Reading r = timed(begin + repeated(bad, n) + end, 8);
    EXPECT_TRUE(r.log.has_errors()) << bad;
    EXPECT_LE(r.log.errors(), n + 1001) << bad;
  }
}

TEST(Hostile, AMillionBadIndices) {
  const std::string strip = repeated("9 ", 1000000);
  const Reading r = timed("<pangu_model ver=\"0\"><mesh><positions/><tristrips><tristrip>" + strip +
                              "</tristrip></tristrips></mesh></pangu_model>",
                          2);
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E2001"});
  const Reading words =
      timed("<pangu_model ver=\"0\"><mesh><positions/><tristrips><tristrip>" +
                repeated("x ", 1000000) + "</tristrip></tristrips></mesh></pangu_model>",
            2);
  EXPECT_EQ(words.log.errors(), 1000000u);
}

TEST(Hostile, OneLineOfManyNodes) {
  // positions along a line of megabytes must not cost its length each; measured 0.3 s
  const Reading r =
      timed("<pangu_model ver=\"0\">" + repeated("<sphere rings=\"4\" quads=\"4\"/>", 300000) +
                "</pangu_model>",
            6);
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->instances.back().source.column, 22u + 299999 * 29);
}

TEST(Hostile, IncludesMultipliedOut) {
  Options options;
  options.limits.nodes = 5000;
  std::vector<MemoryFile> files;
  for (int i = 0; i < 20; ++i) {
    const std::string next = "<include type=\"pxn\" file=\"" + std::to_string(i + 1) + ".pxn\"/>";
    files.push_back(
        {std::to_string(i) + ".pxn", "<pangu_model ver=\"0\">" + next + next + "</pangu_model>"});
  }
  files.push_back({"20.pxn", "<pangu_model ver=\"0\"><group/></pangu_model>"});
  const auto start = Clock::now();
  const Reading nodes = read_files(files, options);
  EXPECT_EQ(nodes.codes(), std::multiset<std::string>{"E1008"});
  EXPECT_FALSE(nodes.scene) << "a million uses of the last file";
  const Reading uses = read_files(files);
  EXPECT_EQ(uses.codes(), std::multiset<std::string>{"E1304"});
  EXPECT_LT(seconds_since(start), 5);
}

TEST(Hostile, LimitsAreLimits) {
  Options options;
  options.limits.elements = 1000;
  const Reading r =
      timed("<pangu_model ver=\"0\">" + repeated("<group/>", 1000) + "</pangu_model>", 1, options);
  EXPECT_EQ(r.summary(), "1:8015 E1008 more than 1000 elements\n");
  EXPECT_FALSE(r.scene);
  options.limits.elements = 1001;
  EXPECT_EQ(
      timed("<pangu_model ver=\"0\">" + repeated("<group/>", 1000) + "</pangu_model>", 1, options)
          .summary(),
      "");
}

}  // namespace
}  // namespace panwright::pxn::hostile_test
