#include "tools/model_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "compiler/size.h"
#include "compiler/tolerance.h"
#include "pan/fields.h"
#include "tools/model_words.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using pan::layout::SectionKind;
using pan::layout::ToleranceReason;

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

// The parameters of a BRDF, a coat or cells, as the schema names them.
template <class Part>
Json parameters_json(const Part& part) {
  Json out = Json::object();
  visit_parameters(part, [&](const materials::Parameter& parameter,
                             std::span<const double> values) {
    // note: as single precision has them, so that 0.3 is not 0.30000001192092896
    std::vector<double> numbers;
    for (const double value : values)
      numbers.push_back(parse_double(fmt::format("{}", static_cast<float>(value))).value_or(value));
    out[std::string(parameter.name)] = numbers.size() == 1 ? Json(numbers[0]) : Json(numbers);
  });
  return out;
}

Json mesh_budget_json(const pan::Model& model, std::size_t mesh) {
  if (model.mesh_tolerances().empty()) return nullptr;
  const auto& budget = model.mesh_tolerances()[mesh];
  const bool asked = budget.tolerance > 0;
  return {{"tolerance", asked ? Json(budget.tolerance) : Json(nullptr)},
          {"ratio", asked ? Json(model.meshes()[mesh].error / budget.tolerance) : Json(nullptr)},
          {"reason", pan::reason_name(ToleranceReason{budget.reason})}};
}

Json maps_json(const pan::layout::Material& material) {
  const auto map = [](std::int32_t texture) { return texture < 0 ? Json(nullptr) : Json(texture); };
  return {{"albedo", map(material.albedo_map)},
          {"normal", map(material.normal_map)},
          {"roughness", map(material.roughness_map)},
          {"reflectance", map(material.reflectance_map)},
          {"cutout", map(material.cutout_map)}};
}

}  // namespace

Json table_json(const pan::Model& model, SectionKind kind) {
  const auto fields = pan::fields_of(kind, pan::table_info(kind).json);
  Json out = Json::array();
  const std::size_t count = model.section(kind).size() / pan::section_info(kind).stride;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = pan::record_at(model, kind, i);
    Json item;
    for (const pan::layout::FieldRule* field : fields) {
      Json& member = item[field->name];
      if (pan::is_string(*field))
        member = model.string(static_cast<std::uint32_t>(pan::reference_of(*field, record)));
      else if (field->names != nullptr)
        member = pan::value_words(*field, record);
      else if (field->type == pan::layout::FieldType::i32 && pan::reference_of(*field, record) < 0)
        member = nullptr;
      else
        pan::with_values(*field, record, [&](const auto& values) {
          member = field->count == 1 ? Json(values.front()) : Json(values);
        });
    }
    out.push_back(std::move(item));
  }
  return out;
}

void add_other_tables(const pan::Model& model, Json& out) {
  for (const pan::layout::SectionInfo& info : pan::layout::kSections)
    if (pan::table_info(info.kind).json[0] != '\0' && !out.contains(info.name))
      out[info.name] = table_json(model, info.kind);
}

Json instances_json(const pan::Model& model) {
  Json out = Json::array();
  for (std::size_t i = 0; i < model.instances().size(); ++i) {
    const auto& instance = model.instances()[i];
    Json item{{"node", instance.node}, {"mesh", instance.mesh}, {"material", instance.material}};
    item["texture"] = instance.texture < 0 ? Json(nullptr) : Json(instance.texture);
    if (const std::int32_t back = model.back_of(static_cast<std::uint32_t>(i)); back >= 0)
      item["back"] = back;
    if (!model.sources().empty() && model.sources()[i].line > 0) {
      const auto& source = model.sources()[i];
      item["source"] =
          fmt::format("{}:{}:{}", model.string(source.file), source.line, source.column);
    }
    out.push_back(std::move(item));
  }
  return out;
}

Json budget_json(const pan::Model& model) {
  if (!model.budget()) return nullptr;
  const pan::layout::Budget& budget = *model.budget();
  const auto term = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  Json out{{"tolerance", term(budget.tolerance)},
           {"nearest", term(budget.nearest)},
           {"ifov", term(budget.ifov)},
           {"pixels", term(budget.pixels)},
           {"flux", term(budget.flux)},
           {"centroid", term(budget.centroid)},
           {"smallest_tolerance", term(budget.smallest)}};
  const double pixels = compiler::tolerance_of_pixels(budget.pixels, budget.ifov, budget.nearest);
  const double centroid =
      compiler::tolerance_of_centroid(budget.centroid, budget.ifov, budget.nearest);
  out["gives"] = {{"pixels", term(pixels)}, {"centroid", term(centroid)}};
  out["meshes_decided_by"] = Json::object();
  for (const auto& [reason, count] : decisions_of(model))
    out["meshes_decided_by"][std::string(pan::reason_name(reason))] = count;
  return out;
}

