// Reader of materials. Private to pxn.
#pragma once

#include "materials/material.h"
#include "pxn/expression/values.h"
#include "pxn/materials.h"
#include "pxn/text/reporter.h"

namespace panwright::pxn {

// Reads a <material>. Unreadable fields are left out.
//
// Reports: E1201 to E1203; of a named material also E1406, E1407.
materials::Fields read_material(const xml::Document& document, std::uint32_t element,
                                Values& values, Reporter& reporter);

// Reads the provenance of a named material, over that of its base material.
void read_provenance(const xml::Document& document, std::uint32_t element, Values& values,
                     Provenance& out);

}  // namespace panwright::pxn
