// Records of the tables whose contents say all of them: generated, field by field.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/hash.h"
#include "base/math.h"
#include "pan/writer.h"

namespace panwright::pan::internal {

inline void store(double* to, const Vec3& v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

inline void store(double* to, const Quat& q) {
  to[0] = q.w;
  to[1] = q.x;
  to[2] = q.y;
  to[3] = q.z;
}

inline void store(std::uint64_t* to, const Hash128& hash) {
  to[0] = hash.low;
  to[1] = hash.high;
}

template <class T, std::size_t N>
void store(T* to, const std::array<T, N>& values) {
  std::copy(values.begin(), values.end(), to);
}

template <class Record>
void append(std::vector<std::byte>& to, const Record& record) {
  const auto bytes = std::as_bytes(std::span(&record, 1));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// Appends the records of a section's contents. Nothing: pan/contents.cpp makes them.
void add_records(const TableContents& contents, layout::SectionKind kind, StringTable& strings,
                 std::vector<std::byte>& to);

}  // namespace panwright::pan::internal
