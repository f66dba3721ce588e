#include "geometry/ray/internal/embree_device.h"

#include <embree3/rtcore.h>

#include <new>

namespace panwright::geometry {
namespace {

struct SharedDevice {
  RTCDevice device = rtcNewDevice(nullptr);
  ~SharedDevice() { rtcReleaseDevice(device); }
};

}  // namespace

RTCDevice embree_device() {
  static const SharedDevice shared;
  if (shared.device == nullptr) throw std::bad_alloc();
  return shared.device;
}

}  // namespace panwright::geometry
