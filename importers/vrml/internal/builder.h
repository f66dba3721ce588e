// Builder of the scene of a VRML file, for both versions.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "importers/internal/lost.h"
#include "importers/vrml/internal/reader_context.h"

namespace panwright::importers::vrml {

// Numbers of a Material of either version, linear as written.
struct Phong {
  Vec3 diffuse{0.8};
  Vec3 specular{0};
  Vec3 emissive{0};
  double shininess = 0.2;
  double transparency = 0;
};

struct Cache97;

class Builder {
 public:
  explicit Builder(ReaderContext& of);

  ReaderContext& context;
  // The nodes being added occur only once: nothing of them need be cached.
  bool once = false;

  // Adds a node. Its name: `name` with "/" as "_", or if empty `kind` and a number. A shear needs
  // two nodes; the inner one is returned. Reports W6009 at `where` and returns scene::kNone for a
  // matrix that flattens space. Throws OverLimit.
  std::int32_t add_node(std::int32_t parent, const Mat4& parent_from_node, std::string_view name,
                        std::string_view kind, SourceSpan where);

  // Adds a shape; equal ones are stored once. Throws OverLimit for more triangles than the limit.
  std::int32_t add_shape(geometry::Shape shape, SourceSpan where);
  std::int32_t add_material(const materials::Material& material, const CadMaterial& cad);
  // Adds Blinn-Phong with exponent 128·shininess; numbers are clamped to 0…1. Transparency is
  // counted as lost.
  std::int32_t add_phong(const Phong& phong, std::string_view name, bool textured,
                         SourceSpan where);

  // Adds the texture of some URLs, or returns kNone: as ReaderContext::bytes_of.
  std::int32_t add_texture(std::span<const std::string_view> urls, SourceSpan where);
  // Adds the texture of an SFImage, bottom row first in the file; kNone: none, or past the limit.
  std::int32_t add_image(std::span<const std::int32_t> image, SourceSpan where);
  std::int32_t add_texture(scene::Texture texture);
  bool is_grey(std::int32_t texture) const;  // VRML 97: then multiplies the diffuse colour

  // texture: scene::kNone for none
  void add_instance(std::int32_t node, std::int32_t shape, std::int32_t material,
                    std::int32_t texture, SourceSpan where);

  // Counts a node without surface, by its type, for the single note N6007.
  void skipped(std::string_view type);
  // Counts a lost property for the single note W6008.
  void lost(std::string_view property, SourceSpan where);
  // Counts a non-repeating texture as lost if the coordinates of its mesh leave it.
  void lost_clamping(std::int32_t shape, bool repeat_s, bool repeat_t, SourceSpan where);

  // Tracks the nodes from the top, for cycles and depth. enter() reports E6109 and returns false
  // when the node contains itself; throws OverLimit past limits.depth, and for more visits than
  // limits.nodes. Each true enter() needs a leave().
  bool enter(const Node& node);
  void leave(const Node& node);
  // The same for files.
  bool enter(const Document& document, SourceSpan where);
  void leave(const Document& document);

  scene::Source source_of(SourceSpan where);

  scene::Scene& scene() { return out_.scene; }

  std::shared_ptr<Cache97> cache97;  // results of scene97.cpp so far
  std::uint64_t triangles_made = 0;  // by scene10.cpp, later deduplicated shapes included

  // Reports the notes for the named file, and returns the result.
  Imported finished(Format format, std::string_view file_name);

 private:
  std::int32_t kept_texture(scene::Texture texture, SourceSpan where);

  Imported out_;
  std::unordered_map<std::string, std::uint32_t> kinds_;  // numbers given to unnamed nodes
  struct ByLow {
    std::size_t operator()(const Hash128& hash) const { return hash.low; }
  };
  std::unordered_map<Hash128, std::int32_t, ByLow> shapes_;
  // by name and distinguishing values
  std::multimap<std::pair<std::string, std::vector<double>>, std::int32_t> materials_;
  std::map<std::string, std::int32_t> texture_cache_;  // by path
  std::map<std::string, std::int32_t> asked_;          // by requesting file, and all URLs
  std::vector<bool> grey_;
  std::map<std::string, std::uint64_t, std::less<>> skipped_;
  LostProperties lost_;
  std::unordered_map<std::uint64_t, Position> positions_;  // by file and byte
  std::vector<const Node*> open_nodes_;
  std::vector<const Document*> open_documents_;
  std::uint64_t visits_ = 0;
  std::uint64_t triangles_ = 0;
  std::uint64_t texture_bytes_ = 0;
};

// Builds scene nodes of a document below `parent`, by its version. Implemented in scene97.cpp and
// scene10.cpp; the third calls the fitting one, for inlined files.
void build97(Builder& builder, Document& document, std::int32_t parent);
void build10(Builder& builder, Document& document, std::int32_t parent);
void build(Builder& builder, Document& document, std::int32_t parent);

}  // namespace panwright::importers::vrml
