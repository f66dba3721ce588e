#include "importers/step/internal/entities.h"

#include <fmt/core.h>

#include <Interface_Check.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepGeom_Curve.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepRepr_DefinitionalRepresentation.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "importers/step/internal/bodies.h"
#include "importers/step/internal/document.h"

namespace panwright::importers::step {

namespace {

// A curve on a surface whose representation holds no curve: loading does not look into it.
bool is_hollow(const Handle(Standard_Transient) & entity) {
  const auto curve = Handle(StepGeom_Pcurve)::DownCast(entity);
  if (curve.IsNull()) return false;
  const auto& representation = curve->ReferenceToCurve();
  return representation.IsNull() || representation->Items().IsNull() ||
         representation->NbItems() < 1 || representation->ItemsValue(1).IsNull() ||
         !representation->ItemsValue(1)->IsKind(STANDARD_TYPE(StepGeom_Curve));
}

// Whether loading found a reference to nothing, or to an entity of another kind than it must be.
// Numbers and words that are odd do no harm.
bool has_bad_reference(const Handle(StepData_StepModel) & model, int index) {
  if (!model->IsReportEntity(index)) return false;
  const Handle(Interface_Check)& check = model->Check(index, Standard_True);
  // the wordings of StepData_StepReaderData
  constexpr std::string_view kWordings[] = {"ntity", "SELECT clause", "illegal parameter type"};
  for (int i = 1; i <= check->NbFails(); ++i)
    for (const std::string_view wording : kWordings)
      if (std::string_view(check->CFail(i)).find(wording) != std::string_view::npos) return true;
  return false;
}

}  // namespace

std::uint64_t number_of(const Handle(StepData_StepModel) & model,
                        const Handle(Standard_Transient) & entity) {
  if (entity.IsNull()) return 0;
  return static_cast<std::uint64_t>(std::max(0, model->IdentLabel(entity)));
}

std::vector<std::uint64_t> torn(const Handle(StepData_StepModel) & model) {
  constexpr std::string_view kPackages[] = {"StepGeom_", "StepShape_", "StepRepr_", "StepVisual_"};
  std::vector<std::uint64_t> out;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient)& entity = model->Value(i);
    const std::string_view type = entity->DynamicType()->Name();
    const int number = model->IdentLabel(entity);
    if (number <= 0 || std::none_of(std::begin(kPackages), std::end(kPackages),
                                    [&](std::string_view p) { return type.starts_with(p); }))
      continue;
    if (has_bad_reference(model, i) || is_hollow(entity))
      out.push_back(static_cast<std::uint64_t>(number));
  }
  return out;
}

std::vector<double> length_units(const Handle(StepData_StepModel) & model) {
  constexpr double kSame = 1e-9;
  std::vector<double> out;
  std::set<int> known;  // contexts
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(model->Value(i));
    if (shape.IsNull() || shape->ContextOfItems().IsNull()) continue;
    const Handle(StepRepr_RepresentationContext) context = shape->ContextOfItems();
    if (!known.insert(model->Number(context)).second) continue;
    Handle(StepRepr_GlobalUnitAssignedContext) units;
    if (const auto plain = Handle(
            StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(context);
        !plain.IsNull())
      units = plain->GlobalUnitAssignedContext();
    if (const auto precise = Handle(
            StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(context);
        !precise.IsNull())
      units = precise->GlobalUnitAssignedContext();
    if (units.IsNull()) continue;
    STEPConstruct_UnitContext factors;
    factors.ComputeFactors(units);
    if (!factors.LengthDone()) continue;
    const double metres = factors.LengthFactor() / kMetre;
    if (std::none_of(out.begin(), out.end(),
                     [&](double unit) { return std::fabs(unit / metres - 1) < kSame; }))
      out.push_back(metres);
  }
  return out;
}

bool check_assembly(const Handle(StepData_StepModel) & model, const Text& text,
                    const Limits& limits, DiagnosticLog& log) {
  std::map<std::uint64_t, std::vector<std::uint64_t>> parts;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    if (use.IsNull()) continue;
    const std::uint64_t whole = number_of(model, use->RelatingProductDefinition());
    const std::uint64_t part = number_of(model, use->RelatedProductDefinition());
    if (whole != 0 && part != 0) parts[whole].push_back(part);
  }
  // depth and number of nodes below each, 0: being counted
  std::map<std::uint64_t, std::pair<std::uint32_t, double>> below;
  struct Step {
    std::uint64_t whole;
    std::size_t next = 0;
    std::uint32_t depth = 1;
    double nodes = 1;
  };
  for (const auto& [start, unused] : parts) {
    if (below.contains(start)) continue;
    std::vector<Step> path = {{start}};
    below[start] = {0, 0};
    while (!path.empty()) {
      Step& step = path.back();
      const auto children = parts.find(step.whole);
      if (children == parts.end() || step.next == children->second.size()) {
        below[step.whole] = {step.depth, step.nodes};
        const Step done = step;
        path.pop_back();
        if (!path.empty()) {
          path.back().depth = std::max(path.back().depth, done.depth + 1);
          path.back().nodes += done.nodes;
        }
        if (done.depth > limits.depth) throw OverLimit{"depth"};
        if (done.nodes > static_cast<double>(limits.nodes)) throw OverLimit{"nodes"};
        continue;
      }
      const std::uint64_t child = children->second[step.next++];
      const auto known = below.find(child);
      if (known == below.end()) {
        below[child] = {0, 0};
        path.push_back({child});
        if (path.size() > limits.depth) throw OverLimit{"depth"};
      } else if (known->second.first == 0) {
        log.report(Code("E6601"), place_of(text, child),
                   fmt::format("product #{} is a part of itself", child));
        return false;
      } else {
        step.depth = std::max(step.depth, known->second.first + 1);
        step.nodes += known->second.second;
      }
    }
  }
  return true;
}

}  // namespace panwright::importers::step
