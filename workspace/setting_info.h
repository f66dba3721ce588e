// Description of settings: types, bounds, words of messages, options of the command line, rules.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
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

class SettingSet {
 public:
  constexpr SettingSet() = default;
  constexpr SettingSet(std::initializer_list<SettingId> ids) {
    for (const SettingId id : ids) insert(id);
  }
  constexpr void insert(SettingId id) { words_[index(id) / 64] |= one(id); }
  constexpr bool has(SettingId id) const { return (words_[index(id) / 64] & one(id)) != 0; }
  constexpr int count() const {
    int sum = 0;
    for (const std::uint64_t word : words_) sum += std::popcount(word);
    return sum;
  }
  constexpr bool meets(const SettingSet& other) const { return (*this & other).count() > 0; }

  constexpr SettingSet operator|(SettingSet other) const {
    for (std::size_t i = 0; i < words_.size(); ++i) other.words_[i] |= words_[i];
    return other;
  }
  constexpr SettingSet operator&(SettingSet other) const {
    for (std::size_t i = 0; i < words_.size(); ++i) other.words_[i] &= words_[i];
    return other;
  }
  constexpr SettingSet without(const SettingSet& other) const {
    SettingSet rest = *this;
    for (std::size_t i = 0; i < words_.size(); ++i) rest.words_[i] &= ~other.words_[i];
    return rest;
  }

 private:
  static constexpr std::size_t index(SettingId id) { return static_cast<std::size_t>(id); }
  static constexpr std::uint64_t one(SettingId id) { return std::uint64_t{1} << index(id) % 64; }

  std::array<std::uint64_t, 4> words_{};  // SettingId has 8 bits
};

// Settings that exclude one another: those of `first` and those of `others`.
struct Exclusion {
  SettingSet first, others;
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
