// Labels in ODL and PVL: of PDS3 files and ISIS cubes. Private to terrain.
//
// Sources: PDS Standards Reference 3.8, 12 (ODL); ISIS, "PVL".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::terrain {

struct LabelValue {
  std::string text;  // without quotes
  std::string unit;  // of <…>, lower case; may be empty
};

// A keyword, or an object or group with its own.
struct LabelItem {
  std::string name;                // upper case, without a leading '^'
  bool pointer = false;            // it had one
  std::vector<LabelValue> values;  // of a list several; the name of an object
  std::vector<LabelItem> items;    // of an object or group
  bool block = false;
};

struct Label {
  LabelItem root;
  std::size_t end = 0;  // bytes up to the end of the line of END
  bool ended = false;   // END stands there
};

// Largest label that is looked for.
inline constexpr std::size_t kMostLabel = 4u << 20;

// Reads a label from the front of some bytes. Never fails: what is no statement ends it.
Label read_label(std::string_view text);

// First item of a name, in the item or below, breadth first; null: none.
const LabelItem* find(const LabelItem& in, std::string_view name);
const LabelItem* find_pointer(const LabelItem& in, std::string_view name);
// First block of a name.
const LabelItem* find_block(const LabelItem& in, std::string_view name);

// Text of an item's first value; empty: none, or N/A and the like.
std::string text_of(const LabelItem& in, std::string_view name);
// Number of it. 16#…# is a bit pattern, which is not a number.
std::optional<double> number_of(const LabelItem& in, std::string_view name);
std::optional<std::uint64_t> count_of(const LabelItem& in, std::string_view name);
// Bit pattern "16#FF7FFFFB#", or any other base up to 16.
std::optional<std::uint64_t> pattern_of(std::string_view text);
// Metres of an item with a unit of length; without one `bare` metres.
std::optional<double> metres_of(const LabelItem& in, std::string_view name, double bare);

std::string upper_case(std::string_view text);
// Metres of a unit as labels write it ("KM", "<meters/pixel>"); none: not a length.
std::optional<double> metres_of_unit(std::string_view unit);

}  // namespace panwright::terrain