Json tables_json(const pan::Model& model, const std::vector<Mat4>& world) {
  Json out;
  out["materials"] = Json::array();
  for (std::size_t i = 0; i < model.materials().size(); ++i) {
    const auto& material = model.materials()[i];
    const materials::Material full = pan::material_from(material, {});
    out["materials"].push_back(
        {{"name", model.material_name(i)},
         {"diffuse_model", diffuse_word(material.diffuse_brdf)},
         {"specular_model", specular_word(material.specular_brdf)},
         {"diffuse_brdf", parameters_json(full.diffuse_brdf)},
         {"specular_brdf", parameters_json(full.specular_brdf)},
         {"coat", full.coat ? parameters_json(*full.coat) : Json(nullptr)},
         {"cells", full.cells ? parameters_json(*full.cells) : Json(nullptr)},
         {"maps", maps_json(material)}});
  }
  out["meshes"] = Json::array();
  for (std::size_t i = 0; i < model.meshes().size(); ++i) {
    const auto& mesh = model.meshes()[i];
    out["meshes"].push_back({{"name", model.mesh_name(i)},
                             {"triangles", mesh.triangle_count},
                             {"vertices", mesh.vertex_count},
                             {"error", mesh.error},
                             {"budget", mesh_budget_json(model, i)},
                             {"closed", (mesh.flags & pan::layout::kMeshClosed) != 0}});
  }
  out["textures"] = table_json(model, SectionKind::textures);
  out["frames"] = Json::array();
  for (std::size_t i = 0; i < model.frames().size(); ++i) {
    const pan::layout::Frame& frame = model.frames()[i];
    const Mat4 m = world[frame.node] * pan::node_from_frame(frame);
    out["frames"].push_back({{"name", model.frame_name(i)},
                             {"node", model.frames()[i].node},
                             {"origin", vector_json(Vec3(m[3]))},
                             {"right", vector_json(glm::normalize(Vec3(m[0])))},
                             {"forward", vector_json(glm::normalize(Vec3(m[2])))}});
  }
  out["inputs"] = Json::array();
  for (const auto& input : model.inputs())
    out["inputs"].push_back({{"path", model.string(input.path)},
                             {"bytes", input.bytes},
                             {"xxh3", Hash128{input.hash[0], input.hash[1]}.hex()}});
  return out;
}

Json ground_truth_json(const pan::Model& model, const std::vector<Mat4>& world) {
  Json out;
  out["keypoints"] = Json::array();
  for (std::size_t i = 0; i < model.keypoints().size(); ++i) {
    const auto& point = model.keypoints()[i];
    const Vec3 position(point.position[0], point.position[1], point.position[2]);
    out["keypoints"].push_back(
        {{"name", model.keypoint_name(i)},
         {"node", point.node},
         {"position", vector_json(position)},
         {"world", vector_json(Vec3(world[point.node] * Vec4(position, 1.0)))}});
  }
  out["sheets"] = Json::array();
  for (const pan::layout::Sheet& sheet : model.sheets())
    out["sheets"].push_back({{"mesh", sheet.mesh},
                             {"form", form_word(sheet)},
                             {"seed", sheet.seed},
                             {"width", sheet.width},
                             {"height", sheet.height},
                             {"cells", {sheet.columns, sheet.rows}},
                             {"heights", {sheet.lowest, sheet.highest}},
                             {"height_mean", sheet.height_mean},
                             {"height_rms", sheet.height_rms},
                             {"slope_mean", sheet.slope_mean},
                             {"slope_covariance", sheet.slope_covariance},
                             {"facet_slope_covariance", sheet.facet_slope_covariance},
                             {"slope_rms", sheet.slope_rms},
                             {"correlation_length", sheet.correlation_length}});
  out["levels"] = Json::array();
  for (const pan::layout::Level& level : model.levels()) {
    const double stretch = stretch_of(world[model.instances()[level.instance].node]).largest;
    out["levels"].push_back({{"instance", level.instance},
                             {"mesh", level.mesh},
                             {"material", level.material},
                             {"detail", stretch * level.detail},
                             {"error", stretch * level.error},
                             {"triangles", model.meshes()[level.mesh].triangle_count}});
  }
  out["decals"] = table_json(model, SectionKind::decals);
  return out;
}

Json sections_json(const pan::Model& model) {
  Json out = Json::array();
  for (const pan::layout::DirectoryEntry& entry : model.directory())
    out.push_back({{"kind", entry.kind},
                   {"name", pan::kind_name(entry.kind)},
                   {"read", model.reads(entry)},
                   {"count", entry.count},
                   {"element_bytes", entry.stride},
                   {"bytes", entry.raw_length},
                   {"stored_bytes", entry.stored_length},
                   {"compressed", entry.codec != 0}});
  return out;
}

Json bounds_json(const std::optional<AxisBox>& bounds) {
  return {{"min", bounds ? vector_json(bounds->low) : Json(nullptr)},
          {"max", bounds ? vector_json(bounds->high) : Json(nullptr)}};
}

Json size_json(const std::optional<AxisBox>& bounds) {
  if (!bounds) return nullptr;
  const Vec3 extents = bounds->extent();
  return {{"extents", vector_json(extents)},
          {"largest", std::max({extents.x, extents.y, extents.z})},
          {"words", compiler::size_in_words(extents)}};
}

}  // namespace panwright::tools
