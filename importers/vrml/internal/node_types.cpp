// The node types of both standards, as text: name, then its fields: access (i eventIn, o eventOut,
// f field, x exposedField), type, name, default.
// ISO/IEC 14772-1:1997, clause 6; "The Virtual Reality Modeling Language, Version 1.0", 1995.
#include <algorithm>
#include <array>
#include <cassert>
#include <deque>
#include <optional>

#include "base/text.h"
#include "importers/vrml/internal/document.h"
#include "importers/vrml/internal/node_types.h"

namespace panwright::importers::vrml {

namespace {

constexpr std::string_view k97 = R"(
Anchor i MFNode addChildren ; i MFNode removeChildren ; x MFNode children ; x SFString description "" ; x MFString parameter ; x MFString url ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1
Appearance x SFNode material ; x SFNode texture ; x SFNode textureTransform
AudioClip x SFString description "" ; x SFBool loop FALSE ; x SFFloat pitch 1 ; x SFTime startTime 0 ; x SFTime stopTime 0 ; x MFString url ; o SFTime duration_changed ; o SFBool isActive
Background i SFBool set_bind ; x MFFloat groundAngle ; x MFColor groundColor ; x MFString backUrl ; x MFString bottomUrl ; x MFString frontUrl ; x MFString leftUrl ; x MFString rightUrl ; x MFString topUrl ; x MFFloat skyAngle ; x MFColor skyColor 0 0 0 ; o SFBool isBound
Billboard i MFNode addChildren ; i MFNode removeChildren ; x SFVec3f axisOfRotation 0 1 0 ; x MFNode children ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1
Box f SFVec3f size 2 2 2
Collision i MFNode addChildren ; i MFNode removeChildren ; x MFNode children ; x SFBool collide TRUE ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1 ; f SFNode proxy ; o SFTime collideTime
Color x MFColor color
ColorInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFColor keyValue ; o SFColor value_changed
Cone f SFFloat bottomRadius 1 ; f SFFloat height 2 ; f SFBool side TRUE ; f SFBool bottom TRUE
Coordinate x MFVec3f point
CoordinateInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFVec3f keyValue ; o MFVec3f value_changed
Cylinder f SFBool bottom TRUE ; f SFFloat height 2 ; f SFFloat radius 1 ; f SFBool side TRUE ; f SFBool top TRUE
CylinderSensor x SFBool autoOffset TRUE ; x SFFloat diskAngle 0.262 ; x SFBool enabled TRUE ; x SFFloat maxAngle -1 ; x SFFloat minAngle 0 ; x SFFloat offset 0 ; o SFBool isActive ; o SFRotation rotation_changed ; o SFVec3f trackPoint_changed
DirectionalLight x SFFloat ambientIntensity 0 ; x SFColor color 1 1 1 ; x SFVec3f direction 0 0 -1 ; x SFFloat intensity 1 ; x SFBool on TRUE
ElevationGrid i MFFloat set_height ; x SFNode color ; x SFNode normal ; x SFNode texCoord ; f MFFloat height ; f SFBool ccw TRUE ; f SFBool colorPerVertex TRUE ; f SFFloat creaseAngle 0 ; f SFBool normalPerVertex TRUE ; f SFBool solid TRUE ; f SFInt32 xDimension 0 ; f SFFloat xSpacing 1 ; f SFInt32 zDimension 0 ; f SFFloat zSpacing 1
Extrusion i MFVec2f set_crossSection ; i MFRotation set_orientation ; i MFVec2f set_scale ; i MFVec3f set_spine ; f SFBool beginCap TRUE ; f SFBool ccw TRUE ; f SFBool convex TRUE ; f SFFloat creaseAngle 0 ; f MFVec2f crossSection 1 1 1 -1 -1 -1 -1 1 1 1 ; f SFBool endCap TRUE ; f MFRotation orientation 0 0 1 0 ; f MFVec2f scale 1 1 ; f SFBool solid TRUE ; f MFVec3f spine 0 0 0 0 1 0
Fog x SFColor color 1 1 1 ; x SFString fogType "LINEAR" ; x SFFloat visibilityRange 0 ; i SFBool set_bind ; o SFBool isBound
FontStyle f MFString family "SERIF" ; f SFBool horizontal TRUE ; f MFString justify "BEGIN" ; f SFString language "" ; f SFBool leftToRight TRUE ; f SFFloat size 1 ; f SFFloat spacing 1 ; f SFString style "PLAIN" ; f SFBool topToBottom TRUE
Group i MFNode addChildren ; i MFNode removeChildren ; x MFNode children ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1
ImageTexture x MFString url ; f SFBool repeatS TRUE ; f SFBool repeatT TRUE
IndexedFaceSet i MFInt32 set_colorIndex ; i MFInt32 set_coordIndex ; i MFInt32 set_normalIndex ; i MFInt32 set_texCoordIndex ; x SFNode color ; x SFNode coord ; x SFNode normal ; x SFNode texCoord ; f SFBool ccw TRUE ; f MFInt32 colorIndex ; f SFBool colorPerVertex TRUE ; f SFBool convex TRUE ; f MFInt32 coordIndex ; f SFFloat creaseAngle 0 ; f MFInt32 normalIndex ; f SFBool normalPerVertex TRUE ; f SFBool solid TRUE ; f MFInt32 texCoordIndex
IndexedLineSet i MFInt32 set_colorIndex ; i MFInt32 set_coordIndex ; x SFNode color ; x SFNode coord ; f MFInt32 colorIndex ; f SFBool colorPerVertex TRUE ; f MFInt32 coordIndex
Inline x MFString url ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1
LOD x MFNode level ; f SFVec3f center 0 0 0 ; f MFFloat range
Material x SFFloat ambientIntensity 0.2 ; x SFColor diffuseColor 0.8 0.8 0.8 ; x SFColor emissiveColor 0 0 0 ; x SFFloat shininess 0.2 ; x SFColor specularColor 0 0 0 ; x SFFloat transparency 0
MovieTexture x SFBool loop FALSE ; x SFFloat speed 1 ; x SFTime startTime 0 ; x SFTime stopTime 0 ; x MFString url ; f SFBool repeatS TRUE ; f SFBool repeatT TRUE ; o SFTime duration_changed ; o SFBool isActive
NavigationInfo i SFBool set_bind ; x MFFloat avatarSize 0.25 1.6 0.75 ; x SFBool headlight TRUE ; x SFFloat speed 1 ; x MFString type "WALK" "ANY" ; x SFFloat visibilityLimit 0 ; o SFBool isBound
Normal x MFVec3f vector
NormalInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFVec3f keyValue ; o MFVec3f value_changed
OrientationInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFRotation keyValue ; o SFRotation value_changed
PixelTexture x SFImage image 0 0 0 ; f SFBool repeatS TRUE ; f SFBool repeatT TRUE
PlaneSensor x SFBool autoOffset TRUE ; x SFBool enabled TRUE ; x SFVec2f maxPosition -1 -1 ; x SFVec2f minPosition 0 0 ; x SFVec3f offset 0 0 0 ; o SFBool isActive ; o SFVec3f trackPoint_changed ; o SFVec3f translation_changed
PointLight x SFFloat ambientIntensity 0 ; x SFVec3f attenuation 1 0 0 ; x SFColor color 1 1 1 ; x SFFloat intensity 1 ; x SFVec3f location 0 0 0 ; x SFBool on TRUE ; x SFFloat radius 100
PointSet x SFNode color ; x SFNode coord
PositionInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFVec3f keyValue ; o SFVec3f value_changed
ProximitySensor x SFVec3f center 0 0 0 ; x SFVec3f size 0 0 0 ; x SFBool enabled TRUE ; o SFBool isActive ; o SFVec3f position_changed ; o SFRotation orientation_changed ; o SFTime enterTime ; o SFTime exitTime
ScalarInterpolator i SFFloat set_fraction ; x MFFloat key ; x MFFloat keyValue ; o SFFloat value_changed
Script x MFString url ; f SFBool directOutput FALSE ; f SFBool mustEvaluate FALSE
Shape x SFNode appearance ; x SFNode geometry
Sound x SFVec3f direction 0 0 1 ; x SFFloat intensity 1 ; x SFVec3f location 0 0 0 ; x SFFloat maxBack 10 ; x SFFloat maxFront 10 ; x SFFloat minBack 1 ; x SFFloat minFront 1 ; x SFFloat priority 0 ; x SFNode source ; f SFBool spatialize TRUE
Sphere f SFFloat radius 1
SphereSensor x SFBool autoOffset TRUE ; x SFBool enabled TRUE ; x SFRotation offset 0 1 0 0 ; o SFBool isActive ; o SFRotation rotation_changed ; o SFVec3f trackPoint_changed
SpotLight x SFFloat ambientIntensity 0 ; x SFVec3f attenuation 1 0 0 ; x SFFloat beamWidth 1.570796 ; x SFColor color 1 1 1 ; x SFFloat cutOffAngle 0.785398 ; x SFVec3f direction 0 0 -1 ; x SFFloat intensity 1 ; x SFVec3f location 0 0 0 ; x SFBool on TRUE ; x SFFloat radius 100
Switch x MFNode choice ; x SFInt32 whichChoice -1
Text x MFString string ; x SFNode fontStyle ; x MFFloat length ; x SFFloat maxExtent 0
TextureCoordinate x MFVec2f point
TextureTransform x SFVec2f center 0 0 ; x SFFloat rotation 0 ; x SFVec2f scale 1 1 ; x SFVec2f translation 0 0
TimeSensor x SFTime cycleInterval 1 ; x SFBool enabled TRUE ; x SFBool loop FALSE ; x SFTime startTime 0 ; x SFTime stopTime 0 ; o SFTime cycleTime ; o SFFloat fraction_changed ; o SFBool isActive ; o SFTime time
TouchSensor x SFBool enabled TRUE ; o SFVec3f hitNormal_changed ; o SFVec3f hitPoint_changed ; o SFVec2f hitTexCoord_changed ; o SFBool isActive ; o SFBool isOver ; o SFTime touchTime
Transform i MFNode addChildren ; i MFNode removeChildren ; x SFVec3f center 0 0 0 ; x MFNode children ; x SFRotation rotation 0 0 1 0 ; x SFVec3f scale 1 1 1 ; x SFRotation scaleOrientation 0 0 1 0 ; x SFVec3f translation 0 0 0 ; f SFVec3f bboxCenter 0 0 0 ; f SFVec3f bboxSize -1 -1 -1
Viewpoint i SFBool set_bind ; x SFFloat fieldOfView 0.785398 ; x SFBool jump TRUE ; x SFRotation orientation 0 0 1 0 ; x SFVec3f position 0 0 10 ; f SFString description "" ; o SFTime bindTime ; o SFBool isBound
VisibilitySensor x SFVec3f center 0 0 0 ; x SFBool enabled TRUE ; x SFVec3f size 0 0 0 ; o SFTime enterTime ; o SFTime exitTime ; o SFBool isActive
WorldInfo f MFString info ; f SFString title ""
)";

// a "+" before the name: a group, with children that no field holds
constexpr std::string_view k10 = R"(
AsciiText x MFString string "" ; x SFFloat spacing 1 ; x SFEnum justification LEFT ; x MFFloat width 0
Cone x SFBitMask parts ALL ; x SFFloat bottomRadius 1 ; x SFFloat height 2
Coordinate3 x MFVec3f point 0 0 0
Cube x SFFloat width 2 ; x SFFloat height 2 ; x SFFloat depth 2
Cylinder x SFBitMask parts ALL ; x SFFloat radius 1 ; x SFFloat height 2
DirectionalLight x SFBool on TRUE ; x SFFloat intensity 1 ; x SFColor color 1 1 1 ; x SFVec3f direction 0 0 -1
FontStyle x SFFloat size 10 ; x SFEnum family SERIF ; x SFBitMask style NONE
+Group
IndexedFaceSet x MFInt32 coordIndex 0 ; x MFInt32 materialIndex -1 ; x MFInt32 normalIndex -1 ; x MFInt32 textureCoordIndex -1
IndexedLineSet x MFInt32 coordIndex 0 ; x MFInt32 materialIndex -1 ; x MFInt32 normalIndex -1 ; x MFInt32 textureCoordIndex -1
Info x SFString string ""
+LOD x MFFloat range ; x SFVec3f center 0 0 0
Material x MFColor ambientColor 0.2 0.2 0.2 ; x MFColor diffuseColor 0.8 0.8 0.8 ; x MFColor specularColor 0 0 0 ; x MFColor emissiveColor 0 0 0 ; x MFFloat shininess 0.2 ; x MFFloat transparency 0
MaterialBinding x SFEnum value DEFAULT
MatrixTransform x SFMatrix matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
Normal x MFVec3f vector
NormalBinding x SFEnum value DEFAULT
OrthographicCamera x SFVec3f position 0 0 1 ; x SFRotation orientation 0 0 1 0 ; x SFFloat focalDistance 5 ; x SFFloat height 2
PerspectiveCamera x SFVec3f position 0 0 1 ; x SFRotation orientation 0 0 1 0 ; x SFFloat focalDistance 5 ; x SFFloat heightAngle 0.785398
PointLight x SFBool on TRUE ; x SFFloat intensity 1 ; x SFColor color 1 1 1 ; x SFVec3f location 0 0 1
PointSet x SFInt32 startIndex 0 ; x SFInt32 numPoints -1
Rotation x SFRotation rotation 0 0 1 0
Scale x SFVec3f scaleFactor 1 1 1
+Separator x SFEnum renderCulling AUTO
ShapeHints x SFEnum vertexOrdering UNKNOWN_ORDERING ; x SFEnum shapeType UNKNOWN_SHAPE_TYPE ; x SFEnum faceType CONVEX ; x SFFloat creaseAngle 0.5
Sphere x SFFloat radius 1
SpotLight x SFBool on TRUE ; x SFFloat intensity 1 ; x SFColor color 1 1 1 ; x SFVec3f location 0 0 1 ; x SFVec3f direction 0 0 -1 ; x SFFloat dropOffRate 0 ; x SFFloat cutOffAngle 0.785398
+Switch x SFInt32 whichChild -1
Texture2 x SFString filename "" ; x SFImage image 0 0 0 ; x SFEnum wrapS REPEAT ; x SFEnum wrapT REPEAT
Texture2Transform x SFVec2f translation 0 0 ; x SFFloat rotation 0 ; x SFVec2f scaleFactor 1 1 ; x SFVec2f center 0 0
TextureCoordinate2 x MFVec2f point 0 0
Transform x SFVec3f translation 0 0 0 ; x SFRotation rotation 0 0 1 0 ; x SFVec3f scaleFactor 1 1 1 ; x SFRotation scaleOrientation 0 0 1 0 ; x SFVec3f center 0 0 0
+TransformSeparator
Translation x SFVec3f translation 0 0 0
+WWWAnchor x SFString name "" ; x SFString description "" ; x SFEnum map NONE
+WWWInline x SFString name "" ; x SFVec3f bboxSize 0 0 0 ; x SFVec3f bboxCenter 0 0 0
)";

