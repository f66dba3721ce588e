#include "tests/importers/step/sample.h"

#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <filesystem>

#include "base/file.h"
#include "tests/support/process.h"

namespace panwright::importers::step {

namespace {

Quantity_Color quantity(const Vec3& srgb) { return {srgb.x, srgb.y, srgb.z, Quantity_TOC_sRGB}; }

}  // namespace

Sample::Sample() : document_(new TDocStd_Document("XmlXCAF")) {
  XCAFDoc_DocumentTool::Set(document_->Main(), Standard_False);
  XCAFDoc_DocumentTool::ShapeTool(document_->Main())->SetAutoNaming(Standard_False);
}

TDF_Label Sample::part(const TopoDS_Shape& shape, const std::string& name) {
  const TDF_Label label =
      XCAFDoc_DocumentTool::ShapeTool(document_->Main())->AddShape(shape, Standard_False);
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

TDF_Label Sample::assembly(const std::string& name) {
  const TDF_Label label = XCAFDoc_DocumentTool::ShapeTool(document_->Main())->NewShape();
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

TDF_Label Sample::place(const TDF_Label& assembly, const TDF_Label& product,
                        const gp_Trsf& transform, const std::string& name) {
  const TDF_Label label = XCAFDoc_DocumentTool::ShapeTool(document_->Main())
                              ->AddComponent(assembly, product, TopLoc_Location(transform));
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

void Sample::color(const TDF_Label& label, const Vec3& srgb) {
  XCAFDoc_DocumentTool::ColorTool(document_->Main())
      ->SetColor(label, quantity(srgb), XCAFDoc_ColorSurf);
}

void Sample::color(const TDF_Label& part, const TopoDS_Shape& sub_shape, const Vec3& srgb) {
  const TDF_Label label =
      XCAFDoc_DocumentTool::ShapeTool(document_->Main())->AddSubShape(part, sub_shape);
  color(label, srgb);
}

void Sample::material(const TDF_Label& part, const std::string& name) {
  const auto text = [](const char* t) { return new TCollection_HAsciiString(t); };
  XCAFDoc_DocumentTool::MaterialTool(document_->Main())
      ->SetMaterial(part, text(name.c_str()), text(""), 2.7, text("density"), text("g/cm3"));
}

std::string Sample::text(const std::string& unit) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetCVal("write.step.unit", unit.c_str());
  XCAFDoc_DocumentTool::ShapeTool(document_->Main())->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.Transfer(document_);
  const support::TemporaryFolder folder;
  const std::string path = folder / "sample.step";
  writer.Write(path.c_str());
  DiagnosticLog log;
  return *read_file(path, std::uint64_t{1} << 30, log);
}

std::string text_of(const TopoDS_Shape& shape, const std::string& name, const std::string& unit) {
  Sample sample;
  sample.part(shape, name);
  return sample.text(unit);
}

}  // namespace panwright::importers::step
