// Rules for the materials of all formats: opacity, energy, normal maps. Private to importers.
#pragma once

#include <string>

#include "base/diagnostic.h"
#include "importers/import.h"

namespace panwright::importers {

// Applies the rules to a scene as read.
//
//   opacity      parts of opacity 0 are left out: N6007. Partly transparent ones are marked
//                (scene::Instance::see_through) and reported once for the materials: W6008
//   energy       diffuse and specular colours that add up to more than 1 are scaled to 1: W1402
//   normal maps  images without normals are reported: W6015
//
//   name  of the file, for messages
// A second call, for a scene with parts of other files, reports what is new.
void settle_appearance(Imported& imported, const std::string& name, DiagnosticLog& log);

}  // namespace panwright::importers
