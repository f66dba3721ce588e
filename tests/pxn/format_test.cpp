// The canonical form: what it looks like, and that it means what it meant.

#include "pxn/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "pxn/text/markup.h"
#include "pxn/text/xml.h"
#include "tests/support/paths.h"

namespace panwright::pxn::format_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Formatting {
  DiagnosticLog log;
  Result<std::string> text = failed;
};

Formatting format_of(const std::string& text, const Limits& limits = {}) {
  Formatting out;
  out.text = formatted("m.pxn", std::make_shared<const std::string>(text), limits, out.log);
  return out;
}

// The text, having been formatted twice with the same result. Empty: refused.
std::string canonical(const std::string& text) {
  const Formatting once = format_of(text);
  EXPECT_TRUE(once.text) << to_text(once.log);
  if (!once.text) return {};
  const Formatting twice = format_of(*once.text);
  EXPECT_TRUE(twice.text) << to_text(twice.log);
  if (twice.text) {
    EXPECT_EQ(*twice.text, *once.text);
  }
  return *once.text;
}

// The tree as the scanner of the reader sees it: names, values and words, without their layout.
// Independent of the pieces that the formatter works with.
std::string tree_of(const std::string& text) {
  DiagnosticLog log;
  const FileId file =
      log.sources().add({"t.pxn", std::make_shared<const std::string>(text), Encoding::utf8, {}});
  const xml::Document document = xml::scan(file, {}, log);
  EXPECT_FALSE(log.has_errors()) << to_text(log);
  std::vector<std::string> texts(document.size());
  for (const xml::Run& run : document.runs) {
    const std::uint32_t owner = run.owner & ~xml::kCdata;
    texts[owner] += (run.owner & xml::kCdata) != 0
                        ? std::string(document.bytes.substr(run.begin, run.end - run.begin))
                        : xml::decoded(document, run.begin, run.end);
  }
  const auto words = [](const std::string& value) {
    std::string out;
    for (std::size_t i = 0; i < value.size();) {
      const std::size_t begin = value.find_first_not_of(" \t\r\n", i);
      if (begin == std::string::npos) break;
      i = std::min(value.find_first_of(" \t\r\n", begin), value.size());
      // no text of these tests has expressions with blanks at their ends beside others
      out += value.substr(begin, i - begin) + " ";
    }
    return out;
  };
  std::string out;
  for (std::uint32_t e = 0; e < document.size(); ++e) {
    out += std::to_string(document.elements[e].parent) + "<" + std::string(document.name(e));
    std::vector<std::string> attributes;
    for (std::uint32_t a = document.elements[e].first_attribute;
         a < document.elements[e + 1].first_attribute; ++a) {
      const xml::Attribute& attribute = document.attributes[a];
      attributes.push_back(
          " " + std::string(document.name(attribute)) + "=" +
          words(xml::decoded(document, attribute.value_begin, attribute.value_end)));
    }
    std::sort(attributes.begin(), attributes.end());
    for (const std::string& attribute : attributes) out += attribute;
    out += ">" + words(texts[e]) + "\n";
  }
  return out;
}

TEST(Format, TheForm) {
  EXPECT_EQ(canonical("<pangu_model   units='mm'\n ver='1'><group name = \"a\" ><sphere "
                      "rings='3'\tquads=\"4\"></sphere><diffuse>0.7   0.2\n0.1</diffuse></group>"
                      "</pangu_model>"),
            "<pangu_model ver=\"1\" units=\"mm\">\n"
            "  <group name=\"a\">\n"
            "    <sphere rings=\"3\" quads=\"4\"/>\n"
            "    <diffuse> 0.7 0.2 0.1 </diffuse>\n"
            "  </group>\n"
            "</pangu_model>\n");
  // ver, name, part and file stand first
  EXPECT_EQ(canonical("<a z='1' file='f' part='p' b='2' name='n' ver='0'/>"),
            "<a ver=\"0\" name=\"n\" part=\"p\" file=\"f\" z=\"1\" b=\"2\"/>\n");
  // at most one blank line stays, none at the ends of an element
  EXPECT_EQ(canonical("\n\n<a>\n\n\n<b/>\n\n\n\n<c/>\n<d/>\n\n</a>\n\n\n"),
            "<a>\n  <b/>\n\n  <c/>\n  <d/>\n</a>\n");
}

