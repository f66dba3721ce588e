#include "importers/step/internal/document.h"

#include <fmt/core.h>

#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <istream>
#include <limits>
#include <map>
#include <streambuf>
#include <unordered_map>
#include <utility>

#include "base/text.h"
#include "importers/internal/placed_node.h"
#include "importers/step/internal/bodies.h"
#include "importers/step/internal/entities.h"
#include "importers/step/internal/labels.h"
#include "importers/step/internal/wire.h"

namespace panwright::importers::step {

namespace {

constexpr std::int32_t kInherited = -1;  // the colour of a face that has none

// Bytes as a stream, without a copy.
class Bytes : public std::streambuf {
 public:
  explicit Bytes(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }
};

// What OpenCASCADE prints is not ours: nothing reaches the terminal while this lives.
class Silence {
 public:
  Silence() : printers_(Message::DefaultMessenger()->Printers()) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  ~Silence() { Message::DefaultMessenger()->ChangePrinters() = printers_; }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  Message_SequenceOfPrinters printers_;
};

// OpenCASCADE's unit of length, which the host may have set to another one.
class Millimetres {
 public:
  Millimetres() : before_(Interface_Static::CVal(kName)) { Interface_Static::SetCVal(kName, "MM"); }
  ~Millimetres() { Interface_Static::SetCVal(kName, before_.c_str()); }
  Millimetres(const Millimetres&) = delete;
  Millimetres& operator=(const Millimetres&) = delete;

 private:
  static constexpr const char* kName = "xstep.cascade.unit";
  const std::string before_;
};

Mat4 matrix_of(const gp_Trsf& transform) {
  Mat4 out(1);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      out[column][row] = transform.Value(row + 1, column + 1);
    out[3][row] = transform.Value(row + 1, 4) / kMetre;
  }
  return out;
}

// A solid, a shell, or loose faces of a part.
struct Body {
  TopoDS_Shape shape;  // at the part's origin when placed
  Mat4 part_from_body{1};
  std::string name;
  std::vector<std::int32_t> colors;  // of its faces
};

// What stands at a body's node.
struct Look {
  std::int32_t shape = 0;
  std::int32_t color = kInherited;
};

struct Made {
  Mat4 body_from_shape{1};
  std::vector<Look> looks;
};

struct Part {
  std::vector<Body> bodies;
  std::vector<Made> made;  // for each body
  std::optional<Colour> color;
  std::string material;
};

class Reading {
 public:
  Reading(const Text& text, const std::string& path, const std::string& name,
          const Options& options, DiagnosticLog& log, const Job& job)
      : text_(text), path_(path), name_(name), options_(options), log_(log), job_(job) {
    scene::Node root;
    root.name = "root";
    root.source = {path, 0, 0};
    out_.format = Format::step;
    out_.in_metres = true;
    out_.scene.nodes.push_back(root);
  }

  Result<Imported> run(std::string_view bytes) {
    STEPCAFControl_Controller::Init();
    const Millimetres unit;
    STEPCAFControl_Reader reader;
    reader.SetColorMode(Standard_True);
    reader.SetNameMode(Standard_True);
    reader.SetMatMode(Standard_True);
    reader.SetPropsMode(Standard_False);
    reader.SetGDTMode(Standard_False);
    reader.SetViewMode(Standard_False);
    Bytes buffer(bytes);
    std::istream stream(&buffer);
    if (reader.ChangeReader().ReadStream("model.step", stream) != IFSelect_RetDone)
      return refused("OpenCASCADE cannot read it");
    model_ = Handle(StepData_StepModel)::DownCast(reader.Reader().WS()->Model());
    if (model_.IsNull()) return refused("OpenCASCADE cannot read it");
    if (auto numbers = torn(model_); !numbers.empty()) throw Torn{std::move(numbers)};
    if (!check_assembly(model_, text_, options_.limits, log_)) return failed;
    const std::vector<double> units = length_units(model_);
    out_.lacks_unit = units.empty();
    out_.file_unit = units.empty() ? 1 / kMetre : units.size() == 1 ? units[0] : 0;
    Handle(TDocStd_Document) document = new TDocStd_Document("XmlXCAF");
    job_.poll();
    const bool done = reader.Transfer(document);
    job_.poll();
    note_failures(reader);
    if (!done) return refused("it has no product");
    return build(document);
  }

