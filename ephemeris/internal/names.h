// Names of bodies and frames that SPICE knows without kernels. Private to ephemeris.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/math.h"

namespace panwright::ephemeris {

// Letters without case, blanks and underscores as one blank, no blanks around: as names are
// compared.
std::string plain_name(std::string_view name);

std::optional<int> known_body(std::string_view plain);
std::string_view known_body_name(int id);  // empty: none

// Frames 1 to 21, whose axes stand still.
std::optional<int> inertial_frame(std::string_view plain);
std::string_view inertial_frame_name(int id);  // empty: none
// Expects: 1 to 21. Takes vectors in axes of J2000 to those of the frame.
const Mat3& inertial_from_j2000(int id);

// Frames of bodies, as IAU_MARS: number of the frame by that of the body, and the other way.
std::optional<int> iau_frame_of(int body);
std::optional<int> body_of_iau_frame(int frame);

// Passive turn of axes about axis 1, 2 or 3.
Mat3 turned_axes(double angle, int axis);

}  // namespace panwright::ephemeris
