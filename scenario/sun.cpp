#include "scenario/sun.h"

#include <memory>
#include <utility>

#include "ephemeris/analytic.h"
#include "scenario/kernels.h"

namespace panwright::scenario {

namespace {

constexpr double kKilometresOfAu = 149597870.7;

class SunSource final : public Source {
 public:
  SunSource(SourceInfo info, double begin) : Source(std::move(info)), begin_(begin) {}

 private:
  const char* fill(double time, Frame& frame) const override {
    const Vec3 sun = ephemeris::sun_from_earth(begin_ + time);
    const double distance = length(sun);
    frame.sun_direction = sun / distance;
    frame.sun_distance = distance / kKilometresOfAu;
    return nullptr;
  }
  double begin_;
};

}  // namespace

SourcePtr sun_source(const Epoch& epoch, TimeSystem system) {
  constexpr double kYear = 365.25 * 86400;
  SourceInfo info;
  info.name = "sun";
  info.epoch = epoch;
  info.system = system;
  info.frame = "EME2000";
  info.channels = {{Quantity::sun_direction, {}, {}}, {Quantity::sun_distance, {}, {}}};
  const double begin = et_of(epoch);
  info.spans = {{-200 * kYear - begin, 50 * kYear - begin}};
  return std::make_shared<SunSource>(std::move(info), begin);
}

}  // namespace panwright::scenario
