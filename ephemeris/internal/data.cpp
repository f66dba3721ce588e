#include "ephemeris/internal/data.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "ephemeris/internal/names.h"

namespace panwright::ephemeris {

namespace {

constexpr std::size_t kMostChain = 32;

std::string kind_text(DafKind kind, int type) {
  constexpr std::array<const char*, 3> kNames = {"SPK", "CK", "binary PCK"};
  return fmt::format("{} type {}", kNames[static_cast<std::size_t>(kind)], type);
}

bool ends_with_any(std::string_view text, std::initializer_list<std::string_view> ends) {
  for (const std::string_view end : ends)
    if (text.ends_with(end)) return true;
  return false;
}

}  // namespace

bool Kernels::Data::add(const Daf& daf, const std::string& file, std::string& problem) {
  const auto damaged = [&](const DafSegment& segment, const SegmentInfo& info) {
    problem = fmt::format("segment {} '{}', {}: {}", &segment - daf.segments.data(), segment.name,
                          info.kind, problem);
    return false;
  };
  for (const DafSegment& segment : daf.segments) {
    SegmentInfo info{
        file,          {},         segment.name, segment.numbers[0], segment.numbers[1], 0,
        segment.begin, segment.end};
    if (daf.kind == DafKind::ck) {
      const int type = segment.numbers[2];
      info.kind = kind_text(daf.kind, type);
      info.in_ticks = true;
      info.read = is_ck_type_read(type);
      AttitudeSegment out{infos.size(), info.id, info.relative, info.begin,
                          info.end,     {},      segment.data};
      if (info.read && !ck_layout(type, segment.numbers[3] == 1, segment.data, out.layout, problem))
        return damaged(segment, info);
      turning[info.id].push_back(out);
    } else {
      const bool orbit = daf.kind == DafKind::spk;
      const int type = segment.numbers[orbit ? 3 : 2];
      info.kind = kind_text(daf.kind, type);
      info.read = orbit ? is_spk_type_read(type) : type == 2;
      info.frame = orbit ? segment.numbers[2] : info.relative;
      OrbitSegment out{infos.size(), info.id, info.relative, info.frame, {}, segment.data};
      if (info.read && !spk_layout(type, segment.data, out.layout, problem))
        return damaged(segment, info);
      Track& track = (orbit ? bodies : angles)[info.id];
      track.spans.push_back({info.begin, info.end, track.segments.size()});
      track.segments.push_back(std::move(out));
    }
    infos.push_back(std::move(info));
  }
  return true;
}

void Kernels::Data::finish() {
  for (auto* tracks : {&bodies, &angles})
    for (auto& entry : *tracks) {
      entry.second.timeline = Timeline::of(entry.second.spans);
      entry.second.spans.clear();
    }
  const auto* const names = pool.texts("NAIF_BODY_NAME");
  const auto* const codes = pool.numbers("NAIF_BODY_CODE");
  for (std::size_t i = 0; names && codes && i < std::min(names->size(), codes->size()); ++i) {
    if (!(std::abs((*codes)[i]) < 2e9)) continue;
    const int code = static_cast<int>((*codes)[i]);
    body_numbers[plain_name((*names)[i])] = code;
    body_names[code] = (*names)[i];
  }
  constexpr std::string_view kBegin = "FRAME_";
  for (const auto& [name, values] : pool.all()) {
    if (!name.starts_with(kBegin)) continue;
    const std::string_view rest = std::string_view(name).substr(kBegin.size());
    if (values.numbers.size() == 1 && std::abs(values.numbers[0]) < 2e9 &&
        !ends_with_any(rest, {"_CLASS", "_CLASS_ID", "_CENTER"}))
      frame_numbers[plain_name(rest)] = static_cast<int>(values.numbers[0]);
  }
}

std::string Kernels::Data::body_text(int body) const {
  if (const auto found = body_names.find(body); found != body_names.end())
    return fmt::format("{} ({})", found->second, body);
  const auto known = known_body_name(body);
  return known.empty() ? fmt::format("body {}", body) : fmt::format("{} ({})", known, body);
}

bool Kernels::Data::link(int body, double et, int& centre, State& out, std::string& problem) const {
  const auto track = bodies.find(body);
  const auto item = track == bodies.end() ? std::nullopt : track->second.timeline.at(et);
  if (!item) {
    problem = fmt::format("no SPK gives the position of {} at that time", body_text(body));
    return false;
  }
  const OrbitSegment& segment = track->second.segments[*item];
  const SegmentInfo& info = infos[segment.info];
  if (!info.read) {
    problem = fmt::format("{} gives the position of {} as {}, which is not read", info.file,
                          body_text(body), info.kind);
    return false;
  }
  State read;
  if (!spk_state(segment.layout, segment.data, et, read)) {
    problem = fmt::format("segment '{}' of {} is damaged: it gives no finite state of {}",
                          info.name, info.file, body_text(body));
    return false;
  }
  centre = segment.centre;
  if (segment.frame == kJ2000) {
    out = read;
    return true;
  }
  const auto axes = attitude(segment.frame, et, 0, problem);
  if (!axes) return false;
  if (!axes->rate) {
    problem = fmt::format("the positions of {} are in {}, whose rate no kernel gives",
                          body_text(body), frame_text(segment.frame));
    return false;
  }
  const Mat3 back = transpose(axes->from_j2000);
  out.position = back * read.position;
  out.velocity = back * read.velocity + cross(*axes->rate, out.position);
  return true;
}

std::optional<State> Kernels::Data::relative(int target, int observer, double et,
                                             std::string& problem) const {
  if (target == observer) return State{};
  // of the target: bodies on the way to the root, with its state relative to each
  std::array<std::pair<int, State>, kMostChain> chain{};
  std::size_t count = 0;
  chain[count++] = {target, State{}};
  std::string missing;
  while (count < kMostChain && chain[count - 1].first != 0) {
    int centre = 0;
    State step;
    if (!link(chain[count - 1].first, et, centre, step, missing)) break;
    const State& before = chain[count - 1].second;
    chain[count++] = {centre, {before.position + step.position, before.velocity + step.velocity}};
    if (centre == observer) return chain[count - 1].second;
  }
  State own;
  int body = observer;
  for (std::size_t depth = 0; depth < kMostChain; ++depth) {
    for (std::size_t i = 0; i < count; ++i)
      if (chain[i].first == body)
        return State{chain[i].second.position - own.position,
                     chain[i].second.velocity - own.velocity};
    int centre = 0;
    State step;
    if (body == 0 || !link(body, et, centre, step, problem)) break;
    own = {own.position + step.position, own.velocity + step.velocity};
    body = centre;
  }
  if (!missing.empty()) problem = missing;
  if (problem.empty())
    problem = fmt::format("no chain of segments leads from {} to {}", body_text(observer),
                          body_text(target));
  return std::nullopt;
}

}  // namespace panwright::ephemeris
