// Embree device of the process. Private to geometry.
#pragma once

struct RTCDeviceTy;

namespace panwright::geometry {

// Returns the device, never null: throws std::bad_alloc on failure. Thread-safe.
RTCDeviceTy* embree_device();

}  // namespace panwright::geometry
