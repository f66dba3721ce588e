// Reads files into parts, with all that they include.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>

#include "pxn/internal/files.h"
#include "pxn/internal/part.h"
#include "pxn/internal/reporter.h"
#include "pxn/internal/values.h"
#include "pxn/pxn.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Shapes, textures and inputs go into the scene, each once; parts say which of them stand where.
class Loader {
 public:
  Loader(Files& files, const Options& options, Reporter& reporter, scene::Scene& scene)
      : files_(files), options_(options), reporter_(reporter), scene_(scene) {}

  // The index of the part, or nothing when there is no root element that is understood, or more
  // elements than the limit.
  std::optional<std::uint32_t> load_top(const FoundFile& top);

  const Part& part(std::uint32_t index) const { return parts_[index]; }

 private:
  // One file at work.
  struct Work {
    Part& part;
    Values values;
    std::uint32_t level;  // of includes, 0 for the top file
    // line and column of the last item: positions are found in one walk over the text
    std::uint32_t offset = 0;
    std::uint32_t line = 1;
    std::uint32_t column = 1;
  };

  std::optional<std::uint32_t> load(const FoundFile& file, SourceSpan included_at,
                                    std::uint32_t level);
  void walk(Work& work, std::uint32_t element, std::uint32_t depth);
  void walk_children(Work& work, std::uint32_t element, std::uint32_t depth);
  std::uint32_t add_item(Work& work, ItemKind kind, std::uint32_t element, std::uint32_t data);
  void place_item(Work& work, Item& item);

  void read_group(Work& work, std::uint32_t element, std::uint32_t depth);
  std::uint32_t read_transform(Work& work, std::uint32_t element);
  std::uint32_t read_rotate(Work& work, std::uint32_t element);
  void read_frame(Work& work, std::uint32_t element);
  void read_sphere(Work& work, std::uint32_t element);
  void read_mesh(Work& work, std::uint32_t element);
  void read_include(Work& work, std::uint32_t element, std::uint32_t depth);
  std::optional<std::uint32_t> read_texture(Work& work, std::uint32_t element);
  std::optional<std::uint32_t> load_texture(Work& work, std::uint32_t element,
                                            const std::string& file, const FoundFile& found);

  // The file that an include names, or nothing: reported as E1301 or E1303.
  std::optional<FoundFile> find(Work& work, std::uint32_t element, std::size_t attribute,
                                const std::string& file);
  void add_input(const FoundFile& file, std::span<const std::byte> bytes);

  Files& files_;
  const Options& options_;
  Reporter& reporter_;
  scene::Scene& scene_;
  std::deque<Part> parts_;  // note: addresses stay while it grows
  std::map<std::string, std::optional<std::uint32_t>> known_parts_;     // by key
  std::map<std::string, std::optional<std::uint32_t>> known_textures_;  // by key
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known_spheres_;
  bool complete_ = true;             // false: a limit was reached
  std::uint64_t elements_ = 0;       // so far
  std::uint64_t texture_bytes_ = 0;  // so far
};

// The first child of an element that has this id, or 0.
std::uint32_t child_of(const xml::Document& document, std::uint32_t element, schemas::ElementId id);

}  // namespace panwright::pxn
