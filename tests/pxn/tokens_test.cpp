// What the scanner and what walks through sound texts take pieces of XML for.

#include "pxn/text/tokens.h"

#include <gtest/gtest.h>

#include <vector>

#include "pxn/text/markup.h"

namespace panwright::pxn::xml::tokens_test {
namespace {

TEST(Tokens, KindsOfPieces) {
  const std::pair<std::string_view, PieceKind> cases[] = {{"", PieceKind::end},
                                                          {"a", PieceKind::text},
                                                          {" <", PieceKind::text},
                                                          {"<a>", PieceKind::start_tag},
                                                          {"<_/>", PieceKind::start_tag},
                                                          {"<\xc3\xa9>", PieceKind::start_tag},
                                                          {"</a>", PieceKind::end_tag},
                                                          {"</ a>", PieceKind::end_tag},
                                                          {"<?", PieceKind::instruction},
                                                          {"<!-- -->", PieceKind::comment},
                                                          {"<!-", PieceKind::broken},
                                                          {"<![CDATA[", PieceKind::cdata},
                                                          {"<![cdata[", PieceKind::broken},
                                                          {"<!DOCTYPE", PieceKind::doctype},
                                                          {"<", PieceKind::broken},
                                                          {"<1>", PieceKind::broken},
                                                          {"< a>", PieceKind::broken},
                                                          {"<<a>", PieceKind::broken}};
  for (const auto& [text, kind] : cases) EXPECT_EQ(kind_at(text, 0), kind) << text;
}

TEST(Tokens, EndsOfNamesAndMarks) {
  EXPECT_EQ(name_end("a-b.c:1 d", 0), 7u);
  EXPECT_EQ(name_end("1a", 0), 0u);
  EXPECT_EQ(name_end("a", 1), 1u);
  EXPECT_EQ(blanks_end(" \t\r\nx", 0), 4u);
  // the marks of a comment share no dash: <!--> is open
  EXPECT_EQ(close_of("<!--> -->", 0, PieceKind::comment), 6u);
  EXPECT_EQ(close_of("<!-- ", 0, PieceKind::comment), 5u);
  EXPECT_EQ(close_of("<![CDATA[a]]]>", 0, PieceKind::cdata), 11u);
  EXPECT_EQ(close_of("<?a ? ?>", 0, PieceKind::instruction), 6u);
}

TEST(Tokens, MarkupPutsTogetherWhatItTakesApart) {
  constexpr std::string_view kText =
      "<?xml version='1.0'?><a b = '>' c=\"/>'\"><!-- <x> --><![CDATA[</a>]]> t <b:c\n/></a >\n";
  Markup markup(kText);
  std::string all;
  std::vector<PieceKind> kinds;
  for (Piece piece = markup.next(); piece.kind != PieceKind::end; piece = markup.next()) {
    all += piece.bytes;
    kinds.push_back(piece.kind);
  }
  EXPECT_EQ(all, kText);
  const std::vector<PieceKind> expected = {
      PieceKind::instruction, PieceKind::start_tag, PieceKind::comment, PieceKind::cdata,
      PieceKind::text,        PieceKind::empty_tag, PieceKind::end_tag, PieceKind::text};
  EXPECT_EQ(kinds, expected);
  std::vector<TagAttribute> attributes;
  read_attributes("<a b = '>' c=\"/>'\">", attributes);
  ASSERT_EQ(attributes.size(), 2u);
  EXPECT_EQ(attributes[0].name, "b");
  EXPECT_EQ(attributes[0].value, ">");
  EXPECT_EQ(attributes[1].value, "/>'");
  EXPECT_EQ(tag_name("</a >"), "a");
  EXPECT_EQ(tag_name("<b:c\n/>"), "b:c");
}

}  // namespace
}  // namespace panwright::pxn::xml::tokens_test
