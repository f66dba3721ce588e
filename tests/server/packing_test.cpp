#include "server/packing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace panwright::server {
namespace {

// Bytes seen on the wire between the public client and a server, by an outside note.
TEST(Packing, NumbersHaveTheBytesOfThePublicClient) {
  EXPECT_EQ(packed(1.0f), 0x0000007Fu);
  EXPECT_EQ(packed(30.0f), 0xE0000083u);
  EXPECT_EQ(packed(-2.5f), 0x40000180u);
  EXPECT_EQ(packed(0.1f), 0x99999A7Bu);
  const auto bytes_of = [](double value) { return WireWriter().real64(value).take(); };
  EXPECT_THAT(bytes_of(1), testing::ElementsAre(0, 0, 3, 0xFF, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(30), testing::ElementsAre(0, 0, 4, 3, 0xE0, 0, 0, 0));
  EXPECT_THAT(bytes_of(-2.5), testing::ElementsAre(0, 0, 0x0C, 0, 0x40, 0, 0, 0));
  EXPECT_THAT(bytes_of(0.1), testing::ElementsAre(0x99, 0x99, 0xA3, 0xFB, 0x99, 0x99, 0x99, 0x99));
}

TEST(Packing, NumbersReadBackToTheSameBits) {
  for (const double value : {0.0, -0.0, 1.0, -1e-310, 5e-324, 1.7976931348623157e308, -0.1}) {
    const Bytes bytes = WireWriter().real64(value).take();
    WireReader in(bytes);
    const double back = in.real64();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << value;
    EXPECT_TRUE(in.finite());
  }
  for (const float value : {0.0f, -0.0f, 1e-45f, 3.4e38f, -0.1f})
    EXPECT_EQ(std::bit_cast<std::uint32_t>(unpacked(packed(value))),
              std::bit_cast<std::uint32_t>(value));
}

TEST(Packing, ReadersNoticeNumbersThatAreNotFinite) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const Bytes bytes = WireWriter().real64(value).real(value).take();
    WireReader doubles(bytes);
    doubles.real64();
    EXPECT_FALSE(doubles.finite());
    WireReader floats(std::span<const std::uint8_t>(bytes).last(4));
    floats.real();
    EXPECT_FALSE(floats.finite());
  }
}

// The length counts the final zero and is even.
TEST(Packing, TextsArePaddedToEvenLengths) {
  EXPECT_THAT(WireWriter().text("abc").take(), testing::ElementsAre(0, 4, 'a', 'b', 'c', 0));
  EXPECT_THAT(WireWriter().text("ab").take(), testing::ElementsAre(0, 4, 'a', 'b', 0, 0));
  EXPECT_THAT(WireWriter().text("").take(), testing::ElementsAre(0, 2, 0, 0));
}

}  // namespace
}  // namespace panwright::server
