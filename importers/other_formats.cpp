#include "importers/other_formats.h"

#include "base/folder_names.h"
#include "base/text.h"

#include <filesystem>
#include <initializer_list>
#include <string>

namespace panwright::importers {

namespace {

constexpr std::string_view kBlender = "convert it to glTF (.glb) with Blender";
constexpr std::string_view kFreeCad =
    "convert it to glTF (.glb) with FreeCAD, or export STEP from the program that wrote it";
constexpr std::string_view kAssimp = "convert it to glTF (.glb) with assimp";
// FreeCAD reads none of these
constexpr std::string_view kCad =
    "export STEP with a CAD program that reads it, as SolidWorks, NX, Solid Edge or Onshape";
constexpr std::string_view kOwner = "export STEP or glTF (.glb) with the program that wrote it";

constexpr OtherFormat kFbx{"FBX", kBlender};
constexpr OtherFormat kBlend{"a Blender file", kBlender};
constexpr OtherFormat kUsd{"USD", kBlender};
constexpr OtherFormat kX3d{"X3D", kBlender};
constexpr OtherFormat kInventor{"Open Inventor",
                                "convert it to VRML 2 with ivvrml of Coin, or to glTF with ivcon"};
constexpr OtherFormat kParasolid{"Parasolid", kCad};
constexpr OtherFormat kCollada{"COLLADA",
                               "convert it to glTF (.glb) with assimp, or Blender before 5.0"};
constexpr OtherFormat k3ds{"3DS", kAssimp};
constexpr OtherFormat k3mf{"3MF", kFreeCad};
constexpr OtherFormat kDxf{"DXF", kFreeCad};
constexpr OtherFormat kDwg{
    "DWG", "convert it to DXF with the ODA File Converter, and that to glTF (.glb) with FreeCAD"};
constexpr OtherFormat kAcis{"ACIS", kCad};
constexpr OtherFormat kRhino{"a Rhino file", "export STEP or glTF (.glb) with Rhino"};
constexpr OtherFormat kBrep{"OpenCASCADE BREP", kFreeCad};

struct ByName {
  std::string_view extension;
  OtherFormat format;
};

constexpr ByName kByName[] = {
    {".fbx", kFbx},
    {".blend", kBlend},
    {".usd", kUsd},
    {".usda", kUsd},
    {".usdc", kUsd},
    {".usdz", kUsd},
    {".x3d", kX3d},
    {".x3dv", kX3d},
    {".x3dz", kX3d},
    {".iv", kInventor},
    {".x_t", kParasolid},
    {".x_b", kParasolid},
    {".xmt_txt", kParasolid},
    {".xmt_bin", kParasolid},
    {".dae", kCollada},
    {".zae", kCollada},
    {".3ds", k3ds},
    {".3mf", k3mf},
    {".amf", {"AMF", kFreeCad}},
    {".off", {"OFF", kAssimp}},
    {".lwo", {"LightWave", kAssimp}},
    {".igs", {"IGES", kFreeCad}},
    {".iges", {"IGES", kFreeCad}},
    {".brep", kBrep},
    {".brp", kBrep},
    {".fcstd", {"a FreeCAD file", "export STEP or glTF (.glb) with FreeCAD"}},
    {".dxf", kDxf},
    {".dwg", kDwg},
    {".sat", kAcis},
    {".sab", kAcis},
    {".jt", {"JT", kCad}},
    {".sldprt", {"a SolidWorks part", "export STEP with SolidWorks, eDrawings or Onshape"}},
    {".sldasm", {"a SolidWorks assembly", "export STEP with SolidWorks, eDrawings or Onshape"}},
    {".catpart", {"a CATIA part", "export STEP with CATIA"}},
    {".catproduct", {"a CATIA assembly", "export STEP with CATIA"}},
    {".ipt", {"an Inventor part", "export STEP with Autodesk Inventor or Fusion"}},
    {".iam", {"an Inventor assembly", "export STEP with Autodesk Inventor or Fusion"}},
    {".f3d", {"a Fusion file", "export STEP with Autodesk Fusion"}},
    {".3dm", kRhino},
    {".skp", {"a SketchUp file", "export glTF (.glb) or STEP with SketchUp"}},
    {".max", {"a 3ds Max file", "export glTF (.glb) with 3ds Max"}},
    {".ma", {"a Maya file", "export FBX with Maya, and convert it to glTF (.glb) with Blender"}},
    {".mb", {"a Maya file", "export FBX with Maya, and convert it to glTF (.glb) with Blender"}},
    {".c4d", {"a Cinema 4D file", "export glTF (.glb) with Cinema 4D"}},
};

std::optional<OtherFormat> xml_format(std::string_view head) {
  if (head.find("<COLLADA") != head.npos) return kCollada;
  if (head.find("<X3D") != head.npos) return kX3d;
  return OtherFormat{"an XML file", kOwner};
}

}  // namespace

std::optional<OtherFormat> other_format_by_bytes(std::string_view bytes, std::string_view path) {
  constexpr std::size_t kHead = 4096;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text =
      first == bytes.npos ? std::string_view() : bytes.substr(first, kHead);
  if (starts_with_any(text, {"Kaydara FBX Binary", "; FBX"})) return kFbx;
  if (text.starts_with("BLENDER")) return kBlend;
  if (starts_with_any(text, {"PXR-USDC", "#usda"})) return kUsd;
  if (text.starts_with("#X3D")) return kX3d;
  if (text.starts_with("#Inventor")) return kInventor;
  if (text.starts_with("**ABCDEFGHIJKLMNOPQRSTUVWXYZ")) return kParasolid;
  if (starts_with_any(text, {"<?xml", "<COLLADA", "<X3D", "<!DOCTYPE X3D"}))
    return xml_format(text);
  if (text.starts_with("PK\x03\x04")) {
    const auto named = other_format_by_name(path);
    return named ? named : OtherFormat{"a ZIP archive", "unpack it, and import the model in it"};
  }
  if (starts_with_any(text, {"AC1.", "AC10"})) return kDwg;
  if (text.starts_with("AutoCAD Binary DXF")) return kDxf;
  if (text.starts_with("3D Geometry File Format")) return kRhino;
  if (text.starts_with("DBRep_DrawableShape") || text.starts_with("CASCADE Topology")) return kBrep;
  return std::nullopt;
}

std::optional<OtherFormat> other_format_by_name(std::string_view path) {
  std::string name = lower_case(std::filesystem::path(path).filename().string());
  for (const std::string_view packed : {".gz", ".gzip"})
    if (name.ends_with(packed)) name.resize(name.size() - packed.size());
  for (const ByName& each : kByName)
    if (name.ends_with(each.extension)) return each.format;
  return std::nullopt;
}

}  // namespace panwright::importers
