// Values of settings, each with its provenance.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/math.h"
#include "workspace/joints.h"
#include "world/camera.h"

namespace panwright::workspace {

// Provenance of a value, the stronger ones later.
enum class Origin : std::uint8_t { standard, preset, given };

// Value that has a default, or none, until it is assigned.
template <class T>
class Setting {
 public:
  Setting() = default;
  explicit Setting(T standard) : value_(std::move(standard)) {}
  Setting& operator=(T value) {
    value_ = std::move(value);
    origin_ = Origin::given;
    return *this;
  }
  // Sets the value of a preset, which no default is and which an author may replace.
  void preset(T value) {
    value_ = std::move(value);
    origin_ = Origin::preset;
  }
  // Returns true for a given value or that of a preset.
  explicit operator bool() const { return origin_ != Origin::standard; }
  bool given() const { return origin_ == Origin::given; }
  // Returns the value or its default; zero without one.
  const T& operator*() const { return value_; }
  const T* operator->() const { return &value_; }
  bool operator==(const Setting&) const = default;

 private:
  T value_{};
  Origin origin_ = Origin::standard;
};

// Number, or a word in its place.
template <class Word, class Number>
struct NumberOr {
  std::optional<Number> number;
  Word word{};
  NumberOr() = default;
  NumberOr(Number from) : number(from) {}
  NumberOr(Word from) : word(from) {}
  bool operator==(const NumberOr&) const = default;
};

struct ImageSize {
  std::uint32_t width = 0;   // pixels
  std::uint32_t height = 0;  // pixels
  bool operator==(const ImageSize&) const = default;
};

struct PoseSetting {
  std::string target;  // its name; empty: the only one
  world::Pose pose;    // world_from_model
  bool operator==(const PoseSetting&) const = default;
};

}  // namespace panwright::workspace
