// Header and values of a PLY file. Private to importers/meshes.
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
  std::string_view place;  // of the file's bytes: its name
  PlyType type = PlyType::float32;
  std::optional<PlyType> count;  // of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  // as announced
  std::vector<PlyProperty> properties;
  // Returns the smallest size in the file, bytes.
  std::uint64_t least_bytes(bool text) const;
};

enum class PlyOrder : std::uint8_t { text, little, big };

struct PlyHeader {
  PlyOrder order = PlyOrder::text;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  // of lines "comment TextureFile"
  std::string_view body;              // of the file's bytes
  std::string_view credit;            // name of the writing program, without "comment"
  std::string problem;                // one lower-case sentence; empty: none
  std::string_view place;             // of the file's bytes: place of the problem
};

// Parses the header, up to the first problem: without the header the body cannot be read.
PlyHeader ply_header_of(std::string_view bytes);

// Reader of the body, one number after another.
class PlyValues {
 public:
  enum class Got : std::uint8_t { number, word, end };  // word: not a number

  PlyValues(std::string_view body, PlyOrder order) : body_(body), order_(order) {}

  Got next(PlyType type, double& number);
  // Skips bytes; false if there are fewer.
  bool skip(std::uint64_t bytes);
  // Skips to the end of a text line.
  void skip_line();

  std::uint64_t left() const { return body_.size() - at_; }
  std::size_t offset() const { return begin_; }  // in the body, of the last value read
  std::string_view last() const { return body_.substr(begin_, at_ - begin_); }

 private:
  std::string_view body_;
  PlyOrder order_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;
};

}  // namespace panwright::importers::meshes
