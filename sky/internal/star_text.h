// The catalogue held in the library. Private to sky.
#pragma once

#include <string>

namespace panwright::sky {

std::string hipparcos_text();  // sky/stars.csv

}  // namespace panwright::sky
