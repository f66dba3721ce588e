// Columns of a CSV table, by their header. Private to scenario.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenario/internal/input.h"
#include "scenario/time.h"

namespace panwright::scenario {

enum class ColumnKind : std::uint8_t {
  ignored,
  time,   // seconds
  epoch,  // text
  position,
  velocity,
  rotation,  // component: w x y z
  joint,
  lens,  // component: a LensNumber
  sun_direction,
  sun_distance,
  name,
  seed,
};

struct Column {
  ColumnKind kind = ColumnKind::ignored;
  std::string_view header;
  std::string target;  // empty: the camera's, or none
  std::string joint;
  std::size_t component = 0;
  double factor = 1;     // to metres, seconds, radians, AU
  bool inverse = false;  // of a rotation: of the camera's or model's frame from the world
  TimeSystem system = TimeSystem::utc;  // of epochs
  std::optional<Epoch> epoch;           // of time 0
};

// Reports: W8002, or E8001 if strict. Fails: E8001, E8007.
std::optional<Column> column_of(std::string_view header, Input& input, bool strict);

}  // namespace panwright::scenario
