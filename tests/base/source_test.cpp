#include "base/source.h"

#include <gtest/gtest.h>

namespace panwright::source_test {
namespace {

FileId add(SourceMap& map, std::string text, Encoding encoding = Encoding::utf8) {
  return map.add({"f", std::make_shared<const std::string>(std::move(text)), encoding, {}});
}

TEST(SourceMap, CountsLinesWithAnyEnding) {
  SourceMap map;
  const FileId f = add(map, "a\nb\r\nc\rd");
  EXPECT_EQ(map.position(f, 0).line, 1u);
  EXPECT_EQ(map.position(f, 2).line, 2u);
  EXPECT_EQ(map.position(f, 5).line, 3u);
  EXPECT_EQ(map.position(f, 7).line, 4u);
  EXPECT_EQ(map.position(f, 7).column, 1u);
  EXPECT_EQ(map.line_text(f, 2), "b");
  EXPECT_EQ(map.line_text(f, 3), "c");
  EXPECT_EQ(map.line_text(f, 9), "");
}

TEST(SourceMap, ColumnsAreCharacters) {
  SourceMap map;
  const FileId utf8 = add(map, "äöx");
  EXPECT_EQ(map.position(utf8, 4).column, 3u);
  const FileId latin1 = add(map, "\xe4\xf6x", Encoding::latin1);
  EXPECT_EQ(map.position(latin1, 2).column, 3u);
  EXPECT_EQ(map.line_text(latin1, 1), "äöx");
  const FileId broken = add(map, "\xff\xffx");
  EXPECT_EQ(map.position(broken, 2).column, 3u);
}

TEST(SourceMap, ColumnsDoNotDependOnTheOrderOfQuestions) {
  SourceMap map;
  std::string text;
  for (int i = 0; i < 300; ++i) text += i % 7 == 0 ? "ä" : i % 41 == 0 ? "\n" : "x";
  const FileId f = add(map, text);
  for (std::uint32_t k = 0; k < 2000; ++k) {
    const std::uint32_t offset = k * 7919 % static_cast<std::uint32_t>(text.size());
    SourceMap fresh;
    const Position expected = fresh.position(add(fresh, text), offset);
    EXPECT_EQ(map.position(f, offset).line, expected.line);
    EXPECT_EQ(map.position(f, offset).column, expected.column) << offset;
  }
}

// The column is the number of starts of characters before, counted here from the line's start.
TEST(SourceMap, PlacesOfALongLineCostTheSameInAnyOrder) {
  SourceMap map;
  std::string text = "first\n";
  const std::string parts[] = {"x", "ä", "\xff", "\xe2\x82", "€", "\xf0\x9f\x9b\xb0", "yz"};
  std::vector<std::uint32_t> columns(text.size(), 1);
  std::uint32_t column = 0;
  for (std::uint32_t i = 0; text.size() < (1u << 20); ++i) {
    const std::string& part = parts[(i * 2654435761u >> 7) % std::size(parts)];
    const bool whole = part.size() > 1 && part != "yz" && part != parts[3];
    for (std::size_t k = 0; k < part.size(); ++k)
      columns.push_back(k == 0 || !whole ? ++column : column);
    text += part;
  }
  const FileId f = add(map, text);
  const auto size = static_cast<std::uint32_t>(text.size());
  for (std::uint32_t k = 0; k < 200'000; ++k) {  // 100 GB to count from the line's start each time
    const std::uint32_t offset = 6 + static_cast<std::uint32_t>(k * 2654435761ull % (size - 6));
    const Position at = map.position(f, offset);
    ASSERT_EQ(at.line, 2u);
    ASSERT_EQ(at.column, columns[offset]) << offset;
  }
}

TEST(SourceMap, OffsetsPastTheEndAreSafe) {
  SourceMap map;
  const FileId f = add(map, "ab");
  EXPECT_EQ(map.position(f, 100).line, 1u);
  const FileId empty = add(map, "");
  EXPECT_EQ(map.position(empty, 0).column, 1u);
}

TEST(ToUtf8, ReplacesWhatIsNoText) {
  EXPECT_EQ(to_utf8("\xc3\xa4", Encoding::utf8), "ä");
  EXPECT_EQ(to_utf8("\xc0\x80", Encoding::utf8), "\xef\xbf\xbd\xef\xbf\xbd");  // overlong
  EXPECT_EQ(to_utf8("\xed\xa0\x80", Encoding::utf8).size(), 9u);               // surrogate
  EXPECT_EQ(to_utf8("\xf4\x90\x80\x80", Encoding::utf8).size(), 12u);          // > U+10FFFF
  EXPECT_EQ(to_utf8("\xf0\x9f\x9b\xb0", Encoding::utf8), "\xf0\x9f\x9b\xb0");  // satellite
  EXPECT_EQ(to_utf8("\xe2\x82", Encoding::utf8), "\xef\xbf\xbd\xef\xbf\xbd");  // cut short
}

}  // namespace
}  // namespace panwright::source_test
