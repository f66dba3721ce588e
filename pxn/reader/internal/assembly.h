// Walk through the items of parts, which makes the nodes of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pxn/reader/attach.h"
#include "pxn/reader/blankets.h"
#include "pxn/reader/joints.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/surfaces.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

class Assembler {
 public:
  Assembler(const Loader& loader, const Options& options, Reporter& reporter, scene::Scene& scene);

  bool run(std::uint32_t top);

 private:
  // Inherited by an item from those around it.
  struct Context {
    std::int32_t node = 0;
    Surface surface;
    std::string prefix;  // of names of frames, keypoints and lamps: the uses around
    std::int32_t texture = scene::kNone;
    Mat4 texture_from_node{1};
    Mat4 world_from_node{1};
  };

  // Use of a part. The first one shares its file id with the part; others get theirs when
  // something is reported.
  struct Use {
    const Part* part;
    FileId file;
    bool own_file;
    Use* outer;
    SourceSpan included_at;
    bool used = false;   // a part in its file, not an included file
    bool named = false;  // in names of frames, keypoints and lamps inside
    // for decals: items and instances by the names of their shapes, in the order of items; and the
    // items of those decals
    std::map<std::string, std::vector<std::pair<std::uint32_t, std::int32_t>>, std::less<>> shapes;
    std::vector<std::uint32_t> decals;
    // for wraps: the number of nodes before each item, and the context of each wrap
    std::vector<std::uint32_t> nodes_before;
    std::vector<std::pair<std::uint32_t, Context>> wraps;
  };

  void items_of(Use& use, const Context& context);
  void items(Use& use, std::uint32_t begin, std::uint32_t end, const Context& context);
  void item(Use& use, std::uint32_t index, const Context& context);

  // ---- nodes

  std::string numbered(const std::string& base);

  // The name itself the first time, then with a number; never one that is written in the same
  // place.
  std::string named(const Use& use, const std::string& base);
  bool is_written_in(const Use& use, const std::string& name);

  // The names of uses and includes in a part, and in what it includes without a name.
  const std::set<std::string>& written_in(const Part& part);
  const NodeProperties* properties_of(const Use& use, const Item& item) const;

  // As written, or after the element with a number.
  std::string name_of(const Use& use, const Item& item);
  scene::Transform transform_of(const Use& use, const Item& item) const;
  scene::Source source_of(const Use& use, const Item& item) const;

  // Makes a node below the context's, and the context its own.
  bool enter(Use& use, const Item& item, std::string name, const scene::Transform& transform,
             Context& context);
  void shape(Use& use, std::uint32_t index, Context& context);

  // ---- joints

  void joint(Use& use, const PartJoint& known, std::uint32_t element, std::int32_t node,
             const std::string& prefix);

  // The joints that stand for PartImport::moved: the first node's, which those of others follow.
  void import_joints(Use& use, const PartImport& place, const Context& context);

  // ---- blankets

  // Returns the properties common to all blankets of an element.
  FoilWish wish_of(Use& use, std::uint32_t element);

  // A blanket of a preset over all of an instance.
  void cover(Use& use, std::uint32_t element, std::int32_t instance, std::string_view preset,
             std::int32_t named, const scene::Source& source);

  // Once all nodes of the part are there. first: of its nodes.
  void wrap(Use& use, std::uint32_t index, const Context& around, std::int32_t top,
            std::uint32_t first);

  // Of those in the innermost repeat's run that holds some, or else of the whole part.
  std::vector<std::int32_t> wrapped_instances(const Use& use, const PartWrap& wrap,
                                              std::int32_t top, std::uint32_t first) const;
  void report_no_match(Use& use, const Item& item, const PartWrap& wrap, std::uint32_t first);

  template <class Compose>
  void report_at(Code code, Use& use, std::uint32_t element, const Compose& compose) {
    const xml::Document& document = use.part->file->document;
    SourceSpan where = document.tag_span(element);
    where.file = file_of(use);
    reporter_.report(code, where, document, element, compose);
  }

  void frame(Use& use, const Item& item, const Context& context);

  // Those of the CAD file that was attached last.
  void import_frames(Use& use, const Item& item);
  void keypoint(Use& use, const Item& item, const Context& context);
  void lamp(Use& use, const Item& item, const Context& context);

  // Once the shapes of the part are there.
  void decal(Use& use, const Item& item);

  // Returns true if a shape of that name stands in the part, though the scene has none: it was
  // wrong, which is reported elsewhere, or repeats 0 times. Names with expressions may be any.
  static bool is_written(const Part& part, std::string_view name);
  void report_missing_shape(Use& use, const Item& item, const std::string& name);

  // An included file or a used part.
  void part(Use& use, const Item& item, Context& context);

  // ---- CAD files

  void import(Use& use, const Item& item, Context& context);

  // ---- reports

  // The file id of this use, so that the include stack below a message is the right one.
  FileId file_of(Use& use);
  static SourceSpan place(const Use& use, const Item& item);
  SourceSpan place_in(Use& use, const Item& item);
  static SourceSpan material_place(const Use& use, const Item& item);

  template <class Compose>
  void report(Code code, Use& use, const Item& item, const Compose& compose) {
    reporter_.report(code, place_in(use, item), use.part->file->document, item.element, compose);
  }

  const Loader& loader_;
  const Options& options_;
  Reporter& reporter_;
  scene::Scene& scene_;
  std::map<std::string, std::uint32_t> counters_;
  std::set<std::string> labels_;
  std::set<std::string> keypoints_;
  std::set<std::string> lamps_;
  std::set<std::pair<const Part*, std::uint32_t>>
      missing_;                                            // decals without a shape, reported once
  std::set<std::pair<const Part*, std::uint32_t>> taken_;  // names of these, reported once
  std::set<std::string> made_;                             // by named()
  std::map<const Part*, std::set<std::string>> written_;   // by written_in()
  std::set<std::uint32_t> used_;
  Surfaces surfaces_;
  AttachedShapes attached_;
  Blankets blankets_;
  Joints joints_;
  SourceSpan first_import_;
  std::uint64_t includes_ = 0;
  bool stopped_ = false;
};

}  // namespace panwright::pxn
