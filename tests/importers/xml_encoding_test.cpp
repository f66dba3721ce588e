// XML in the encodings that programs write, read by URDF and MJCF alike.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::xml_encoding_test {
namespace {

using testing::HasSubstr;

// Letters of the basic plane in an encoding of two or four bytes.
std::string wide(std::u32string_view text, int bytes, bool big, bool mark) {
  std::string out;
  const auto put = [&](char32_t c) {
    for (int k = 0; k < bytes; ++k)
      out += static_cast<char>(c >> (8 * (big ? bytes - 1 - k : k)) & 0xff);
  };
  if (mark) put(0xfeff);
  for (const char32_t c : text) {
    if (bytes == 4 || c < 0x10000) {
      put(c);
    } else {
      put(0xd800 + ((c - 0x10000) >> 10));
      put(0xdc00 + ((c - 0x10000) & 0x3ff));
    }
  }
  return out;
}

// Reads a robot and a model with one body of that name; returns the name as it came.
void expect_name(const std::string& head, const std::string& name, const std::string& wanted,
                 bool warned) {
  const std::pair<const char*, std::string> texts[] = {
      {"m.urdf", head + "<robot name='r'><link name='" + name +
                     "'><visual><geometry><box size='1 1 1'/></geometry></visual></link></robot>"},
      {"m.xml", head + "<mujoco><worldbody><body name='" + name +
                    "'><geom size='1'/></body></worldbody></mujoco>"}};
  for (const auto& [file, text] : texts) {
    const auto read = read_meshes({{file, text}});
    ASSERT_TRUE(read->out) << file << read->text();
    EXPECT_EQ(read->scene().nodes.at(1).name, wanted) << head;
    EXPECT_EQ(read->log.contains(Code("W6221")), warned) << head << read->text();
    EXPECT_FALSE(read->log.has_errors()) << read->text();
  }
}

std::string declared(const std::string& encoding) {
  return "<?xml version=\"1.0\" encoding=\"" + encoding + "\"?>\n";
}

TEST(XmlEncoding, OfOneByte) {
  for (const char* name : {"ISO-8859-1", "iso-8859-1", "latin1", "windows-1252", "CP1252"})
    expect_name(declared(name), "Tr\xe4ger", "Träger", false);
  expect_name(declared("windows-1252"), "\x93 \x80 \x96", "“ € –", false);
  expect_name(declared("ISO-8859-15"), "\xa4 \xbd \xe4", "€ œ ä", false);
  expect_name(declared("utf-8"), "Träger €", "Träger €", false);
  expect_name("\xef\xbb\xbf" + declared("utf-8"), "Träger", "Träger", false);
  expect_name("", "Träger", "Träger", false);
}

TEST(XmlEncoding, GuessesAreSaid) {
  expect_name("", "Tr\xe4ger", "Träger", true);
  expect_name(declared("UTF-8"), "Tr\xe4ger", "Träger", true);
  expect_name(declared("UTF-16"), "Träger", "Träger", true);
  expect_name(declared("Shift_JIS"), "Träger", "Träger", true);
  expect_name(declared("Shift_JIS"), "plain", "plain", false);
}

TEST(XmlEncoding, OfTwoAndFourBytes) {
  const std::u32string text =
      U"<?xml version='1.0' encoding='UTF-16'?><robot name='r'><link name='Träger 🛰'>\n<visual>"
      U"<geometry><box size='1 1'/></geometry></visual></link></robot>";
  for (const int bytes : {2, 4})
    for (const bool big : {false, true})
      for (const bool mark : {false, true}) {
        const auto read = read_meshes({{"m.urdf", wide(text, bytes, big, mark)}});
        ASSERT_TRUE(read->out) << bytes << big << mark << read->text();
        EXPECT_EQ(read->scene().nodes.at(1).name, "Träger 🛰");
        // places are those of the text
        EXPECT_THAT(read->places(), testing::ElementsAre("2:30 E6220")) << read->text();
      }
  const auto odd = read_meshes({{"m.urdf", wide(text, 2, false, true) + "x"}});
  EXPECT_TRUE(odd->log.contains(Code("W6221"))) << odd->text();
}

TEST(XmlEncoding, OfIncludedFiles) {
  const auto read = read_meshes(
      {{"m.xml", "<mujoco><include file='a.xml'/></mujoco>"},
       {"a.xml", declared("ISO-8859-1") + "<mujoco><worldbody><body name='Tr\xe4ger'><geom "
                                          "size='1'/></body></worldbody></mujoco>"}});
  ASSERT_TRUE(read->out) << read->text();
  EXPECT_EQ(read->scene().nodes.at(1).name, "Träger");
}

TEST(XmlEncoding, OfFormatsThatAreNotRead) {
  const auto read =
      read_meshes({{"m.dae", wide(U"<?xml version='1.0'?><COLLADA/>", 2, true, true)}});
  EXPECT_THAT(read->text(), HasSubstr("COLLADA is not supported"));
}

}  // namespace
}  // namespace panwright::importers::xml_encoding_test
