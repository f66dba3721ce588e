// Files that a crash, or a user, has cut or overwritten.
#include "image/whole.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "image/image.h"
#include "tests/image/image_folder.h"

namespace panwright::image::whole_test {
namespace {

class WholeFiles : public testing_support::ImageFolder {
 protected:
  void put(const char* name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
  }
};

Image noise() {
  Image image;
  image.width = 37;
  image.height = 50;
  for (std::size_t i = 0; i < 3 * image.pixels(); ++i)
    image.radiance.push_back(static_cast<float>(i * 7919 % 1000) / 3000);
  image.coverage.assign(image.pixels(), 1);
  image.depth.assign(image.pixels(), 4);
  image.range = image.depth;
  image.normal.resize(3 * image.pixels());
  image.dn_bits = 12;
  for (std::size_t i = 0; i < image.pixels(); ++i)
    image.dn.push_back(static_cast<std::uint16_t>(i * 31 % 4096));
  image.target_id = image.node_id = image.material_id =
      std::vector<std::uint32_t>(image.pixels(), 1);
  return image;
}

TEST_F(WholeFiles, AreToldFromCutOnes) {
  for (const char* name : {"a.png", "a.npy", "a.npz", "a.exr", "a.tif", "a.fits"}) {
    DiagnosticLog log;
    EXPECT_FALSE(is_whole(path(name))) << name;
    ASSERT_TRUE(write_image(path(name), noise(), 0, log));
    EXPECT_TRUE(is_whole(path(name))) << name;
    const std::string whole = bytes(path(name));
    for (const std::size_t length :
         {std::size_t{0}, std::size_t{4}, whole.size() / 2, whole.size() - 1}) {
      put(name, whole.substr(0, length));
      EXPECT_FALSE(is_whole(path(name))) << name << " of " << length << " bytes";
    }
    // blocks that never reached the disk
    std::string zeros = whole;
    zeros.replace(whole.size() / 2, std::string::npos, whole.size() - whole.size() / 2, '\0');
    put(name, zeros);
    // NPY, TIFF and FITS have no checksums
    if (std::string(name) == "a.png" || std::string(name) == "a.npz")
      EXPECT_FALSE(is_whole(path(name))) << name;
    put(name, std::string(whole.size(), '\0'));
    EXPECT_FALSE(is_whole(path(name))) << name;
    put(name, whole);
    EXPECT_TRUE(is_whole(path(name))) << name;
  }
  EXPECT_FALSE(is_whole(path("a.txt")));
}

TEST_F(WholeFiles, PngIsCheckedByItsSums) {
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.png"), noise(), 0, log));
  const std::string whole = bytes(path("a.png"));
  for (std::size_t at = 8; at < whole.size(); at += 11) {
    std::string other = whole;
    other[at] = static_cast<char>(other[at] ^ 0x10);
    put("a.png", other);
    EXPECT_FALSE(is_whole(path("a.png"))) << at;
  }
  put("a.png", whole + "more");
  EXPECT_FALSE(is_whole(path("a.png")));
}

}  // namespace
}  // namespace panwright::image::whole_test
