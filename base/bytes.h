// Numbers as bytes of this processor: keys and entries of caches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/hash.h"

namespace panwright {

// True where the bytes of a value identify it, as with a vector of doubles; false with padding.
// note: glm's vectors have a constructor of their own, so they are not trivially copyable by name
template <class T>
inline constexpr bool kIsPlain =
    std::is_standard_layout_v<T>&& std::is_trivially_destructible_v<T> && !std::is_pointer_v<T>;

// Hash of a sequence of numbers. Lists are preceded by their length, so that no two sequences of
// numbers and lists run into one.
class KeyHasher {
 public:
  void number(std::uint64_t value) { hasher_.update(std::as_bytes(std::span(&value, 1))); }
  void real(double value) { hasher_.update(std::as_bytes(std::span(&value, 1))); }
  template <class T>
  void list(std::span<const T> values) {
    static_assert(kIsPlain<T>);
    number(values.size());
    hasher_.update(std::as_bytes(values));
  }
  template <class T>
  void list(const std::vector<T>& values) {
    list(std::span<const T>(values));
  }
  void text(std::string_view value) { list(std::span(value.data(), value.size())); }
  void hash(const Hash128& value) {
    number(value.low);
    number(value.high);
  }
  Hash128 key() const { return hasher_.digest128(); }

 private:
  Hasher hasher_;
};

class ByteWriter {
 public:
  void number(std::uint64_t value) { add(std::as_bytes(std::span(&value, 1))); }
  void real(double value) { add(std::as_bytes(std::span(&value, 1))); }
  template <class T>
  void list(std::span<const T> values) {
    static_assert(kIsPlain<T>);
    number(values.size());
    add(std::as_bytes(values));
  }
  template <class T>
  void list(const std::vector<T>& values) {
    list(std::span<const T>(values));
  }
  void text(std::string_view value) { list(std::span(value.data(), value.size())); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void add(std::span<const std::byte> more);
  std::vector<std::byte> bytes_;
};

// Reader of a ByteWriter's bytes, call for call. Bytes that end too early give zeros and good()
// false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}

  std::uint64_t number() { return one<std::uint64_t>(); }
  double real() { return one<double>(); }
  template <class T>
  void list(std::vector<T>& to) {
    static_assert(kIsPlain<T>);
    const std::uint64_t count = number();
    to.clear();
    good_ = good_ && count <= left_.size() / sizeof(T);
    if (!good_ || count == 0) return;
    to.resize(count);
    std::memcpy(static_cast<void*>(to.data()), left_.data(), count * sizeof(T));
    left_ = left_.subspan(count * sizeof(T));
  }
  std::string text() {
    std::vector<char> out;
    list(out);
    return {out.begin(), out.end()};
  }
  // Marks the bytes as invalid.
  void fail() { good_ = false; }
  bool good() const { return good_; }
  bool at_end() const { return good_ && left_.empty(); }

 private:
  template <class T>
  T one() {
    T value{};
    good_ = good_ && left_.size() >= sizeof value;
    if (!good_) return value;
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  std::span<const std::byte> left_;
  bool good_ = true;
};

}  // namespace panwright
