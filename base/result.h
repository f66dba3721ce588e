// A value, or nothing after a reported error.
#pragma once

#include <cassert>
#include <optional>
#include <utility>

namespace panwright {

struct Failed {};
// The return value of a function that has reported an error: `return failed;`
inline constexpr Failed failed{};

// A T, or nothing. The errors are in the DiagnosticLog of the call.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Failed) {}

  explicit operator bool() const { return value_.has_value(); }
  bool ok() const { return value_.has_value(); }

  // Expects: ok().
  T& operator*() & {
    assert(value_);
    return *value_;
  }
  const T& operator*() const& {
    assert(value_);
    return *value_;
  }
  T&& operator*() && {
    assert(value_);
    return std::move(*value_);
  }
  T* operator->() {
    assert(value_);
    return &*value_;
  }
  const T* operator->() const {
    assert(value_);
    return &*value_;
  }

 private:
  std::optional<T> value_;
};

}  // namespace panwright
