// Types and functions shared by the parts of check().
#pragma once

#include <cstdint>
#include <optional>
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

inline constexpr double kUnitQuaternionTolerance = 1e-12;  // of the squared length of unit vectors

inline constexpr std::uint64_t kNoElement = ~0ull;

// Invalid elements: the first index, and their number.
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

// Returns a string by its number, once the strings and the reference to it are checked.
inline std::string_view unchecked_string(const Model& model, std::uint32_t id) {
  const std::uint32_t* place = &model.string_offsets()[id];
  return {model.string_bytes().data() + place[0], place[1] - place[0]};
}

inline bool known(std::uint32_t kind) { return layout::is_known(kind); }

inline bool has_codec(const layout::DirectoryEntry& entry) {
  return entry.codec != static_cast<std::uint32_t>(layout::Codec::none);
}

// Returns true if the section holds no bytes and is derived from mesh streams.
inline bool is_derived(const layout::DirectoryEntry& entry) {
  return entry.codec == static_cast<std::uint32_t>(layout::Codec::streams);
}

// Returns true for the big arrays, which tables are checked before; unknown sections too.
inline bool is_array(std::uint32_t kind) {
  using layout::SectionKind;
  return !known(kind) || (kind >= static_cast<std::uint32_t>(SectionKind::positions) &&
                          kind <= static_cast<std::uint32_t>(SectionKind::texels));
}

// A section and its byte range, for messages: "section 'nodes' (bytes 128 to 512)".
std::string section_words(const layout::DirectoryEntry& entry);

// Elements of a section; of string_offsets, strings.
std::uint64_t count_of(const Model& model, layout::SectionKind kind);

// Checks the rules that all tables have in common: of fields, order, numbers of records.
Problems rule_problems(const Model& model);

// Checks the records of all tables and the strings. Without problems, the runs of every mesh and
// texture lie within their arrays and every reference between tables holds.
Problems table_problems(const Model& model);

// Checks the joints; returns their first problem.
//
// Expects: references that hold, nodes in order.
std::optional<Problem> joint_problem(const Model& model);

// Hashes every section, checks its padding, and, with contents, the elements of the arrays that are
// not compressed.
//
//   left  kind of a section of which only the padding is checked; 0: none
// Expects: contents only when table_problems found nothing.
enum class Part { tables, arrays };
Problems section_problems(const Model& model, Part part, bool contents, std::uint32_t left,
                          const Job& job);

// Decompresses the compressed arrays and checks their elements. A section with a problem has no
// contents.
//
// Expects: neither section_problems nor table_problems found anything.
Problems unpack_arrays(Model& model, const Job& job);

// Makes positions, normals and indices from the streams of meshes, unchecked. With a problem they
// have no contents.
//
// Expects: neither section_problems nor table_problems found anything.
Problems unpack_streams(Model& model, const Job& job);

// Unpacks the compressed tables, and resizes records of other sizes. A section with a problem has
// no contents.
//
// Expects: section_problems of the tables found nothing.
Problems unpack_tables(Model& model, const Job& job);

}  // namespace panwright::pan::internal
