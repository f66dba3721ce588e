// The header of a PLY file, and its numbers one after another. Private to importers/meshes.
//
// Format: G. Turk, "The PLY polygon file format", 1994.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::importers::meshes {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<PlyType> ply_type_of(std::string_view name);
std::size_t bytes_of(PlyType type);
inline bool is_float(PlyType type) { return type >= PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count;  // of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  // as announced
  std::vector<PlyProperty> properties;
  // The fewest bytes that one takes in the file.
  std::uint64_t least_bytes(bool text) const;
};

enum class PlyOrder : std::uint8_t { text, little, big };

struct PlyHeader {
  PlyOrder order = PlyOrder::text;
  std::vector<PlyElement> elements;
  std::string texture;      // of "comment TextureFile"
  std::string_view body;    // of the file's bytes
  std::string_view credit;  // a line of the program that wrote it, without "comment"
  std::string problem;      // one lower-case sentence; empty: none
  std::string_view place;   // of the file's bytes: what the problem is about
};

// Stops at the first problem: without the header nothing of the body can be found.
PlyHeader ply_header_of(std::string_view bytes);

// Reads the body, one number after another.
class PlyValues {
 public:
  enum class Got : std::uint8_t { number, word, end };  // word: it is no number

  PlyValues(std::string_view body, PlyOrder order) : body_(body), order_(order) {}

  Got next(PlyType type, double& number);
  // Passes over that many bytes; false where there are not so many.
  bool skip(std::uint64_t bytes);
  // Of a text: to the end of the line.
  void skip_line();

  std::uint64_t left() const { return body_.size() - at_; }
  std::size_t offset() const { return begin_; }  // in the body, of what was read last
  std::string_view last() const { return body_.substr(begin_, at_ - begin_); }

 private:
  std::string_view body_;
  PlyOrder order_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;
};

}  // namespace panwright::importers::meshes