TEST(Format, CommentsStayWhereTheyAre) {
  EXPECT_EQ(canonical("<?xml version='1.0'?><!-- head -->\n<!-- own --><a><!--t--><b/><!-- of b "
                      "--> <!-- too -->\n<!-- own -->\n\n<c/>\n<!-- last --></a><!-- end -->"),
            "<?xml version='1.0'?>\n"
            "<!-- head -->\n"
            "<!-- own -->\n"
            "<a> <!--t-->\n"
            "  <b/> <!-- of b --> <!-- too -->\n"
            "  <!-- own -->\n"
            "\n"
            "  <c/>\n"
            "  <!-- last -->\n"
            "</a> <!-- end -->\n");
  // the lines of one move together
  EXPECT_EQ(canonical("<a>\n      <!-- one\n           two\n   three -->\n</a>"),
            "<a>\n  <!-- one\n       two\nthree -->\n</a>\n");
  EXPECT_EQ(canonical("<a> <!-- nothing --> </a>"), "<a> <!-- nothing --> </a>\n");
  EXPECT_EQ(canonical("<path> 0 0 0 <!-- start -->\n1 1 1 <!-- end -->\n</path>"),
            "<path>\n  0 0 0 <!-- start -->\n  1 1 1 <!-- end -->\n</path>\n");
}

TEST(Format, LongTagsAndLists) {
  std::string tag = "<tube", broken = "<tube";
  for (int i = 0; i < 9; ++i) {
    const std::string attribute = "attribute" + std::to_string(i) + "=\"value\"";
    tag += " " + attribute;
    broken += "\n    " + attribute;
  }
  EXPECT_EQ(canonical(tag + "/>"), broken + "/>\n");
  // exactly 100 columns fit
  EXPECT_EQ(canonical("<a b=\"" + std::string(84, 'x') + "\" c=\"12\"/>"),
            "<a b=\"" + std::string(84, 'x') + "\" c=\"12\"/>\n");
  EXPECT_EQ(canonical("<a b=\"" + std::string(85, 'x') + "\" c=\"12\"/>"),
            "<a\n    b=\"" + std::string(85, 'x') + "\"\n    c=\"12\"/>\n");
  // columns are characters
  std::string wide;
  for (int i = 0; i < 84; ++i) wide += "é";
  EXPECT_EQ(canonical("<a b=\"" + wide + "\" c=\"12\"/>"), "<a b=\"" + wide + "\" c=\"12\"/>\n");

  std::string list;
  for (int i = 0; i < 60; ++i) list += std::to_string(i) + (i % 7 == 0 ? "\n" : " ");
  const std::string points = canonical("<path>" + list + "</path>");
  EXPECT_THAT(points, HasSubstr("<path>\n  0 1 2  3 4 5  6 7 8  "));
  EXPECT_THAT(canonical("<extrude><outline>" + list + "</outline></extrude>"),
              HasSubstr("\n    0 1  2 3  4 5  "));
  EXPECT_THAT(canonical("<face><outline>" + list + "</outline></face>"),
              HasSubstr("\n    0 1 2 3 4 5 "));
  // lines end between points
  std::size_t begin = 0;
  for (std::size_t end = points.find('\n'); end != std::string::npos;
       begin = end + 1, end = points.find('\n', begin)) {
    const std::string line = points.substr(begin, end - begin);
    EXPECT_LE(line.size(), 100u);
    if (line[0] == '<') continue;
    // 3 numbers a point, 2 blanks between points and 1 within
    EXPECT_EQ((std::count(line.begin(), line.end(), ' ') - 4) % 4, 0) << line;
  }
}