class Table {
 public:
  explicit Table(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(end + 1);
      if (!line.empty()) add(line);
    }
    assert(std::is_sorted(specs_.begin(), specs_.end(),
                          [](const NodeSpec& a, const NodeSpec& b) { return a.name < b.name; }));
    for (std::size_t i = specs_.size(); i-- > 0;)
      first_[static_cast<unsigned char>(specs_[i].name[0])] = static_cast<std::uint8_t>(i);
  }

  std::span<const NodeSpec> all() const { return specs_; }
  const NodeSpec* find(std::string_view name) const {
    if (name.empty()) return nullptr;
    for (std::size_t i = first_[static_cast<unsigned char>(name[0])];
         i < specs_.size() && specs_[i].name[0] == name[0]; ++i)
      if (specs_[i].name == name) return &specs_[i];
    return nullptr;
  }

 private:
  static std::string_view word(std::string_view& rest) {
    const std::size_t begin = std::min(rest.find_first_not_of(' '), rest.size());
    const std::size_t end = std::min(rest.find(' ', begin), rest.size());
    const std::string_view out = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    return out;
  }

  void add(std::string_view line) {
    NodeSpec spec;
    spec.name = word(line);
    if (spec.name.front() == '+') {
      spec.group = true;
      spec.name.remove_prefix(1);
    }
    auto& fields = fields_.emplace_back();
    for (std::string_view access = word(line); !access.empty(); access = word(line)) {
      FieldSpec field;
      using Access = FieldSpec::Access;
      field.access = access == "i"   ? Access::event_in
                     : access == "o" ? Access::event_out
                     : access == "f" ? Access::field
                                     : Access::exposed_field;
      field.type = *field_type(word(line));
      field.name = word(line);
      field.initial.type = field.type;
      for (std::string_view item = word(line); !item.empty() && item != ";"; item = word(line))
        items_.push_back(item);
      set_initial(field.initial);
      items_.clear();
      fields.push_back(field);
    }
    spec.fields = fields;
    specs_.push_back(spec);
  }

  // items of the text → memory that stays
  void set_initial(Value& value) {
    switch (value.type) {
      case FieldType::sf_bool:
      case FieldType::sf_int32:
      case FieldType::sf_image:
      case FieldType::mf_bool:
      case FieldType::mf_int32: {
        auto& list = integers_.emplace_back();
        for (const auto item : items_)
          list.push_back(
              item == "TRUE" ? 1 : static_cast<std::int32_t>(parse_double(item).value_or(0)));
        value.data = list.data();
        value.size = list.size();
        break;
      }
      case FieldType::sf_string:
      case FieldType::sf_enum:
      case FieldType::sf_bitmask:
      case FieldType::mf_string: {
        auto& list = words_.emplace_back();
        for (const auto item : items_)
          list.push_back(item.front() == '"' ? item.substr(1, item.size() - 2) : item);
        value.data = list.data();
        value.size = list.size();
        break;
      }
      case FieldType::sf_node:
      case FieldType::mf_node:
        break;
      default: {
        auto& list = numbers_.emplace_back();
        for (const auto item : items_) list.push_back(*parse_double(item));
        value.data = list.data();
        value.size = list.size();
      }
    }
  }

  std::vector<NodeSpec> specs_;
  std::array<std::uint8_t, 256> first_{};  // of the names that begin with a letter
  std::deque<std::vector<FieldSpec>> fields_;
  std::deque<std::vector<std::int32_t>> integers_;
  std::deque<std::vector<double>> numbers_;
  std::deque<std::vector<std::string_view>> words_;
  std::vector<std::string_view> items_;
};

