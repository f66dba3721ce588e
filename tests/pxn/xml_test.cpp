// The scanner against the text itself, and against Python's XML reader.

#include "pxn/text/xml.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "tests/pxn/reading.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::pxn::xml_test {
namespace {

namespace fs = std::filesystem;

struct Scan {
  DiagnosticLog log;
  xml::Document document;
  explicit Scan(const std::string& text, const xml::Limits& limits = {}) {
    const FileId file =
        log.sources().add({"t.xml", std::make_shared<const std::string>(text), Encoding::utf8, {}});
    document = xml::scan(file, limits, log);
  }
  std::vector<std::string> codes() const {
    std::vector<std::string> out;
    for (const Diagnostic& entry : log.entries()) out.emplace_back(code_info(entry.code).name);
    return out;
  }
};

std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; });
  return text;
}

std::string text_of(const xml::Document& d, std::uint32_t element) {
  std::string out;
  for (const xml::Run& run : d.runs) {
    if ((run.owner & ~xml::kCdata) != element) continue;
    const bool cdata = (run.owner & xml::kCdata) != 0;
    out += cdata ? to_utf8(d.bytes.substr(run.begin, run.end - run.begin), d.encoding)
                 : xml::decoded(d, run.begin, run.end);
  }
  return without_blanks(out);
}

std::string hex(const std::string& text) {
  std::string out;
  for (const char c : text) out += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return out;
}

// One line for each element: depth, name, attributes by name, text without blanks.
std::string dump(const xml::Document& d) {
  std::string out;
  for (std::uint32_t e = 0; e < d.size(); ++e) {
    std::uint32_t depth = 0;
    for (std::uint32_t p = e; d.elements[p].parent != p; p = d.elements[p].parent) ++depth;
    out += fmt::format("{} {}", depth, hex(to_utf8(d.name(e), d.encoding)));
    std::vector<std::string> attributes;
    for (std::uint32_t a = d.elements[e].first_attribute; a < d.elements[e + 1].first_attribute;
         ++a) {
      std::string value = xml::decoded(d, d.attributes[a].value_begin, d.attributes[a].value_end);
      attributes.push_back(hex(to_utf8(d.name(d.attributes[a]), d.encoding)) + "=" + hex(value));
    }
    std::sort(attributes.begin(), attributes.end());
    for (const std::string& a : attributes) out += " " + a;
    out += " :" + hex(text_of(d, e)) + "\n";
  }
  return out;
}

// Python's reader (expat) prints the same lines.
constexpr const char* kPeer = R"py(
import sys, xml.etree.ElementTree as T
def h(s): return s.encode('utf-8').hex()
def walk(e, depth):
    text = (e.text or '') + ''.join(c.tail or '' for c in e)
    text = ''.join(c for c in text if c not in ' \n\t\r')
    attributes = sorted(h(k) + '=' + h(v) for k, v in e.attrib.items())
    print(' '.join([str(depth), h(e.tag)] + attributes + [':' + h(text)]))
    for c in e: walk(c, depth + 1)
walk(T.parse(sys.argv[1]).getroot(), 0)
)py";

std::string peer_dump(const std::string& path) {
  const support::Outcome outcome = support::run({PANWRIGHT_PYTHON, "-c", kPeer, path});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return outcome.out;
}

// Makes documents with everything in them that the scanner knows.
class Author {
 public:
  explicit Author(std::uint32_t seed, bool latin1) : random_(seed), latin1_(latin1) {}
  std::string document() {
    std::string out = fmt::format("<?xml version='1.0' encoding=\"{}\"?>\n<!-- <a> -->",
                                  latin1_ ? "iso-8859-1" : "utf-8");
    element(out, 0);
    return out + "\n<?end of it?>";
  }

