// Identifiers of states that change.
#pragma once

#include <atomic>
#include <cstdint>

namespace panwright {

// Identifier of a state, unique in a process: equal stamps mean equal states, in one owner or in a
// copy of it. 0 is never given.
using Stamp = std::uint64_t;

// The stamp of every default state.
inline constexpr Stamp kFirstStamp = 1;

// Returns a stamp that no state has. Thread-safe.
inline Stamp next_stamp() {
  static std::atomic<Stamp> last{kFirstStamp};
  return ++last;
}

}  // namespace panwright