 private:
  Failed refused(std::string message) {
    log_.report_file(Code("E6601"), name_, std::move(message));
    return failed;
  }

  std::uint64_t number_of(const Handle(Standard_Transient) & entity) const {
    return step::number_of(model_, entity);
  }

  void report_lost(std::uint64_t number, std::string message) {
    const SourceSpan where = place_of(text_, number);
    if (where.file == kNoFile)
      log_.report_file(Code("W6602"), name_, std::move(message));
    else
      log_.report(Code("W6602"), where, std::move(message));
  }

  // Entities that became nothing, and which shape came from where.
  void note_failures(const STEPCAFControl_Reader& reader) {
    const Handle(XSControl_TransferReader)& transfer = reader.Reader().WS()->TransferReader();
    if (transfer.IsNull() || transfer->TransientProcess().IsNull()) return;
    const Handle(Transfer_TransientProcess)& process = transfer->TransientProcess();
    for (int i = 1; i <= process->NbMapped(); ++i) {
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process->MapItem(i));
      if (!shape.IsNull()) made_from_.try_emplace(shape.TShape().get(), process->Mapped(i));
    }
    Interface_CheckIterator checks = process->CheckList(Standard_True);
    for (checks.Start(); checks.More(); checks.Next()) {
      const Handle(Interface_Check)& check = checks.Value();
      if (check->NbFails() == 0) continue;
      std::string_view said = check->CFail(1);
      said.remove_prefix(std::min(said.find_first_not_of(' '), said.size()));
      report_lost(number_of(check->Entity()), fmt::format("OpenCASCADE: {}", said));
    }
  }

  Handle(Standard_Transient) entity_of(const TopoDS_Shape& shape) const {
    if (shape.IsNull()) return {};
    const auto it = made_from_.find(shape.TShape().get());
    return it == made_from_.end() ? Handle(Standard_Transient)() : it->second;
  }
  std::uint64_t number_of(const TopoDS_Shape& shape) const { return number_of(entity_of(shape)); }