TEST(Format, Expressions) {
  EXPECT_EQ(canonical("<sphere radius=' { a  +\n  b } ' name=' {x } '/>"),
            "<sphere name=\" {x } \" radius=\"{a  + b}\"/>\n");
  EXPECT_EQ(canonical("<path> { i * 2 } 0 0 1 1 { j }</path>"),
            "<path> {i * 2} 0 0  1 1 {j} </path>\n");
  // what is no expression is left alone
  EXPECT_EQ(canonical("<sphere radius='{ a'/>"), "<sphere radius=\"{ a\"/>\n");
  EXPECT_EQ(canonical("<note>{ a }  b</note>"), "<note> { a } b </note>\n");
}

TEST(Format, WhatMustNotChange) {
  // text is not moved away from what it touches
  EXPECT_EQ(canonical("<a>1<![CDATA[2 3]]>4<!--c-->5 6</a>"),
            "<a> 1<![CDATA[2 3]]>4<!--c-->5 6 </a>\n");
  EXPECT_EQ(canonical("<a>one<b>two</b>three <c/>\n four</a>"),
            "<a>one<b> two </b>three\n  <c/>\n  four</a>\n");
  EXPECT_EQ(canonical("<a><p xml:space='preserve'> x\n\t<q  r='1'/>  </p><p>  y</p></a>"),
            "<a>\n  <p xml:space=\"preserve\"> x\n\t<q  r='1'/>  </p>\n  <p> y </p>\n</a>\n");
  // references and quotes as written, line ends of values as XML reads them
  EXPECT_EQ(canonical("<a b='say \"so\"' c=\"it's &lt;&#65;\r\n&amp; > \tx\"/>"),
            "<a b='say \"so\"' c=\"it's &lt;&#65; &amp; >  x\"/>\n");
  EXPECT_EQ(canonical("<a>x ]] &gt; &#32; y</a>"), "<a> x ]] &gt; &#32; y </a>\n");
  EXPECT_EQ(canonical("<a>\r\n<?pi  x?>\r<b/></a>\r\n"), "<a>\n  <?pi  x?>\n  <b/>\n</a>\n");
  // the encoding, and its mark
  EXPECT_EQ(canonical("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a b='\xe9'/>"),
            "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<a b=\"\xe9\"/>\n");
  EXPECT_EQ(canonical("\xef\xbb\xbf<a>\xc3\xa9</a>"), "\xef\xbb\xbf<a> \xc3\xa9 </a>\n");
}

TEST(Format, WhatIsNotWellFormedIsRefused) {
  for (const char* text : {"", "<a>", "<a b=1/>", "<a <!-- c --> b='1'/>", "<a/><b/>", "<a>]]></a>",
                           "<a b='1' b='2'/>", "<a>&what;</a>", "<!DOCTYPE a><a/>", "<a b='<'/>",
                           "<a>\x01</a>", "<a></b>", "\xff\xfe<\0a\0/\0>\0"}) {
    const Formatting f = format_of(text);
    EXPECT_FALSE(f.text) << text;
    EXPECT_TRUE(f.log.has_errors()) << text;
  }
  std::string deep, many = "<a";
  for (int i = 0; i < 257; ++i) deep += "<a>";
  for (int i = 0; i < 257; ++i) deep += "</a>";
  EXPECT_TRUE(format_of(deep).log.contains(Code("E1006")));
  for (int i = 0; i < 100000; ++i) many += " a" + std::to_string(i) + "=''";
  EXPECT_TRUE(format_of(many + "/>").log.contains(Code("E1001")));
  EXPECT_TRUE(format_of("<a><b/><c/></a>", {.elements = 2}).log.contains(Code("E1008")));
}

