#include "importers/step/internal/labels.h"

#include <Quantity_ColorRGBA.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>

namespace panwright::importers::step {

TDF_Label product_of(const TDF_Label& label, gp_Trsf& transform) {
  TDF_Label product = label;
  if (XCAFDoc_ShapeTool::IsReference(label)) {
    transform = XCAFDoc_ShapeTool::GetLocation(label).Transformation();
    XCAFDoc_ShapeTool::GetReferredShape(label, product);
  }
  return product;
}

std::string key_of(const TDF_Label& label) {
  TCollection_AsciiString entry;
  TDF_Tool::Entry(label, entry);
  return entry.ToCString();
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_AsciiString utf8(name->Get());
  return {utf8.ToCString(), static_cast<std::size_t>(utf8.Length())};
}

bool made_up(std::string_view name) {
  if (name.starts_with("NAUO")) name.remove_prefix(4);
  if (name.starts_with("=>[")) return true;
  return std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::optional<Colour> color_at(XCAFDoc_ColorTool& colors, const TDF_Label& label) {
  Quantity_ColorRGBA color;
  for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
    if (colors.GetColor(label, type, color))
      return Colour{{color.GetRGB().Red(), color.GetRGB().Green(), color.GetRGB().Blue()},
                    color.Alpha()};
  return std::nullopt;
}

std::string material_at(const TDF_Label& label) {
  Handle(TDataStd_TreeNode) node;
  if (!label.FindAttribute(XCAFDoc::MaterialRefGUID(), node) || !node->HasFather()) return {};
  Handle(TCollection_HAsciiString) name, description, density_name, density_type;
  double density = 0;
  if (!XCAFDoc_DocumentTool::MaterialTool(label)->GetMaterial(
          node->Father()->Label(), name, description, density, density_name, density_type) ||
      name.IsNull())
    return {};
  return name->ToCString();
}

}  // namespace panwright::importers::step