const Table& table97() {
  static const Table table(k97);
  return table;
}

const Table& table10() {
  static const Table table(k10);
  return table;
}

}  // namespace

const NodeSpec* spec97(std::string_view name) { return table97().find(name); }
const NodeSpec* spec10(std::string_view name) { return table10().find(name); }
std::span<const NodeSpec> specs97() { return table97().all(); }
std::span<const NodeSpec> specs10() { return table10().all(); }

std::optional<FieldType> field_type(std::string_view name) {
  for (int i = 1; i <= static_cast<int>(FieldType::mf_node); ++i)
    if (name == type_name(static_cast<FieldType>(i))) return static_cast<FieldType>(i);
  // names of VRML 1.0 and of later standards
  constexpr std::pair<std::string_view, FieldType> kOthers[] = {
      {"SFLong", FieldType::sf_int32},   {"MFLong", FieldType::mf_int32},
      {"SFShort", FieldType::sf_int32},  {"SFUShort", FieldType::sf_int32},
      {"SFULong", FieldType::sf_int32},  {"MFShort", FieldType::mf_int32},
      {"MFULong", FieldType::mf_int32},  {"SFDouble", FieldType::sf_float},
      {"MFDouble", FieldType::mf_float}, {"SFVec3d", FieldType::sf_vec3f},
      {"MFVec3d", FieldType::mf_vec3f},  {"SFVec2d", FieldType::sf_vec2f},
      {"MFVec2d", FieldType::mf_vec2f}};
  for (const auto& [other, type] : kOthers)
    if (name == other) return type;
  return std::nullopt;
}

bool is_transform10(std::string_view name) {
  return name == "Translation" || name == "Rotation" || name == "Scale" ||
         name == "MatrixTransform";
}

}  // namespace panwright::importers::vrml
