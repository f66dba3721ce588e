// List of a model's nodes, for copying.
#pragma once

#include <string>

#include "pan/model.h"

namespace panwright::tools {

// Returns a line of headings and one for each node but the root, parents first: its whole name, the
// triangles of the node itself and their materials, its id and path, separated by tabs. Control
// characters of names are escaped.
std::string node_list(const pan::Model& model);

}  // namespace panwright::tools
