// What the parts of check() tell each other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "pan/model.h"

namespace panwright::pan::internal {

struct Problem {
  Code code;
  std::string message;
};
using Problems = std::vector<Problem>;

inline constexpr std::uint64_t kNoElement = ~0ull;

// Where, among many elements, something is wrong: the first place, and how many there are.
struct Tally {
  std::uint64_t first = kNoElement;
  std::uint64_t count = 0;
  void add(std::uint64_t element) {
    first = element < first ? element : first;
    ++count;
  }
  void add(const Tally& other) {
    first = other.first < first ? other.first : first;
    count += other.count;
  }
};

// A string by its number, once the strings and the reference to it are known to be sound.
inline std::string_view unchecked_string(const Model& model, std::uint32_t id) {
  const std::uint32_t* place = &model.string_offsets()[id];
  return {model.string_bytes().data() + place[0], place[1] - place[0]};
}

// Checks the records of all tables and the strings. When it finds nothing, the runs of every mesh
// and texture lie within their arrays and every reference between tables holds.
Problems table_problems(const Model& model);

// Hashes every section, checks its padding, and, with contents, what stands in the arrays.
//
// Expects: contents only when table_problems found nothing.
enum class Part { tables, arrays };
Problems section_problems(const Model& model, Part part, bool contents, const Job& job);

}  // namespace panwright::pan::internal