 private:
  std::uint32_t below(std::uint32_t n) { return random_() % n; }
  std::string pick(std::initializer_list<const char*> words) {
    return words.begin()[below(static_cast<std::uint32_t>(words.size()))];
  }
  std::string accent() { return latin1_ ? "\xe9\xff" : "\xc3\xa9\xe2\x82\xac\xf0\x9f\x9b\xb0"; }
  std::string name() {
    return pick({"a", "group", "x-1.y", "_z", "vec3"}) +
           (below(8) == 0 ? accent().substr(0, latin1_ ? 1 : 2) : "");
  }
  std::string characters(bool attribute) {
    std::string out;
    for (std::uint32_t i = below(6); i > 0; --i)
      out += pick({"1.5 ", "word", "&lt;", "&#x20ac;", "&#233;", "&amp;amp;", "]]", ">", " "}) +
             (below(4) == 0 ? accent() : "") + (!attribute && below(4) == 0 ? "\r\n\t" : "");
    for (std::size_t at; (at = out.find("]]>")) != std::string::npos;) out.erase(at, 1);
    return out;
  }
  void element(std::string& out, int depth) {
    const std::string tag = name();
    out += "<" + tag;
    for (std::uint32_t i = 0, n = below(4); i < n; ++i)
      out += pick({" ", "\n  "}) + "k" + std::to_string(i) + pick({"=", " = "}) +
             (below(2) == 0 ? "\"" + characters(true) + "'\"" : "'" + characters(true) + "\"'");
    if (below(5) == 0) {
      out += pick({"/>", " />"});
      return;
    }
    out += pick({">", " >"});
    for (std::uint32_t i = below(depth == 0 ? 9 : 5); i > 0; --i) {
      const std::uint32_t what = below(8);
      if (what < 3 && depth < 12)
        element(out, depth + 1);
      else if (what == 3)
        out += "<!-- - <b> & ]]> -->";
      else if (what == 4)
        out += "<![CDATA[ <c> &amp; ]] " + accent() + "]]>";
      else if (what == 5)
        out += "<?pi <d> ?>";
      else
        out += characters(false);
    }
    out += "</" + tag + pick({">", " >"});
  }
  std::mt19937 random_;
  bool latin1_;
};

TEST(Xml, RandomDocumentsReadAsPythonReadsThem) {
  const support::TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    const std::string text = Author(seed, seed % 2 == 1).document();
    const Scan scan(text);
    EXPECT_EQ(to_text(scan.log), "") << text;
    EXPECT_EQ(dump(scan.document), peer_dump(folder.write("t.xml", text))) << text;
  }
}

// Every recorded span, cut out of the bytes, is what it says.
void check_spans(const xml::Document& d) {
  for (std::uint32_t e = 0; e < d.size(); ++e) {
    const xml::Element& x = d.elements[e];
    const std::string name(d.name(e));
    ASSERT_LE(x.start_tag_end, x.end);
    ASSERT_EQ(d.bytes.substr(x.begin, 1 + name.size()), "<" + name);
    ASSERT_EQ(d.bytes[x.start_tag_end - 1], '>');
    ASSERT_EQ(d.bytes[x.end - 1], '>');
    const std::string_view whole = d.bytes.substr(x.begin, x.end - x.begin);
    ASSERT_TRUE(x.start_tag_end == x.end ? whole.ends_with("/>")
                                         : whole.find("</" + name) != std::string_view::npos);
    // the whole element by itself is a document with as many elements
    if (x.next - e < 40) {
      const std::string declaration =
          d.encoding == Encoding::latin1 ? "<?xml version='1.0' encoding='ISO-8859-1'?>" : "";
      const Scan alone(declaration + std::string(whole));
      ASSERT_EQ(to_text(alone.log), "") << whole;
      ASSERT_EQ(alone.document.size(), x.next - e);
      ASSERT_EQ(text_of(alone.document, 0), text_of(d, e));
    }
    if (x.parent != e) {
      ASSERT_GE(x.begin, d.elements[x.parent].start_tag_end);
      ASSERT_LE(x.end, d.elements[x.parent].end);
    }
    for (std::uint32_t a = x.first_attribute; a < d.elements[e + 1].first_attribute; ++a) {
      const xml::Attribute& attribute = d.attributes[a];
      const char quote = d.bytes[attribute.value_begin - 1];
      ASSERT_TRUE(quote == '"' || quote == '\'');
      ASSERT_EQ(d.bytes[attribute.value_end], quote);
      ASSERT_EQ(d.bytes.substr(attribute.value_begin, attribute.value_end - attribute.value_begin)
                    .find(quote),
                std::string_view::npos);
      const std::string between(
          d.bytes.substr(attribute.name_begin, attribute.value_begin - attribute.name_begin));
      ASSERT_EQ(without_blanks(between), std::string(d.name(attribute)) + "=" + quote);
    }
  }
  for (const xml::Run& run : d.runs) {
    const xml::Element& owner = d.elements[run.owner & ~xml::kCdata];
    ASSERT_GE(run.begin, owner.start_tag_end);
    ASSERT_LT(run.end, owner.end);
    if ((run.owner & xml::kCdata) != 0) {
      ASSERT_EQ(d.bytes.substr(run.begin - 9, 9), "<![CDATA[");
      ASSERT_EQ(d.bytes.substr(run.end, 3), "]]>");
    } else {
      ASSERT_EQ(d.bytes[run.end], '<');
      ASSERT_EQ(d.bytes.substr(run.begin, run.end - run.begin).find('<'), std::string_view::npos);
    }
  }
}

