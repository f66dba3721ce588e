// glTF file in memory: its JSON, buffers, views and accessors. Private to importers/gltf.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importers/gltf/json.h"
#include "importers/import.h"
#include "importers/internal/input_file.h"
#include "importers/internal/named_file.h"

namespace panwright::importers::gltf {

struct Buffer {
  SharedText owner;
  std::span<const std::byte> bytes;  // may be fewer than declared
  std::uint64_t declared = 0;
};

// Range of a buffer. Compressed ones hold the decoded bytes.
struct View {
  std::span<const std::byte> bytes;
  std::shared_ptr<std::vector<std::byte>> decoded;
  std::uint32_t stride = 0;  // 0: not given
  std::uint64_t offset = 0;  // in the buffer
  std::uint64_t length = 0;  // as declared, or decoded; 0: not known
  bool sound = false;
  bool compressed = false;
};

struct Sparse {
  std::uint64_t count = 0;
  int index_component = 0;
  std::size_t index_view = 0;
  std::uint64_t index_offset = 0;
  std::size_t value_view = 0;
  std::uint64_t value_offset = 0;
};

// Numbers of a view, all of them within it when valid.
struct Accessor {
  int component = 5126;  // GL's number: 5120 byte … 5126 float
  int width = 1;         // numbers of an element
  bool matrix = false;
  bool normalised = false;
  bool sound = false;
  std::uint64_t count = 0;
  std::ptrdiff_t view = -1;  // −1: all 0 but for sparse values, or Draco's
  std::uint64_t offset = 0;  // in the view
  std::uint64_t stride = 0;
  std::uint64_t element = 0;  // bytes of one
  bool is_sparse = false;
  Sparse sparse;
  const Json* json = nullptr;
  bool is_float() const { return component == 5126; }
};

std::size_t component_bytes(int component);  // 0: no such type

struct Document {
  Document(Files& store, const InputFile& input, const Options& wishes, DiagnosticLog& diagnostics)
      : files(store), file(input), options(wishes), log(diagnostics) {}

  Files& files;
  const InputFile& file;
  const Options& options;
  DiagnosticLog& log;
  FileId source = kNoFile;
  std::uint32_t json_begin = 0;  // of the JSON in the file
  bool text = false;             // places have lines and columns

  Json root;
  std::set<std::string> used;      // extensionsUsed
  std::set<std::string> required;  // extensionsRequired
  std::string_view binary;
  bool has_binary = false;
  std::vector<Buffer> buffers;
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<scene::Input> inputs;
  std::set<std::size_t> judged;  // accessors of vertices read in full, whose problems are reported
  std::uint64_t memory = 0;      // of decoded and zero-filled arrays
  std::uint64_t file_bytes = 0;  // of all files together

  bool uses(const std::string& extension) const { return used.contains(extension); }

  // object: a JSON pointer, as "/accessors/3".
  void report(Code code, std::uint32_t offset, const std::string& object, std::string message,
              std::string hint = {});
  void report(Code code, const Json* at, const std::string& object, std::string message,
              std::string hint = {}) {
    if (!at) at = &nearest(object);
    report(code, at->offset, object, std::move(message), std::move(hint));
  }

  // Returns the place of a byte of the JSON, of a JSON pointer's value or the nearest one.
  SourceSpan place_of(std::uint32_t offset) const;
  SourceSpan place_of(std::string_view object) const { return place_of(nearest(object).offset); }

  // Returns the value at a JSON pointer, or the last existing one on the way.
  const Json& nearest(std::string_view object) const;

  // Looks for the file of a URI; one that is found is an input of the scene. Reports W6215.
  NamedFile find_named(const Json& uri, const std::string& object, bool part);

  // Counts bytes before allocation. False, once reported as E6002: over the limit.
  bool charge(std::uint64_t bytes, const std::string& object);
};

// Returns "/meshes/3".
std::string pointer(std::string_view collection, std::size_t index);

// ---- the passes, in this order

// Schema of glTF 2.0 and of the extensions that are read: types, ranges, references. Invalid values
// are reported and removed from the tree, or marked as broken, so that the rest can be read.
// Reports E6204, E6205, W6215.
void check_schema(Document& document);

// Loads buffers and finds views. Reports E6206, E6210, W6005, W6215, E6002.
void load_buffers(Document& document);

// Reports E6204, E6206, E6207, W6215, E6002.
void check_accessors(Document& document);

// Cycles, parents, scenes, skins, cameras. Reports E6204, E6206 to E6208, W6215.
void check_nodes(Document& document);

}  // namespace panwright::importers::gltf
