// Builds the scene of a VRML file; what both versions need of it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "importers/vrml/internal/session.h"

namespace panwright::importers::vrml {

class Builder {
 public:
  explicit Builder(Session& session);

  Session& session;

  // A node of the scene. Its name: `name` with "/" as "_", or if empty `kind` and a number. A shear
  // needs two nodes; the inner one is returned. Reports W6009 at `where` and returns scene::kNone
  // for a matrix that flattens space. Throws OverLimit.
  std::int32_t add_node(std::int32_t parent, const Mat4& parent_from_node, std::string_view name,
                        std::string_view kind, SourceSpan where);

  // Equal ones are stored once.
  std::int32_t add_shape(geometry::Shape shape, SourceSpan where);
  std::int32_t add_material(const materials::Material& material, const CadMaterial& cad);

  // The picture that some URLs name, or kNone: as Session::bytes_of. *components: 1 to 4.
  std::int32_t add_picture(std::span<const std::string_view> urls, SourceSpan where);
  std::int32_t add_texture(scene::Texture texture);

  // texture: scene::kNone for none
  void add_instance(std::int32_t node, std::int32_t shape, std::int32_t material,
                    std::int32_t texture, SourceSpan where);

  // Counted for the one note N6007 at the end: a node that makes no surface, by its type.
  void skipped(std::string_view type);
  // Counted for the one note N6008.
  void lost(std::string_view property);

  // Nodes on the way from the top, for cycles and depth. enter() reports E6109 and returns false
  // when the node stands in itself; throws OverLimit past limits.depth. Each true enter() needs a
  // leave().
  bool enter(const Node& node);
  void leave(const Node& node);
  // The same for files.
  bool enter(const Document& document, SourceSpan where);
  void leave(const Document& document);

  scene::Source source_of(SourceSpan where) const;

  scene::Scene& scene() { return out_.scene; }

  // Puts the notes into the log and gives the result.
  Imported finished(Format format);

 private:
  Imported out_;
};

// Makes scene nodes of a document's below `parent`, by its version. scene97.cpp and scene10.cpp
// hold one each; the third calls the one that fits, for inlined files.
void build97(Builder& builder, Document& document, std::int32_t parent);
void build10(Builder& builder, Document& document, std::int32_t parent);
void build(Builder& builder, Document& document, std::int32_t parent);

}  // namespace panwright::importers::vrml
