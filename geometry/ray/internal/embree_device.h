// The one Embree device of the process. Private to geometry.
#pragma once

struct RTCDeviceTy;

namespace panwright::geometry {

// Never null: throws std::bad_alloc where there is none. Safe from any thread.
RTCDeviceTy* embree_device();

}  // namespace panwright::geometry
