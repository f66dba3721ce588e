// Combined sources: shifts of epochs, conflicts, frames outside a source, cameras that follow.
#include "scenario/sequence.h"

#include <gtest/gtest.h>

#include "scenario/csv.h"
#include "scenario/oem.h"
#include "tests/scenario/support.h"

namespace panwright::scenario::sequence_test {
namespace {

using support::codes;

SourcePtr csv(const std::string& text) {
  DiagnosticLog log;
  auto source = read_csv(memory_text("t.csv", text), {}, log);
  EXPECT_TRUE(source) << to_text(log);
  return source ? *source : nullptr;
}

SourcePtr positions(const std::string& target, const std::string& time, const std::string& rows) {
  return csv(time + "," + target + ".x[m]," + target + ".y[m]," + target + ".z[m]\n" + rows);
}

std::string problem(std::vector<Part> parts, const SequenceOptions& options = {}) {
  DiagnosticLog log;
  const auto sequence = Sequence::of(std::move(parts), options, log);
  EXPECT_EQ(sequence.ok(), !log.has_errors());
  return codes(log);
}

const std::string kRows = "0,0,0,0\n10,10,20,30\n";

TEST(Sequence, ShiftsEpochs) {
  // 37 s and one hour apart
  const auto a =
      positions("a", "time[s since 2026-01-01T00:00:00 UTC]", "0,0,0,0\n7200,7200,0,0\n");
  const auto b =
      positions("camera", "time[s since 2026-01-01T01:00:37 TAI]", "0,0,0,0\n10,10,0,0\n");
  DiagnosticLog log;
  const auto both = Sequence::of({{a}, {b}}, {}, log);
  ASSERT_TRUE(both) << to_text(log);
  EXPECT_EQ(codes(log), "");
  EXPECT_EQ(both->spans(), (std::vector<TimeSpan>{{3600, 3610}}));
  EXPECT_EQ(both->times(), (std::vector<double>{0, 7200}));
  const auto frame = both->at(3604, log);
  ASSERT_TRUE(frame) << to_text(log);
  EXPECT_EQ(frame->targets.at(0).placement.position, Vec3(3604, 0, 0));
  EXPECT_EQ(frame->camera.position, Vec3(4, 0, 0));
  EXPECT_EQ(frame->time, 3604);
  EXPECT_EQ(epoch_text(*frame->epoch, frame->system), "2026-01-01T00:00:00");
  EXPECT_FALSE(both->frame(0, log));  // outside the camera's source
  EXPECT_EQ(codes(log), "E8003");
}

TEST(Sequence, GivenEpochAndOffsets) {
  const auto a =
      positions("a", "time[UTC]", "2026-01-01T00:00:10,0,0,0\n2026-01-01T00:00:20,1,0,0\n");
  const auto b = positions("b", "time[s]", kRows);
  SequenceOptions options;
  std::string ignored;
  options.epoch = parse_epoch("2026-01-01T00:00:00", TimeSystem::utc, ignored);
  DiagnosticLog log;
  const auto both = Sequence::of({{a}, {b, 10.1}}, options, log);
  ASSERT_TRUE(both) << to_text(log);
  EXPECT_EQ(codes(log), "");
  EXPECT_EQ(both->spans().at(0).begin, 10.1);
  // the end of a span is in it, whatever the rounding of offsets
  EXPECT_TRUE(both->at(both->spans()[0].begin, log));
  EXPECT_TRUE(both->at(both->spans()[0].end, log)) << to_text(log);
  EXPECT_EQ(problem({{a}, {b}}), "N8010");
}

TEST(Sequence, Conflicts) {
  const auto a = positions("a", "time[s]", kRows);
  EXPECT_EQ(problem({{a}, {positions("a", "time[s]", kRows)}}), "E8008");
  EXPECT_EQ(problem({{a}, {positions("b", "time[s]", kRows)}}), "");
  const auto ordered = csv("b.x[m],b.y[m],b.z[m]\n0,0,0\n1,1,1\n");
  EXPECT_EQ(problem({{ordered}}), "");
  EXPECT_EQ(problem({{a}, {ordered}}), "E8009");
  EXPECT_EQ(problem({{ordered}, {csv("c.x[m],c.y[m],c.z[m]\n0,0,0\n")}}), "E8009");
}

TEST(Sequence, ReferenceFrames) {
  const auto oem = [](const std::string& target, const std::string& frame,
                      const std::string& centre) {
    DiagnosticLog log;
    const auto source = read_oem(
        memory_text("t.oem",
                    "CCSDS_OEM_VERS = 2.0\nMETA_START\nOBJECT_NAME = A\nOBJECT_ID = A\n"
                    "CENTER_NAME = " +
                        centre + "\nREF_FRAME = " + frame +
                        "\nTIME_SYSTEM = TAI\nSTART_TIME = 2026-01-01T00:00:00\n"
                        "STOP_TIME = 2026-01-01T00:01:00\nINTERPOLATION = LINEAR\nMETA_STOP\n"
                        "2026-01-01T00:00:00 1 0 0 0 0 0\n2026-01-01T00:01:00 2 0 0 0 0 0\n"),
        {target, false}, log);
    EXPECT_TRUE(source) << to_text(log);
    return Part{*source};
  };
  EXPECT_EQ(problem({oem("a", "EME2000", "EARTH"), oem("", "EME2000", "Earth")}), "");
  EXPECT_EQ(problem({oem("a", "EME2000", "EARTH"), oem("", "ICRF", "EARTH")}), "N8010");
  EXPECT_EQ(problem({oem("a", "EME2000", "EARTH"), oem("", "ITRF2000", "EARTH")}), "E8009");
  EXPECT_EQ(problem({oem("a", "EME2000", "EARTH"), oem("", "EME2000", "MARS")}), "E8009");
}

TEST(Sequence, CameraLooksAndRides) {
  const auto target =
      csv("time[s],a.x[m],a.y[m],a.z[m],a.qw[world_from_model],a.qx[world_from_model],"
          "a.qy[world_from_model],a.qz[world_from_model]\n"
          "0,100,0,0,0.7071067811865476,0,0,0.7071067811865476\n"
          "10,100,0,0,0.7071067811865476,0,0,0.7071067811865476\n");
  const auto camera = positions("camera", "time[s]", "0,0,-10,0\n10,0,-20,0\n");
  SequenceOptions options;
  options.mount = Mount{"a", true};
  options.look_at = LookAt{"a", Vec3(0, 0, 1), Vec3(0, 0, 1)};
  DiagnosticLog log;
  const auto sequence = Sequence::of({{target}, {camera}}, options, log);
  ASSERT_TRUE(sequence) << to_text(log);
  const auto frame = sequence->at(5, log);
  ASSERT_TRUE(frame) << to_text(log);
  // −15 m along the model's y, which is −x of the world
  EXPECT_LT(length(*frame->camera.position - Vec3(115, 0, 0)), 1e-12);
  EXPECT_LT(length(*frame->camera.rotation * Vec3(0, 0, 1) - normalize(Vec3(-15, 0, 1))), 1e-15);
  options.mount->turns = false;
  const auto along = Sequence::of({{target}, {camera}}, options, log);
  EXPECT_LT(length(*along->at(5, log)->camera.position - Vec3(100, -15, 0)), 1e-12);
  options.look_at->target = "b";
  EXPECT_EQ(problem({{target}, {camera}}, options), "E8009");
  options.look_at->target = "a";
  EXPECT_EQ(problem({{target}}, options), "E8009");
}

}  // namespace
}  // namespace panwright::scenario::sequence_test
