// GIF images, against the numbers that ImageMagick 6.9 packed.
#include "image/gif.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace panwright::image::gif_test {
namespace {

// 12 × 9 pixels of (20·x, 28·y, 3·(x xor y)): 108 colours.
constexpr std::string_view kGradient =
    "4749463839610c000900f60000000000140003001c03141c002800063c0009281c093c1c06003806143809283800"
    "3c380350000c501c0f64000f641c0c780012781c1550381278380c6438150054091454062854033c540000700c14"
    "700f2870123c701550541578540f6454125070006470037870068c00158c1c12a00018b4001ba01c1bb41c188c38"
    "0fa0381eb43821c8001edc1c1ec83818dc381bdc0021c81c218c540cb4541e8c7009a05421a07024b47027c8541b"
    "dc5418c8702adc702d008c0f148c0c288c153c8c1200a81214a81528a80c3ca80f508c03648c00788c0950a80664"
    "a80978a80000c41514c41228c40f3cc40c00e01814e01b28e01e3ce02150c40964c40678c40350e02464e02778e0"
    "2a8c8c068ca803a08c27b48c24a0a82ab4a82dc88c2ddc8c2ac8a824dca8278cc400a0e000b4e003a0c42db4c42a"
    "8ce02dc8e006dce009c8c427dcc42400000000000000000000000000000000000000000000000000000000000000"
    "000000000000000000000000000000000000000000000000000000000021f90400000000002c000000000c000900"
    "00076e80000104050c0e102325262c30020306070d0f11242728312d08090a0b121413292a2b2e2f151617181d1f"
    "1e3235333839191a1b1c2021223436373a3b3c3d3e3f444546585a5b5e5f40414243474849595c5d60614a4b4c4d"
    "5253546265666a6b4e4f5051555657676364686981003b";

// 40 × 30 pixels of five colours, (x² + 3·y) mod 5, the fourth of them transparent; interlaced.
constexpr std::string_view kInterlaced =
    "47494638396128001e00f20000ff000000ff000000ffc8c8c800000000000000000000000021f90401000004002c"
    "0000000028001e004003d9083113ca6eb5376584f4b60108019c07765f5892a368a61f3108c2e0c2f21bcfb75dd3"
    "f81e0b84408000141283c3621279342a9b4b27f3499d5aa5c68000001068b9de6df73b1687c1e47337c3b6b431ee"
    "38644547d555f6bc28cd37f7d17e81603d843a853c8689346f15708e8d901a5a575195509755467727789d9c9f2c"
    "0a826580a5a4a76a408a3988adacaf3eb187b0b3b23a9ba1b8ba288c92bdbf167fa8c2a9c49996c798941eabb6ae"
    "ceb0bb9eb97aa0c08fbe7291c4dca3c566c9e1cbc9b5e5cdb5d2a0e9a1d791ed92dda6dff269e258c8e34c09003b";

std::string bytes_of(std::string_view hexadecimal) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2)
    out += static_cast<char>(std::stoi(std::string(hexadecimal.substr(i, 2)), nullptr, 16));
  return out;
}

ImageProblem decoded(const std::string& bytes, DecodedImage& out,
                     std::uint64_t max_bytes = 1 << 20) {
  EXPECT_TRUE(is_gif(std::as_bytes(std::span(bytes))));
  return decode_gif(std::as_bytes(std::span(bytes)), max_bytes, out);
}

TEST(Gif, PixelsAreThoseThatWerePacked) {
  DecodedImage image;
  ASSERT_FALSE(decoded(bytes_of(kGradient), image).code);
  ASSERT_EQ(image.width, 12u);
  ASSERT_EQ(image.height, 9u);
  for (unsigned y = 0; y < 9; ++y) {
    for (unsigned x = 0; x < 12; ++x) {
      const std::uint8_t* pixel = image.rgba.data() + 4 * (12 * y + x);
      EXPECT_EQ(pixel[0], 20 * x);
      EXPECT_EQ(pixel[1], 28 * y);
      EXPECT_EQ(pixel[2], 3 * (x ^ y));
      EXPECT_EQ(pixel[3], 255);
    }
  }
}

TEST(Gif, RowsOfInterlacedOnesAreInOrderAndOneColorIsTransparent) {
  constexpr std::array<std::array<unsigned, 4>, 5> kColors = {
      {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {0, 0, 0, 0}, {200, 200, 200, 255}}};
  DecodedImage image;
  const std::string bytes = bytes_of(kInterlaced);
  ASSERT_FALSE(decoded(bytes, image).code);
  ASSERT_EQ(image.width, 40u);
  ASSERT_EQ(image.height, 30u);
  for (unsigned y = 0; y < 30; ++y)
    for (unsigned x = 0; x < 40; ++x)
      for (unsigned k = 0; k < 4; ++k)
        EXPECT_EQ(image.rgba[4 * (40 * y + x) + k], kColors[(x * x + 3 * y) % 5][k]);
}

TEST(Gif, DamageIsNoticed) {
  DecodedImage image;
  const std::string whole = bytes_of(kGradient);
  // the last two bytes end the blocks and the file; the one before them pads the last code
  for (std::size_t n = 6; n + 4 < whole.size(); ++n)
    EXPECT_EQ(decoded(whole.substr(0, n), image).code, Code("E3001")) << n;
  for (std::size_t i = 6; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x41);
    const ImageProblem problem = decoded(flipped, image);
    EXPECT_TRUE(problem.code || image.rgba.size() == std::size_t{4} * image.width * image.height);
  }
  EXPECT_EQ(decoded(whole, image, 4 * 12 * 9 - 1).code, Code("E3002"));
  EXPECT_FALSE(decoded(whole, image, 4 * 12 * 9).code);
  // a screen of 8204 × 8201 from a few hundred bytes
  std::string vast = whole;
  vast[7] = vast[9] = 0x20;
  EXPECT_EQ(decoded(vast, image, 1ull << 31).code, Code("E3001"));
  vast[7] = 0x41;
  EXPECT_EQ(decoded(vast, image, 1ull << 31).code, Code("E3002"));
}

}  // namespace
}  // namespace panwright::image::gif_test