TEST(Xml, EverySpanIsWhatItSays) {
  for (const char* folder : {"/tests/pxn/data/good", "/examples"})
    for (const auto& entry :
         fs::recursive_directory_iterator(PANWRIGHT_SOURCE_DIR + std::string(folder)))
      if (entry.path().extension() == ".pxn") {
        const Scan scan(support::contents(entry.path()));
        EXPECT_GT(scan.document.size(), 0u);
        check_spans(scan.document);
      }
  for (std::uint32_t seed = 100; seed < 400; ++seed)
    check_spans(Scan(Author(seed, seed % 2 == 1).document()).document);
}

TEST(Xml, SpansAreInTheBytesOfTheFile) {
  // the text after an é is one byte further in UTF-8 than in ISO-8859-1
  const Scan latin("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a k=\"\xe9\"><b/></a>");
  ASSERT_EQ(latin.document.size(), 2u);
  EXPECT_EQ(latin.document.encoding, Encoding::latin1);
  EXPECT_EQ(latin.document.bytes.substr(latin.document.elements[1].begin, 4), "<b/>");
  const xml::Attribute& k = latin.document.attributes[0];
  EXPECT_EQ(k.value_end - k.value_begin, 1u);
  EXPECT_EQ(xml::decoded(latin.document, k.value_begin, k.value_end), "\xc3\xa9");
}

TEST(Xml, OffsetsOfDecodedText) {
  const Scan scan("<a>x&#x20ac;\r\ny&lt;</a>");
  std::vector<std::uint32_t> offsets;
  const xml::Run& run = scan.document.runs.at(0);
  const std::string text = xml::decoded(scan.document, run.begin, run.end, &offsets);
  EXPECT_EQ(text, "x\xe2\x82\xac\ny<");
  EXPECT_EQ(offsets, (std::vector<std::uint32_t>{3, 4, 4, 4, 12, 14, 15, 19}));
}

struct Broken {
  const char* text;
  std::vector<std::string> codes;
  std::uint32_t elements;  // that are read in spite of it
};

