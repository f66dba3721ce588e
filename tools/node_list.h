// The nodes of a model as a list that can be copied from.
#pragma once

#include <string>

#include "pan/model.h"

namespace panwright::tools {

// One line for each node but the root, parents first: its whole name, the triangles that hang on
// the node itself and their materials, between tabs. Control characters of names are escaped.
std::string node_list(const pan::Model& model);

}  // namespace panwright::tools