  // What the file calls a solid or shell; "NONE" is what programs write for no name.
  std::string item_name(const TopoDS_Shape& shape) const {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity_of(shape));
    if (item.IsNull() || item->Name().IsNull()) return {};
    const std::string name = item->Name()->ToCString();
    return name == "NONE" ? std::string() : name;
  }

  scene::Source source_of(std::uint64_t number) const {
    const SourceSpan where = place_of(text_, number);
    if (where.file == kNoFile) return {path_, 0, 0};
    const Position at = log_.sources().position(where.file, where.begin);
    return {path_, at.line, at.column};
  }

  Result<Imported> build(const Handle(TDocStd_Document) & document) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document->Main());
    TDF_LabelSequence tops;
    shapes_->GetFreeShapes(tops);
    if (tops.IsEmpty()) return refused("it has no product");
    Bnd_Box box;
    double nodes = 1;
    for (int i = 1; i <= tops.Length(); ++i) {
      const Extent& extent = extent_of(tops.Value(i), 0);
      box.Add(extent.box);
      nodes += extent.nodes;
    }
    if (nodes > static_cast<double>(options_.limits.nodes)) throw OverLimit{"nodes"};
    deflection_ = options_.deflection > 0 ? options_.deflection : usual_deflection(box);
    for (int i = 1; i <= tops.Length(); ++i) add(tops.Value(i), 0, std::nullopt);
    if (!skipped_.empty()) {
      std::string list;
      for (const auto& [what, count] : skipped_)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", counted(count, what));
      log_.report_file(Code("N6007"), name_, fmt::format("skipped: {}", list));
    }
    return std::move(out_);
  }

  static double usual_deflection(const Bnd_Box& box) {
    constexpr double kPart = 1e-4;  // of the largest extent
    if (box.IsVoid()) return kPart;
    double low[3];
    double high[3];
    box.Get(low[0], low[1], low[2], high[0], high[1], high[2]);
    double extent = 0;
    for (int i = 0; i < 3; ++i) extent = std::max(extent, high[i] - low[i]);
    return extent > 0 ? kPart * extent / kMetre : kPart;
  }

  // ---- labels

  struct Extent {
    Bnd_Box box;       // in the label's own frame
    double nodes = 1;  // of the scene
  };

  const Extent& extent_of(const TDF_Label& label, std::uint32_t depth) {
    if (depth > options_.limits.depth) throw OverLimit{"depth"};
    gp_Trsf unused;
    const TDF_Label product = product_of(label, unused);
    const auto [it, added] = extents_.try_emplace(key_of(product));
    if (!added) return it->second;
    Extent extent;
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(product, components);
      for (int i = 1; i <= components.Length(); ++i) {
        gp_Trsf transform;
        product_of(components.Value(i), transform);
        const Extent& part = extent_of(components.Value(i), depth + 1);
        if (!part.box.IsVoid()) extent.box.Add(part.box.Transformed(transform));
        extent.nodes += part.nodes;
      }
    } else {
      Part& part = parts_[key_of(product)];
      find_bodies(product, part);
      extent.nodes += static_cast<double>(part.bodies.size());
      for (const Body& body : part.bodies) {
        Bnd_Box box;
        BRepBndLib::Add(body.shape, box, Standard_False);
        if (!box.IsVoid()) extent.box.Add(box);
      }
    }
    it->second = extent;
    return it->second;
  }

  std::int32_t index_of(const Colour& color) {
    const auto it = std::find(palette_.begin(), palette_.end(), color);
    if (it != palette_.end()) return static_cast<std::int32_t>(it - palette_.begin());
    palette_.push_back(color);
    return static_cast<std::int32_t>(palette_.size() - 1);
  }

  using Marks = NCollection_DataMap<TopoDS_Shape, TDF_Label, TopTools_ShapeMapHasher>;

  void find_bodies(const TDF_Label& product, Part& part) {
    part.color = color_at(*colors_, product);
    part.material = material_at(product);
    Marks marks;  // sub-shapes with a name or colour of their own
    TDF_LabelSequence labels;
    XCAFDoc_ShapeTool::GetSubShapes(product, labels);
    for (int i = 1; i <= labels.Length(); ++i) {
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(labels.Value(i));
      if (!shape.IsNull()) marks.Bind(shape, labels.Value(i));
    }
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product);
    if (!shape.IsNull()) find_bodies_in(shape, marks, kInherited, 0, part);
  }

  std::int32_t marked(const TopoDS_Shape& shape, const Marks& marks, std::int32_t otherwise) {
    if (const TDF_Label* label = marks.Seek(shape))
      if (const auto color = color_at(*colors_, *label)) return index_of(*color);
    return otherwise;
  }

  void find_bodies_in(const TopoDS_Shape& shape, const Marks& marks, std::int32_t color,
                      std::uint32_t depth, Part& part) {
    if (depth > options_.limits.depth) throw OverLimit{"depth"};
    color = marked(shape, marks, color);
    switch (shape.ShapeType()) {
      case TopAbs_SOLID:
      case TopAbs_SHELL:
      case TopAbs_FACE:
        add_body(shape, marks, color, part);
        break;
      case TopAbs_COMPOUND:
      case TopAbs_COMPSOLID: {
        TopoDS_Compound faces;  // loose ones make one body
        for (TopoDS_Iterator at(shape); at.More(); at.Next()) {
          if (at.Value().ShapeType() != TopAbs_FACE) {
            find_bodies_in(at.Value(), marks, color, depth + 1, part);
            continue;
          }
          if (faces.IsNull()) BRep_Builder().MakeCompound(faces);
          BRep_Builder().Add(faces, at.Value());
        }
        if (!faces.IsNull()) add_body(faces, marks, color, part);
        break;
      }
      case TopAbs_WIRE:
        ++skipped_["wire"];
        break;
      case TopAbs_EDGE:
        ++skipped_["edge"];
        break;
      default:
        ++skipped_["point"];
        break;
    }
  }

  void add_body(const TopoDS_Shape& shape, const Marks& marks, std::int32_t color, Part& part) {
    if (++bodies_ > options_.limits.nodes) throw OverLimit{"nodes"};
    Body body;
    body.shape = shape;
    body.name = item_name(shape);
    for (TopExp_Explorer shells(shape, TopAbs_SHELL); shells.More(); shells.Next()) {
      const std::int32_t of_shell = marked(shells.Current(), marks, color);
      for (TopExp_Explorer at(shells.Current(), TopAbs_FACE); at.More(); at.Next())
        body.colors.push_back(marked(at.Current(), marks, of_shell));
    }
    if (body.colors.empty())
      for (TopExp_Explorer at(shape, TopAbs_FACE); at.More(); at.Next())
        body.colors.push_back(marked(at.Current(), marks, color));
    if (body.colors.empty()) return;
    // made at the origin, so that bodies that differ by their place alone are one shape
    body.part_from_body = matrix_of(shape.Location().Transformation());
    body.shape.Location(TopLoc_Location());
    part.bodies.push_back(std::move(body));
  }

  // ---- scene

  std::int32_t add_node(std::int32_t parent, const Mat4& parent_from_node, std::string name,
                        std::string_view kind, std::uint64_t number) {
    std::optional<scene::Decomposed> parts = scene::Decomposed{};
    if (parent_from_node != Mat4(1)) parts = scene::decomposed(parent_from_node);
    if (!parts) {
      log_.report(Code("W6009"), place_of(text_, number),
                  fmt::format("the transform of {} flattens it", in_quotes(name)));
      return scene::kNone;
    }
    auto& nodes = out_.scene.nodes;
    if (nodes.size() + 1 >= options_.limits.nodes) throw OverLimit{"nodes"};
    scene::Node node;
    node.name = std::move(name);
    std::replace(node.name.begin(), node.name.end(), '/', '_');
    if (node.name.empty()) node.name = fmt::format("{}{}", kind, ++kinds_[std::string(kind)]);
    node.parent = parent;
    node.source = source_of(number);
    return add_placed(nodes, std::move(node), *parts);
  }

  // above: the colour of the assembly
  void add(const TDF_Label& label, std::int32_t parent, std::optional<Colour> above) {
    gp_Trsf transform;
    const TDF_Label product = product_of(label, transform);
    std::string name = label == product ? std::string() : name_of(label);
    if (made_up(name)) name = name_of(product);
    const std::uint64_t number = number_of(XCAFDoc_ShapeTool::GetShape(product));
    const bool assembly = XCAFDoc_ShapeTool::IsAssembly(product);
    const std::int32_t node =
        add_node(parent, matrix_of(transform), name, assembly ? "assembly" : "part", number);
    if (node == scene::kNone) return;
    // the occurrence's colour, else the product's, else that of what it is a part of
    std::optional<Colour> color = label == product ? std::nullopt : color_at(*colors_, label);
    if (!color) color = color_at(*colors_, product);
    if (!color) color = above;
    if (assembly) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(product, components);
      for (int i = 1; i <= components.Length(); ++i) add(components.Value(i), node, color);
      return;
    }
    Part& part = parts_.at(key_of(product));
    while (part.made.size() < part.bodies.size()) {
      const Body& body = part.bodies[part.made.size()];
      part.made.push_back(made_of(body, out_.scene.nodes[static_cast<std::size_t>(node)].name));
    }
    for (std::size_t i = 0; i < part.bodies.size(); ++i)
      place(part.bodies[i], part.made[i], part, node, color);
  }

  // A body stands at its part's node where it is alone and needs no transform.
  void place(const Body& body, const Made& made, const Part& part, std::int32_t node,
             const std::optional<Colour>& color) {
    if (made.looks.empty()) return;
    const Mat4 part_from_shape = body.part_from_body * made.body_from_shape;
    if (part.bodies.size() > 1 || part_from_shape != Mat4(1))
      node = add_node(node, part_from_shape, body.name, "body", number_of(body.shape));
    if (node == scene::kNone) return;
    for (const Look& look : made.looks) {
      auto& instances = out_.scene.instances;
      if (instances.size() >= options_.limits.nodes) throw OverLimit{"nodes"};
      scene::Instance instance;
      instance.node = node;
      instance.shape = look.shape;
      instance.material =
          look.color == kInherited
              ? material_of(color, part.material)
              : material_of(palette_[static_cast<std::size_t>(look.color)], part.material);
      instance.source = source_of(number_of(body.shape));
      instances.push_back(std::move(instance));
    }
  }

  // Bodies of one shape and the same colours are made once.
  Made made_of(const Body& body, const std::string& part) {
    const auto key = std::tuple(static_cast<const void*>(body.shape.TShape().get()),
                                static_cast<int>(body.shape.Orientation()), body.colors);
    const auto known = made_.find(key);
    if (known != made_.end()) return known->second;
    Made made;
    try {
      made = make(body, part);
    } catch (const Standard_OutOfMemory&) {
      throw;
    } catch (const Standard_Failure& failure) {
      report_lost(number_of(body.shape), fmt::format("a body of {} cannot be meshed: {}",
                                                     in_quotes(part), failure.GetMessageString()));
    }
    made_.emplace(key, made);
    return made;
  }

  Made make(const Body& body, const std::string& part) {
    Made made;
    const bool one_color = std::all_of(body.colors.begin(), body.colors.end(),
                                       [&](std::int32_t color) { return color == body.colors[0]; });
    if (one_color) {
      if (auto exact = exact_of(body.shape)) {
        made.body_from_shape = exact->body_from_shape;
        made.looks.push_back({add_shape(std::move(exact->shape)), body.colors[0]});
        return made;
      }
    }
    const auto left = static_cast<double>(options_.limits.triangles - triangles_);
    // note: what is expected may be twice what comes
    if (expected_triangles(body.shape, deflection_) > 4 * left + 1000) throw OverLimit{"triangles"};
    job_.poll();
    const Meshed mesh = meshed(body.shape, body.colors, deflection_);
    for (const TopoDS_Face& face : mesh.lost)
      report_lost(number_of(face), fmt::format("a face of {} cannot be meshed", in_quotes(part)));
    for (const Patch& patch : mesh.patches) {
      triangles_ += patch.mesh->triangles.size();
      if (triangles_ > options_.limits.triangles) throw OverLimit{"triangles"};
      made.looks.push_back({add_shape(geometry::MeshShape(patch.mesh)), patch.color});
    }
    return made;
  }

  std::int32_t add_shape(geometry::Shape shape) {
    const auto [place, added] = shape_of_.try_emplace(
        geometry::hash_of(shape), static_cast<std::int32_t>(out_.scene.shapes.size()));
    if (added) out_.scene.shapes.push_back(std::move(shape));
    return place->second;
  }

  std::int32_t material_of(const std::optional<Colour>& color, const std::string& name) {
    for (std::size_t i = 0; i < material_keys_.size(); ++i)
      if (material_keys_[i].first == color && material_keys_[i].second == name)
        return static_cast<std::int32_t>(i);
    material_keys_.emplace_back(color, name);
    CadMaterial cad;
    cad.name = name;
    cad.base_color = materials::Material().diffuse;
    if (color) {
      cad.base_color = glm::clamp(color->rgb, Vec3(0), Vec3(1));
      cad.opacity = std::clamp(color->opacity, 0.0, 1.0);
    }
    out_.scene.materials.push_back(lambert_of(cad));
    out_.materials.push_back(std::move(cad));
    return static_cast<std::int32_t>(material_keys_.size() - 1);
  }

  struct ByLow {
    std::size_t operator()(const Hash128& hash) const { return hash.low; }
  };

  const Text& text_;
  const std::string& path_;
  const std::string& name_;
  const Options& options_;
  DiagnosticLog& log_;
  const Job& job_;
  Imported out_;
  Handle(StepData_StepModel) model_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  double deflection_ = 0;  // metres
  std::uint64_t triangles_ = 0;
  std::uint64_t bodies_ = 0;
  std::unordered_map<const void*, Handle(Standard_Transient)> made_from_;  // shapes → entities
  std::map<std::string, Extent> extents_;                                  // by label
  std::map<std::string, Part> parts_;                                      // by label
  std::map<std::tuple<const void*, int, std::vector<std::int32_t>>, Made> made_;
  std::unordered_map<Hash128, std::int32_t, ByLow> shape_of_;
  std::vector<Colour> palette_;
  std::vector<std::pair<std::optional<Colour>, std::string>> material_keys_;
  std::map<std::string, std::uint32_t> kinds_;
  std::map<std::string, std::size_t> skipped_;
};

}  // namespace

Result<Imported> read_document(const Text& text, std::string_view bytes, const std::string& path,
                               const std::string& name, const Options& options, DiagnosticLog& log,
                               const Job& job) {
  const Silence silence;
  try {
    return Reading(text, path, name, options, log, job).run(bytes);
  } catch (const Standard_OutOfMemory&) {
    throw OverLimit{"memory"};
  } catch (const Standard_Failure& failure) {
    log.report_file(Code("E6601"), name,
                    fmt::format("OpenCASCADE failed: {}", failure.GetMessageString()));
    return failed;
  }
}

}  // namespace panwright::importers::step
