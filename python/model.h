// Model as Python holds it.
#pragma once

#include <string>

#include "world/world.h"

namespace panwright::python {

struct Model {
  world::ModelPtr model;  // never null
  std::string path;       // of the file that was opened
};

}  // namespace panwright::python