TEST(Xml, BrokenTextGivesPlacesAndGoesOn) {
  const std::vector<Broken> cases = {
      {"", {"E1001"}, 0},
      {"  ", {"E1001"}, 0},
      {"text", {"E1001", "E1001"}, 0},
      {"<a/>text", {"E1001"}, 1},
      {"<a/><b><c/>t</b>", {"E1001"}, 1},
      {"<a", {"E1001", "E1001"}, 1},
      {"<a><b></a>", {"E1002"}, 2},
      {"<a><b></c></b></a>", {"E1002"}, 2},
      {"<group><b/></grop>", {"E1002"}, 2},
      {"<a></a></a>", {"E1002"}, 1},
      {"<a><b x=1 y='2'/></a>", {"E1001"}, 2},
      {"<a><b x/></a>", {"E1001"}, 2},
      {"<a><b x='1'y='2'/></a>", {"E1001"}, 2},
      {"<a><b x='1></b><c/></a>", {"E1001"}, 3},
      {"<a><b x='1' x='2'/></a>", {"E1007"}, 2},
      {"<a><b x='<'/></a>", {"E1001"}, 2},
      {"<a>]]></a>", {"E1001"}, 1},
      {"<a>&nbsp;</a>", {"E1005"}, 1},
      {"<a>& &; &#; &#0; &#xd800; &#x110000;</a>",
       {"E1001", "E1001", "E1001", "E1001", "E1001", "E1001"},
       1},
      {"<a><!-- -- --><!-- </a>", {"E1001", "E1001", "E1001"}, 1},
      {"<a><![CDATA[ </a>", {"E1001", "E1001"}, 1},
      {"<a><?x </a>", {"E1001", "E1001"}, 1},
      {"<a><? x?><?xml version='1.0'?></a>", {"E1001", "E1001"}, 1},
      {"<a>< b/></a>", {"E1001"}, 1},
      {"<a><1/></a>", {"E1001"}, 1},
      {"<a></ a></a>", {"E1001"}, 1},
      {"<!DOCTYPE a><a/>", {"E1005"}, 1},
      {"<!DOCTYPE a [<!ENTITY b '>'> <!-- ' --> ]><a/>", {"E1005"}, 1},
      {"<!DOCTYPE a [<a/>", {"E1005", "E1001", "E1001"}, 0},
      {"<?xml version='2.0'?><a/>", {"E1001"}, 1},
      {"<?xml version='1.0' encodng='utf-8'?><a/>", {"E1001"}, 1},
      {"<?xml version='1.0' encoding='utf-8' standalone='maybe'?><a/>", {"E1001"}, 1},
      {"<?xml version='1.0'", {"E1001", "E1001"}, 0},
      {"<a>\x01</a>", {"E1004"}, 1},
      {"<a>\xc0\x80</a>", {"E1004"}, 1},
      {"<a>\xed\xa0\x80</a>", {"E1004"}, 1},
      {"<a>\xf4\x90\x80\x80</a>", {"E1004"}, 1},
      {"<a>\xef\xbf\xbf</a>", {"E1004"}, 1},
      {"<?xml version='1.0' encoding='US-ASCII'?><a>\xc3\xa9</a>", {"E1004"}, 1},
      {"<?xml version='1.0' encoding='UTF-16'?><a/>", {"E1003"}, 0},
      {"\xef\xbb\xbf<?xml version='1.0' encoding='ISO-8859-1'?><a/>", {"E1003"}, 0},
      {"\xfe\xff", {"E1003"}, 0},
  };
  for (const Broken& c : cases) {
    const Scan scan(c.text);
    EXPECT_EQ(scan.codes(), c.codes) << c.text << "\n" << to_text(scan.log);
    EXPECT_EQ(scan.document.size(), c.elements) << c.text;
    for (const Diagnostic& entry : scan.log.entries()) {
      EXPECT_LE(entry.where.begin, entry.where.end);
      EXPECT_LE(entry.where.end, scan.document.bytes.size());
    }
  }
}

// Every prefix and every changed byte of a document: no place outside the text, and what cannot be
// XML is refused.
TEST(Xml, DamagedDocumentsAreRefused) {
  const std::string text = Author(7, false).document();
  for (std::size_t n = 0; n < text.size(); ++n) {
    // an exact copy, so that a sanitizer sees a read past the end
    const Scan cut(text.substr(0, n));
    // what stands behind the root element is 14 bytes
    if (n + 14 < text.size()) {
      EXPECT_TRUE(cut.log.has_errors()) << n;
    }
    for (const char c : {'<', '\0', '&', '"', '\xff'}) {
      std::string changed = text;
      changed[n] = c;
      const Scan scan(changed);
      for (const Diagnostic& entry : scan.log.entries()) ASSERT_LE(entry.where.end, text.size());
      if (c == '\0' || c == '\xff') {
        EXPECT_TRUE(scan.log.has_errors()) << n;
      }
    }
  }
}

TEST(Xml, Limits) {
  std::string deep;
  for (int i = 0; i < 300; ++i) deep += "<a>";
  for (int i = 0; i < 300; ++i) deep += "</a>";
  const Scan scan(deep + " ");
  EXPECT_EQ(scan.codes(), std::vector<std::string>{"E1006"});
  EXPECT_EQ(scan.document.size(), 256u);
  EXPECT_EQ(scan.document.height, 256u);
  EXPECT_EQ(scan.log.entries()[0].where.begin, 3u * 256 + 1);

  const Scan many("<a><b/><b/><b/></a>", {3, 256});
  EXPECT_EQ(many.codes(), std::vector<std::string>{"E1008"});
  EXPECT_FALSE(many.document.complete);
  EXPECT_EQ(many.document.size(), 3u);
}

}  // namespace
}  // namespace panwright::pxn::xml_test
