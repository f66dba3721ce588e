// Names in expressions: parameters, and variables of repeats.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// Number and its dimension. Dimension::none fits everywhere.
struct Quantity {
  double value = 0;  // a length in `length`, else in SI
  schemas::Dimension dimension = schemas::Dimension::none;
  // In metres and radians: the units of the number's file, which a bare number has as a length or
  // an angle. 0: metres; a bare number then fits in every file.
  double length = 0;
  double angle = 0;
  int pi = 0;          // of a bare number: the power of pi in it; with one, it counts as radians
  bool ratio = false;  // a bare number derived from lengths or angles: neither degrees nor radians

  // Uses of a name so far: bits of Use. note: no part of the value
  enum Use : std::uint8_t { as_length = 1, as_angle = 2, as_plain = 4 };
  mutable std::uint8_t uses = 0;

  bool operator==(const Quantity& other) const {
    return value == other.value && dimension == other.dimension && length == other.length &&
           angle == other.angle && pi == other.pi && ratio == other.ratio;
  }
};

// Value of an unreadable, reported parameter: its dependants are unreadable too, without a report.
inline constexpr Quantity kUnread{std::numeric_limits<double>::quiet_NaN(),
                                  schemas::Dimension::none};

// Units of bare numbers of a file.
struct Units {
  std::size_t level = 0;  // of the language; units and expressions are read from level 1 on
  double length = 1;      // metres
  double angle = 0.017453292519943295;  // radians
};

// Returns true if a text can be a name in expressions: letters, digits and underscores, no digit
// first.
inline bool is_name(std::string_view text) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  if (text.empty() || !letter(text[0])) return false;
  for (const char c : text)
    if (!letter(c) && !(c >= '0' && c <= '9')) return false;
  return true;
}

// Names and their values. A name hides that of an outer scope. Addresses of values stay as long as
// the scope lives.
class Scope {
 public:
  explicit Scope(const Scope* outer = nullptr) : outer_(outer) {}

  void set(std::string_view name, const Quantity& value) {
    values_.insert_or_assign(std::string(name), value);
  }
  const Quantity* find(std::string_view name) const {
    const auto own = values_.find(name);
    if (own != values_.end()) return &own->second;
    return outer_ == nullptr ? nullptr : outer_->find(name);
  }
  bool has_own(std::string_view name) const { return values_.contains(name); }
  // Returns all names of find(), for a did-you-mean.
  std::vector<std::string_view> names() const {
    std::vector<std::string_view> all =
        outer_ == nullptr ? std::vector<std::string_view>{} : outer_->names();
    for (const auto& [name, value] : values_) all.push_back(name);
    return all;
  }
  const std::map<std::string, Quantity, std::less<>>& own() const { return values_; }

 private:
  const Scope* outer_;
  std::map<std::string, Quantity, std::less<>> values_;
};

}  // namespace panwright::pxn
