// Checks of a STEP model's entities, before OpenCASCADE follows their references.
#pragma once

#include <StepData_StepModel.hxx>
#include <cstdint>
#include <vector>

#include "importers/import.h"
#include "importers/step/internal/text.h"

namespace panwright::importers::step {

// Returns the number of an entity in the file; 0: none.
std::uint64_t number_of(const Handle(StepData_StepModel) & model,
                        const Handle(Standard_Transient) & entity);

// Returns the numbers of shapes, their constituents, their ties to products, and styles that refer
// to nothing or to an entity of a wrong kind.
std::vector<std::uint64_t> torn(const Handle(StepData_StepModel) & model);

// Returns the units of shapes, in metres, each once. Empty: no shape has one.
std::vector<double> length_units(const Handle(StepData_StepModel) & model);

// Returns false, with E6601, if a product is a part of itself. Throws OverLimit for assemblies that
// are deeper or larger than the limits.
bool check_assembly(const Handle(StepData_StepModel) & model, const Text& text,
                    const Limits& limits, DiagnosticLog& log);

}  // namespace panwright::importers::step
