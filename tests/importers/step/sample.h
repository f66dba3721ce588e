// STEP files for the tests, written by OpenCASCADE.
#pragma once

#include <Quantity_Color.hxx>
#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>
#include <string>

#include "base/math.h"

namespace panwright::importers::step {

// A document that becomes a file. Lengths are millimetres in the document, whatever unit is
// written.
class Sample {
 public:
  Sample();

  // A part with a name; alone at the top of the document.
  TDF_Label part(const TopoDS_Shape& shape, const std::string& name);
  // An empty assembly.
  TDF_Label assembly(const std::string& name);
  // An occurrence of a product in an assembly.
  TDF_Label place(const TDF_Label& assembly, const TDF_Label& product, const gp_Trsf& transform,
                  const std::string& name);
  // sRGB, as CAD programs show it; of a product or an occurrence
  void color(const TDF_Label& label, const Vec3& srgb);
  // of a face or solid of a part
  void color(const TDF_Label& part, const TopoDS_Shape& sub_shape, const Vec3& srgb);
  void material(const TDF_Label& part, const std::string& name);

  // unit: "MM", "INCH", "M"
  std::string text(const std::string& unit = "MM");

 private:
  Handle(TDocStd_Document) document_;
};

// A part alone, as a file.
std::string text_of(const TopoDS_Shape& shape, const std::string& name = "part",
                    const std::string& unit = "MM");

}  // namespace panwright::importers::step
