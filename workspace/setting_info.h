// Description of settings: types, bounds, words of messages, options of the command line, rules.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "workspace/generated/settings.h"

namespace panwright::workspace {

// JSON types, as bits.
enum SettingForm : std::uint8_t {
  kFormText = 1,
  kFormNumber = 2,
  kFormFlag = 4,
  kFormNumbers = 8,
  kFormTexts = 16,
  kFormMap = 32
};

// Units of a number in a text; bare ones are degrees, metres, shares, bytes.
enum class SettingUnit : std::uint8_t { none, angle, length, share, bytes };

enum class EngineSet : std::uint8_t { gl, reference, both };  // as Settings::Engine

// Presence in the record of an image.
enum class Recorded : std::uint8_t { changed, given, always, never };

enum SettingFlag : std::uint8_t {
  kAbove = 1,      // `least` is no value
  kBelow = 2,      // `most` is no value
  kSeveral = 4,    // several numbers
  kDirection = 8,  // not zero
};

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct SettingInfo {
  std::string_view name;                    // "sun-points"
  std::uint8_t forms;                       // SettingForm
  std::uint8_t of;                          // SettingForm of the values of a map
  std::uint8_t count;                       // of `numbers`; 0: any
  SettingUnit unit;                         // of a text
  std::span<const std::string_view> words;  // by value of the enumeration
  double least, most;                       // SI, radians
  std::uint8_t flags;                       // SettingFlag
  EngineSet engine;                         // those with it
  Recorded record;
  std::string_view expect;   // "has the wrong type, expected …"
  std::string_view accepts;  // "is …, expected …"
  const char* option;        // "--sun-points" or "-o,--output"; empty: none
  const char* section;       // of the help
  const char* metavar;       // empty: a flag
  const char* help;
};

// Set of settings.
struct SettingMask {
  static constexpr unsigned kBits = 128;
  std::uint64_t words[2] = {0, 0};

  constexpr bool any() const { return (words[0] | words[1]) != 0; }
  constexpr int count() const { return std::popcount(words[0]) + std::popcount(words[1]); }
  friend constexpr SettingMask operator|(const SettingMask& a, const SettingMask& b) {
    return {{a.words[0] | b.words[0], a.words[1] | b.words[1]}};
  }
  friend constexpr SettingMask operator&(const SettingMask& a, const SettingMask& b) {
    return {{a.words[0] & b.words[0], a.words[1] & b.words[1]}};
  }
  constexpr SettingMask operator~() const { return {{~words[0], ~words[1]}}; }
};

constexpr SettingMask bit(SettingId id) {
  const auto number = static_cast<unsigned>(id);
  SettingMask out;
  out.words[number / 64] = std::uint64_t{1} << number % 64;
  return out;
}

// Settings that exclude one another: those of `first` and those of `others`.
struct Exclusion {
  SettingMask first, others;
  std::string_view says;  // empty: each only replaces the others
};

// Need of a setting for values of another, where `applies`.
struct Requirement {
  SettingId setting, other;
  bool any;  // of all its values
  bool (*applies)(const Settings&);
  bool (*holds)(const Settings&);
  std::string_view says;
};

struct Preset {
  SettingId setting;
  bool (*applies)(const Settings&);
  void (*set)(Settings&);
};

struct Idle {
  SettingId setting;
  bool (*applies)(const Settings&);
};

}  // namespace panwright::workspace
