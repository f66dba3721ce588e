// Names that expressions know: parameters, and variables of repeats.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// A number in SI and what it measures. Dimension::none fits everywhere.
struct Quantity {
  double value = 0;
  schemas::Dimension dimension = schemas::Dimension::none;
  bool operator==(const Quantity&) const = default;
};

// The value of a parameter that could not be read, which has been reported: what is computed from
// it cannot be read either, without a report.
inline constexpr Quantity kUnread{std::numeric_limits<double>::quiet_NaN(),
                                  schemas::Dimension::none};

// What bare numbers of a file mean.
struct Units {
  std::size_t level = 0;  // of the language; units and expressions are read from level 1 on
  double length = 1;      // metres
  double angle = 0.017453292519943295;  // radians
};

// Whether a text can be a name in expressions: letters, digits and underscores, no digit first.
inline bool is_name(std::string_view text) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  if (text.empty() || !letter(text[0])) return false;
  for (const char c : text)
    if (!letter(c) && !(c >= '0' && c <= '9')) return false;
  return true;
}

// A name hides that of an outer scope. Addresses of values stay as long as the scope lives.
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
  // All that find() finds, for a did-you-mean.
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
