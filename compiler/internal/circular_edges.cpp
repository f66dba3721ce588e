// CircularEdges of different instances that meet in the world.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <unordered_map>

#include "compiler/internal/jobs.h"

namespace panwright::compiler::internal {

namespace {

constexpr double kSame = 1e-6;   // of the radius: how far circular edges may lie apart
constexpr double kRound = 1e-9;  // of the radius: how far a circle may be off one
// note: groups of one cell beyond this limit keep their own segments; it takes many circular
// edges that lie within 8e-6 of their radius and yet apart
constexpr std::size_t kMostCandidates = 64;

struct WorldCircularEdge {
  Vec3 centre;
  Vec3 axis;   // unit; the circular edge runs counter-clockwise about it
  Vec3 start;  // from the centre
  double radius;
  double sector;
  std::uint32_t job;
};

// Two circular edges that meet, and the angle from the start of one to that of the other.
struct EdgeMeeting {
  std::uint32_t a, b;  // jobs
  double phase;
};

bool placed(const geometry::CircularEdge& edge, const Mat4& world, std::uint32_t job,
            WorldCircularEdge& out) {
  const Mat3 linear(world);
  out.start = linear * edge.start;
  const Vec3 across = linear * glm::cross(edge.axis, edge.start);
  out.radius = glm::length(out.start);
  const Vec3 normal = glm::cross(out.start, across);
  const double area = glm::length(normal);
  const double room = kRound * out.radius * out.radius;
  if (!(area > 0) || std::fabs(glm::dot(out.start, across)) > room ||
      std::fabs(glm::dot(across, across) - out.radius * out.radius) > 2 * room)
    return false;
  out.centre = Vec3(world * Vec4(edge.centre, 1.0));
  out.axis = normal / area;
  out.sector = edge.sector;
  out.job = job;
  return is_finite(out.centre) && is_finite(out.axis);
}

bool meet(const WorldCircularEdge& a, const WorldCircularEdge& b) {
  const double room = kSame * a.radius;
  return std::fabs(a.radius - b.radius) <= room && glm::length(a.centre - b.centre) <= room &&
         glm::length(glm::cross(a.axis, b.axis)) <= kSame;
}

double phase_between(const WorldCircularEdge& a, const WorldCircularEdge& b) {
  return det::atan2(glm::dot(glm::cross(a.start, b.start), a.axis), glm::dot(a.start, b.start));
}

using Cell = std::array<double, 4>;  // three whole numbers and the radius's exponent

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t sum = 0;
    for (const double part : cell) {
      std::uint64_t bits;
      std::memcpy(&bits, &part, sizeof bits);
      sum = (sum ^ bits) * 0x9e3779b97f4a7c15ull;
      sum ^= sum >> 29;
    }
    return sum;
  }
};

// Finds which of the circular edges added so far a circular edge meets.
class EdgeGrid {
 public:
  explicit EdgeGrid(const std::vector<WorldCircularEdge>& circular_edges)
      : edges_(circular_edges) {}

  // The first circular edge of those that the circular edge meets; when there is none, it is the
  // first of others.
  std::uint32_t first_met(std::uint32_t index) {
    const WorldCircularEdge& edge = edges_[index];
    const int low = exponent(edge.radius * (1 - 2 * kSame));
    const int high = exponent(edge.radius * (1 + 2 * kSame));
    for (int e = low; e <= high; ++e) {
      const auto lower = cell(edge, e, -2), upper = cell(edge, e, 2);
      for (int corner = 0; corner < 8; ++corner) {
        Cell at = lower;
        bool repeated = false;
        for (std::size_t k = 0; k < 3; ++k) {
          if (!(corner >> k & 1)) continue;
          repeated |= upper[k] == lower[k];
          at[k] = upper[k];
        }
        if (repeated) continue;
        const auto found = cells_.find(at);
        if (found == cells_.end()) continue;
        for (const std::uint32_t other : found->second)
          if (meet(edges_[other], edge)) return other;
      }
    }
    auto& own = cells_[cell(edge, exponent(edge.radius), 0)];
    if (own.size() < kMostCandidates) own.push_back(index);
    return index;
  }

 private:
  static int exponent(double radius) {
    int e = 0;
    std::frexp(radius, &e);
    return e;
  }
  static Cell cell(const WorldCircularEdge& edge, int e, double shift) {
    const double size = std::ldexp(8 * kSame, e);
    Cell out{0, 0, 0, static_cast<double>(e)};
    for (int k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(k)] =
          std::floor((edge.centre[k] + shift * kSame * edge.radius) / size) + 0.0;  // no −0
    return out;
  }