TEST(Format, DeepButAllowed) {
  std::string deep, expected;
  for (int i = 0; i < 255; ++i) {
    deep += "<a>";
    expected += std::string(static_cast<std::size_t>(2 * i), ' ') + "<a>\n";
  }
  deep += "<b/>";
  expected += std::string(510, ' ') + "<b/>\n";
  for (int i = 255; i-- > 0;) {
    deep += "</a>";
    expected += std::string(static_cast<std::size_t>(2 * i), ' ') + "</a>\n";
  }
  EXPECT_EQ(canonical(deep), expected);
}

TEST(Format, ShippedFilesKeepTheirTree) {
  std::size_t files = 0;
  for (const char* folder : {"/examples", "/tests/pxn/data/good", "/tests/pxn/data/bad"})
    for (const auto& entry :
         fs::recursive_directory_iterator(std::string(PANWRIGHT_SOURCE_DIR) + folder)) {
      if (entry.path().extension() != ".pxn") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string text(std::istreambuf_iterator<char>(file), {});
      if (!format_of(text).text) continue;  // some are bad by being no XML
      ++files;
      EXPECT_EQ(tree_of(canonical(text)), tree_of(text)) << entry.path();
    }
  EXPECT_GT(files, 50u);
}

// Random documents of everything that XML has, in every kind of layout.
class Author {
 public:
  explicit Author(std::uint32_t seed) : random_(seed) {}

  std::string document() {
    std::string out = chance(3) ? "<?xml version=\"1.0\"?>" : "";
    out += between() + element(0) + between();
    return out;
  }

 private:
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  bool chance(std::uint32_t one_in) { return below(one_in) == 0; }
  std::string blanks() {
    std::string out;
    for (std::uint32_t n = below(4); n > 0; --n) out += " \t\n\n\r"[below(5)];
    return out;
  }
  std::string some(std::initializer_list<const char*> of) {
    return of.begin()[below(static_cast<std::uint32_t>(of.size()))];
  }
  std::string between() {
    std::string out = blanks();
    for (std::uint32_t n = below(3); n > 0; --n)
      out += some({"<!-- c -->", "<!--a\n     b\n c-->", "<?pi x?>", "<!---->"}) + blanks();
    return out;
  }
  std::string word() {
    return some({"1", "-0.25", "{i*2}", "12mm", "x&amp;y", "&#32;", "]]", "é", "1e-3", "1>",
                 "a-rather-long-word-that-takes-its-place-on-a-line"});
  }
  std::string text() {
    std::string out = blanks();
    for (std::uint32_t n = below(chance(5) ? 60 : 5); n > 0; --n) {
      out += word();
      if (!chance(6)) out += " " + blanks();
      if (chance(12)) out += some({"<!-- c -->", "<![CDATA[ 1  2 ]]>", "<![CDATA[]]>", "<?p?>"});
    }
    return out;
  }
  std::string element(std::uint32_t depth) {
    const std::string name = some(
        {"pangu_model", "path", "outline", "face", "vec3", "diffuse", "node", "b", "cylinder"});
    std::string out = "<" + name;
    for (std::uint32_t n = below(chance(6) ? 12 : 3), i = 0; i < n; ++i)
      out += " " + blanks() + some({"radius", "name", "translate", "doc"}) + std::to_string(i) +
             blanks() + "=" + blanks() + "'" + (chance(3) ? blanks() : "") + word() + " " + word() +
             "\"'";
    if (chance(3)) return out + blanks() + "/>";
    out += blanks() + ">";
    const bool mixed = chance(6);
    if (depth < 6 && !chance(3)) {
      for (std::uint32_t n = below(5); n > 0; --n)
        out += (mixed ? text() : between()) + element(depth + 1);
      out += between();
    } else {
      out += chance(4) ? between() : text();
    }
    return out + "</" + name + blanks() + ">";
  }

  std::mt19937 random_;
};

