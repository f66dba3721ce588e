#include "server/messages.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "server/packing.h"

namespace panwright::server {
namespace {

constexpr std::uint64_t kMost = 1 << 20;

// Bytes after the number, of no elements, and bytes of each element: counted from the layouts that
// are public (word 4, byte 1, float 4, double 8).
struct Expected {
  std::uint64_t fixed = 0, element = 0;
};
const std::map<std::uint32_t, Expected>& expected_sizes() {
  static const std::map<std::uint32_t, Expected> sizes = {
      {0, {0, 0}},     {1, {0, 0}},     {2, {0, 0}},    {3, {4, 12}},    {4, {8, 0}},
      {5, {4, 8}},     {6, {12, 0}},    {7, {4, 12}},   {8, {4, 1}},     {9, {8, 0}},
      {10, {0, 0}},    {11, {24, 0}},   {12, {28, 0}},  {13, {24, 0}},   {14, {100, 0}},
      {15, {128, 0}},  {16, {48, 0}},   {17, {56, 0}},  {18, {4, 0}},    {19, {8, 0}},
      {20, {4, 0}},    {21, {8, 0}},    {22, {8, 0}},   {23, {9, 0}},    {24, {5, 8}},
      {25, {25, 0}},   {26, {48, 0}},   {27, {0, 0}},   {28, {8, 0}},    {29, {4, 0}},
      {30, {4, 0}},    {31, {25, 0}},   {32, {200, 0}}, {33, {0, 0}},    {34, {100, 0}},
      {35, {60, 0}},   {256, {24, 0}},  {257, {28, 0}}, {258, {12, 0}},  {259, {12, 0}},
      {260, {4, 0}},   {261, {4, 0}},   {262, {4, 0}},  {263, {5, 0}},   {264, {6, 0}},
      {265, {128, 0}}, {266, {12, 28}}, {267, {52, 0}}, {268, {48, 0}},  {269, {56, 0}},
      {270, {60, 0}},  {271, {24, 0}},  {272, {12, 9}}, {273, {32, 0}},  {274, {8, 0}},
      {275, {24, 0}},  {276, {8, 0}},   {277, {8, 0}},  {278, {48, 0}},  {279, {4, 0}},
      {280, {24, 0}},  {281, {24, 0}},  {282, {12, 0}}, {283, {12, 0}},  {284, {24, 0}},
      {285, {4, 0}},   {286, {32, 0}},  {287, {12, 0}}, {288, {4, 0}},   {289, {9, 0}},
      {290, {64, 0}},  {291, {64, 0}},  {292, {52, 0}}, {293, {8, 0}},   {294, {4, 0}},
      {295, {12, 56}}, {296, {8, 0}},   {297, {20, 0}}, {298, {12, 64}}, {299, {148, 0}}};
  return sizes;
}

// Place of the word that counts elements, after the number.
std::size_t count_place(std::uint32_t number) { return number == 24 ? 1 : number == 272 ? 8 : 0; }

Bytes request_of(std::uint32_t number, std::uint32_t count) {
  const Expected size = expected_sizes().at(number);
  Bytes out = WireWriter().word(number).take();
  out.resize(4 + size.fixed + size.element * count);
  if (size.element == 0) return out;
  const Bytes word = WireWriter().word(count).take();
  std::copy(word.begin(), word.end(), out.begin() + 4 + count_place(number));
  return out;
}

TEST(Messages, AllOfThePublicTableAreKnownWithTheirSizes) {
  ASSERT_EQ(request_kinds().size(), expected_sizes().size());
  for (const RequestKind& kind : request_kinds()) {
    ASSERT_TRUE(expected_sizes().contains(kind.number)) << kind.number;
    for (const std::uint32_t count : {0u, 3u}) {
      const Bytes request = request_of(kind.number, count);
      const RequestSize size = request_size(request, kMost);
      EXPECT_EQ(size.state, RequestSize::State::complete) << kind.name;
      EXPECT_EQ(size.bytes, request.size()) << kind.name;
    }
  }
}

// Cut at every byte, a request is incomplete; what follows it changes nothing.
TEST(Messages, CutAndFollowedRequestsHaveTheSameSize) {
  for (const RequestKind& kind : request_kinds()) {
    Bytes request = request_of(kind.number, 2);
    for (std::size_t cut = 0; cut < request.size(); ++cut) {
      const RequestSize size = request_size(std::span(request).first(cut), kMost);
      ASSERT_EQ(size.state, RequestSize::State::incomplete) << kind.name << " " << cut;
      ASSERT_GT(size.bytes, cut) << kind.name;
      ASSERT_LE(size.bytes, request.size()) << kind.name;
    }
    const std::size_t whole = request.size();
    request.resize(whole + 9, 0xFF);
    EXPECT_EQ(request_size(request, kMost).bytes, whole) << kind.name;
  }
}

TEST(Messages, CountsOfFourBillionAreRefusedBeforeTheirElements) {
  for (const RequestKind& kind : request_kinds()) {
    if (kind.element.empty()) continue;
    for (const std::uint32_t count : {0xFFFFFFFFu, 0x40000000u, 0x15555556u}) {
      Bytes request = request_of(kind.number, 0);
      const Bytes word = WireWriter().word(count).take();
      std::copy(word.begin(), word.end(), request.begin() + 4 + count_place(kind.number));
      EXPECT_EQ(request_size(request, kMost).state, RequestSize::State::too_large) << kind.name;
    }
  }
}

// What is not there is not what the program has: terrain, air of planets.
TEST(Messages, NotesAreTrueOfTerrain) {
  for (const RequestKind& kind : request_kinds())
    EXPECT_EQ(kind.note.find("no terrain"), kind.note.npos) << kind.name;
}

TEST(Messages, OtherNumbersAreUnknown) {
  for (const std::uint32_t number : {36u, 255u, 300u, 0x10000001u, 0xFFFFFFFFu})
    EXPECT_EQ(request_size(WireWriter().word(number).take(), kMost).state,
              RequestSize::State::unknown);
}

}  // namespace
}  // namespace panwright::server