  const std::vector<WorldCircularEdge>& edges_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

// What is known of the circular edges of a job.
struct JobEdges {
  std::vector<geometry::CircularEdge> circular_edges;
  double sector = 2 * kPi;
  std::uint32_t own = 0;     // segments it takes when left alone
  std::uint32_t shared = 0;  // segments it needs when its vertices stand on the circular edges
};

std::vector<JobEdges> edges_of_jobs(const std::vector<MeshJob>& jobs) {
  std::vector<JobEdges> out(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    out[i].circular_edges = geometry::circular_edges_of(*jobs[i].shape);
    if (out[i].circular_edges.empty()) continue;
    out[i].sector = out[i].circular_edges.front().sector;
    geometry::TessellationOptions options;
    options.max_error = jobs[i].max_error;
    out[i].own = geometry::segments_of(*jobs[i].shape, options);
    // vertices outside by 2/3 and chords inside by 1/3 of what chords between vertices on the
    // circle lie inside: the latter need finer steps for the same error
    options.max_error = jobs[i].max_error * (2.0 / 3.0);
    out[i].shared = geometry::segments_of(*jobs[i].shape, options);
  }
  return out;
}

std::vector<EdgeMeeting> meetings_of(const std::vector<Mat4>& world, const scene::Scene& scene,
                                     const Plan& plan, const std::vector<JobEdges>& jobs) {
  std::vector<WorldCircularEdge> circular_edges;
  std::vector<std::uint32_t> instance_of;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const std::uint32_t job = plan.job_of[i];
    if (jobs[job].own == 0) continue;
    for (const geometry::CircularEdge& edge : jobs[job].circular_edges) {
      WorldCircularEdge placed_edge;
      const auto node = static_cast<std::size_t>(scene.instances[i].node);
      if (!placed(edge, world[node], job, placed_edge)) continue;
      circular_edges.push_back(placed_edge);
      instance_of.push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::vector<EdgeMeeting> out;
  EdgeGrid grid(circular_edges);
  for (std::uint32_t i = 0; i < circular_edges.size(); ++i) {
    const std::uint32_t first = grid.first_met(i);
    if (instance_of[first] != instance_of[i])
      out.push_back({circular_edges[first].job, circular_edges[i].job,
                     phase_between(circular_edges[first], circular_edges[i])});
  }
  return out;
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Jobs that share circular edges, directly or through others.
struct Family {
  std::vector<std::uint32_t> jobs;
  std::vector<EdgeMeeting> meetings;
};

std::vector<Family> families_of(const std::vector<EdgeMeeting>& meetings, std::size_t jobs) {
  UnionFind sets(jobs);
  for (const EdgeMeeting& meeting : meetings) sets.unite(meeting.a, meeting.b);
  std::vector<Family> out;
  std::unordered_map<std::uint32_t, std::size_t> place;
  std::vector<char> listed(jobs);
  for (const EdgeMeeting& meeting : meetings) {
    const auto [found, added] = place.emplace(sets.root(meeting.a), out.size());
    if (added) out.emplace_back();
    Family& family = out[found->second];
    family.meetings.push_back(meeting);
    for (const std::uint32_t job : {meeting.a, meeting.b})
      if (!listed[job]) listed[job] = 1, family.jobs.push_back(job);
  }
  return out;
}

// Whether vertices at every 1/turn of a whole turn meet, for circular edges turned by these angles.
bool aligned(const std::vector<double>& phases, double turn) {
  for (const double phase : phases) {
    const double steps = phase / (2 * kPi) * turn;
    if (std::fabs(steps - std::round(steps)) * (2 * kPi) > 2 * kSame * turn) return false;
  }
  return true;
}

bool divides(const Family& family, const std::vector<JobEdges>& jobs, double turn) {
  for (const std::uint32_t job : family.jobs) {
    const double segments = turn * jobs[job].sector / (2 * kPi);
    if (std::fabs(segments - std::round(segments)) > 1e-9 * turn) return false;
  }
  return true;
}

std::vector<double> phases_of(const Family& family) {
  std::vector<double> phases;
  for (const EdgeMeeting& meeting : family.meetings) phases.push_back(meeting.phase);
  std::sort(phases.begin(), phases.end());
  const auto same = [](double a, double b) { return b - a <= 1e-12; };
  phases.erase(std::unique(phases.begin(), phases.end(), same), phases.end());
  return phases;
}

// Sets the segments of a family; false: none were found.
bool settle(const Family& family, const std::vector<JobEdges>& circular_edges,
            std::vector<MeshJob>& jobs) {
  const std::vector<double> phases = phases_of(family);
  const JobEdges& first = circular_edges[family.jobs.front()];
  if (family.jobs.size() == 1 && aligned(phases, first.own * (2 * kPi / first.sector)))
    return true;  // copies of one mesh meet as they are
  double least = 0;
  for (const std::uint32_t job : family.jobs)
    least = std::max(least, circular_edges[job].shared * (2 * kPi / circular_edges[job].sector));
  least = std::ceil(least * (1 - 1e-12));
  const double most = std::max(least + 4, least * 1.125);
  for (double turn = least; turn <= most; ++turn) {
    if (!divides(family, circular_edges, turn) || !aligned(phases, turn)) continue;
    for (const std::uint32_t job : family.jobs)
      jobs[job].edge_segments =
          static_cast<std::uint32_t>(std::round(turn * circular_edges[job].sector / (2 * kPi)));
    return true;
  }
  return false;
}

}  // namespace

void share_circular_edges(const std::vector<Mat4>& world, const scene::Scene& scene, Plan& plan) {
  const std::vector<JobEdges> circular_edges = edges_of_jobs(plan.jobs);
  const std::vector<EdgeMeeting> meetings = meetings_of(world, scene, plan, circular_edges);
  std::vector<EdgeMeeting> straight;
  for (const Family& family : families_of(meetings, plan.jobs.size())) {
    if (settle(family, circular_edges, plan.jobs)) continue;
    // one that is turned askew does not keep the others apart
    for (const EdgeMeeting& meeting : family.meetings)
      if (std::fabs(meeting.phase) <= kSame) straight.push_back(meeting);
  }
  for (const Family& family : families_of(straight, plan.jobs.size()))
    settle(family, circular_edges, plan.jobs);
}

}  // namespace panwright::compiler::internal