TEST(Format, RandomDocumentsKeepTheirTree) {
  for (std::uint32_t seed = 0; seed < 3000 && !HasFailure(); ++seed) {
    const std::string text = Author(seed).document();
    const std::string result = canonical(text);
    EXPECT_EQ(tree_of(result), tree_of(text)) << "seed " << seed << "\n" << text;
  }
}

// words that touch an element stay one with those behind it, whatever stands between
TEST(Format, WordsAroundElementsStayTogether) {
  for (const char* aside : {"", "<?p?>", "<!-- c -->", "<![CDATA[]]>"})
    for (const bool before : {false, true}) {
      const std::string text = std::string("<a><vec3>1") + (before ? aside : "") + "<face/>" +
                               (before ? "" : aside) + "2 3</vec3></a>";
      EXPECT_EQ(tree_of(canonical(text)), tree_of(text)) << text << "\n" << canonical(text);
    }
}

TEST(Format, DamagedDocumentsAreRefusedOrKept) {
  std::mt19937 random(11);
  std::size_t kept = 0;
  for (std::uint32_t seed = 0; seed < 4000 && !HasFailure(); ++seed) {
    std::string text = Author(seed).document();
    for (int change = 0; change < 3; ++change) {
      const std::size_t at = random() % text.size();
      constexpr std::string_view kBytes = "<>&;\"'=/ !-[]?{}\n\r\tax\xc3";
      switch (random() % 3) {
        case 0:
          text[at] = kBytes[random() % kBytes.size()];
          break;
        case 1:
          text.insert(at, 1, kBytes[random() % kBytes.size()]);
          break;
        default:
          text.erase(at, 1 + random() % 4);
      }
    }
    // note: throws when what it makes does not mean the same
    const Formatting f = format_of(text);
    EXPECT_EQ(f.text.ok(), !f.log.has_errors());
    if (!f.text) continue;
    ++kept;
    EXPECT_EQ(canonical(text), *f.text);
    EXPECT_EQ(tree_of(*f.text), tree_of(text)) << "seed " << seed << "\n" << text;
  }
  EXPECT_GT(kept, 100u);
}

TEST(Format, DifferencesAreSeen) {
  const std::string text =
      "<a b=\"1\" c=\"2\"> <!-- c --> <d> 1 2 <![CDATA[x]]> </d> <?p i?> <e "
      "xml:space=\"preserve\"> "
      "</e> </a>";
  EXPECT_EQ(xml::difference_of(text, text), "");
  for (const auto& [from, to] :
       std::initializer_list<std::pair<std::string, std::string>>{{"b=\"1\"", "b=\"1 \""},
                                                                  {"c=\"2\"", ""},
                                                                  {" c=", " x="},
                                                                  {"<!-- c -->", ""},
                                                                  {"<!-- c -->", "<!-- d -->"},
                                                                  {"1 2", "12"},
                                                                  {"1 2", "1 3"},
                                                                  {"2 <![", "2<!["},
                                                                  {"<![CDATA[x]]>", "x"},
                                                                  {"<?p i?>", ""},
                                                                  {"<?p i?>", "x<?p i?>"},
                                                                  {"preserve\"> <", "preserve\"><"},
                                                                  {"<d>", "<d><f/>"}}) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    EXPECT_NE(xml::difference_of(text, other), "") << other;
    EXPECT_NE(xml::difference_of(other, text), "") << other;
  }
  EXPECT_EQ(xml::difference_of("<a c='2' b='1'><d></d></a>", "<a b=\"1\" c=\"2\">\n<d/></a>"), "");
  EXPECT_NE(xml::difference_of("<a><b/></a>", "<a><b><c/></b></a>"), "");
  EXPECT_NE(xml::difference_of("<a><b/></a>", "<a><c/></a>"), "");
  EXPECT_NE(xml::difference_of("<a><b></b></a>", "<a><c/></a>"), "");
}

}  // namespace
}  // namespace panwright::pxn::format_test
