// Lamps and scenes as text.
#pragma once

#include <string>
#include <vector>

#include "pxn/text/element_writer.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Writes a `<lamp>`, in metres and radians.
void write_lamp(const scene::Lamp& lamp, const std::string& name, ElementWriter& out);

// Writes the `<scene>` of settings; without any, nothing.
void write_settings(const std::vector<scene::Setting>& settings, ElementWriter& out);

}  // namespace panwright::pxn
