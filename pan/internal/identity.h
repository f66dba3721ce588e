// The build identity (docs/pan-format.md), one input at a time.
#pragma once

#include <string_view>

#include "base/file.h"
#include "base/hash.h"

namespace panwright::pan::internal {

class IdentityHasher {
 public:
  void input(Hash128 hash, std::uint64_t bytes, std::string_view path) {
    number(hash.low);
    number(hash.high);
    number(bytes);
    text(path);
  }
  Hash128 finish(std::string_view version, std::string_view options) {
    text(version);
    text(options);
    return hasher_.digest128();
  }

 private:
  void number(std::uint64_t value) { hasher_.update(std::as_bytes(std::span(&value, 1))); }
  void text(std::string_view value) {
    number(value.size());
    hasher_.update(as_bytes(value));
  }
  Hasher hasher_;
};

}  // namespace panwright::pan::internal
