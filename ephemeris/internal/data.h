// Contents of kernels, and the parts of their answers. Private to ephemeris.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/file.h"
#include "ephemeris/internal/ck.h"
#include "ephemeris/internal/daf.h"
#include "ephemeris/internal/pool.h"
#include "ephemeris/internal/spk.h"
#include "ephemeris/internal/timeline.h"
#include "ephemeris/kernels.h"

namespace panwright::ephemeris {

struct OrbitSegment {    // of SPK, and of binary PCK
  std::size_t info = 0;  // of its entry in the list of segments
  int id = 0, centre = 0, frame = 0;
  SpkLayout layout;
  Doubles data;
};

struct AttitudeSegment {
  std::size_t info = 0;
  int id = 0, reference = 0;
  double begin = 0, end = 0;  // ticks
  CkLayout layout;
  Doubles data;
};

// One body or frame: its segments, in order of files, and which of them holds when.
struct Track {
  std::vector<OrbitSegment> segments;
  std::vector<Timeline::Piece> spans;
  Timeline timeline;
};

struct Kernels::Data {
  std::vector<MappedFile> files;
  std::vector<Daf> dafs;
  Pool pool;
  std::map<int, Track> bodies;
  std::map<int, Track> angles;                          // by class number of the frame
  std::map<int, std::vector<AttitudeSegment>> turning;  // by instrument
  std::vector<SegmentInfo> infos;
  std::map<std::string, int, std::less<>> body_numbers;  // of text kernels, by plain name
  std::map<int, std::string> body_names;
  std::map<std::string, int, std::less<>> frame_numbers;  // by plain name

  // Adds the segments of a DAF, which stays. False: problem.
  bool add(const Daf& daf, const std::string& file, std::string& problem);
  // After all files: timelines and names.
  void finish();

  // State of a body relative to the centre of its segment, in axes of J2000. False: problem.
  bool link(int body, double et, int& centre, State& out, std::string& problem) const;
  // Geometric state in axes of J2000.
  std::optional<State> relative(int target, int observer, double et, std::string& problem) const;
  std::optional<Attitude> attitude(int frame, double et, int depth, std::string& problem) const;
  std::optional<int> frame_number(std::string_view name) const;
  std::string frame_text(int frame) const;
  std::string body_text(int body) const;
  int clock_of(int instrument) const;
  // Body in the origin of a frame.
  std::optional<int> centre_of(int frame) const;

  struct FrameClass {
    int kind = 0;  // 1 inertial, 2 of a body, 3 CK, 4 fixed to another; others are not read
    int number = 0;
  };
  std::optional<FrameClass> class_of(int frame) const;
  // Attitude of a body's frame by polynomials of text PCK.
  std::optional<Attitude> body_attitude(int body, double et, std::string& problem) const;

 private:
  std::optional<Attitude> by_angles(int number, double et, int depth, std::string& problem) const;
  std::optional<Attitude> by_ck(int number, double et, int depth, std::string& problem) const;
  std::optional<Attitude> by_text(int frame, int number, double et, int depth,
                                  std::string& problem) const;
};

// Axes turned by w, delta and phi: [w]3 [delta]1 [phi]3, and their rate.
//
//   angles  phi, delta and w as position, their rates as velocity
Attitude attitude_of_angles(const State& angles);

// Attitude of axes that are given relative to others.
Attitude composed(const Attitude& reference, const Mat3& from_reference,
                  const std::optional<Vec3>& rate_in_reference);

}  // namespace panwright::ephemeris
