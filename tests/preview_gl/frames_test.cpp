// Frames one after the other: drawn while the one before is copied, in memory that is used again,
// and cancelled at any point.
#include <atomic>
#include <cstdlib>
#include <new>
#include <thread>

#include "models.h"
#include "preview/model/device_impl.h"

namespace {

// what this program asked of the heap so far, through operator new
std::atomic<std::uint64_t> heap_calls = 0;

}  // namespace

// note: kept out of line, as compilers take a pair that is inlined in part for a mistake
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++heap_calls;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace panwright::preview::frames_test {
namespace {

using namespace testing_support;

world::ModelPtr ball() {
  return std::make_shared<const pan::Model>(model_of(single(sphere(24, 48), lambert(0.8))));
}

// Two targets, one model.
struct Scene {
  world::World world;
  View view = looking_from({0.3, -1, 0.5}, 12, 0.5, 96);
  RenderOptions options;

  Scene() {
    options.shadow_side = 128;
    DiagnosticLog log;
    const auto model = ball();
    EXPECT_TRUE(world.add("a", model, log));
    EXPECT_TRUE(world.add("b", model, {{1.5, -1, 0.5}, Quat(1, 0, 0, 0)}, log));
    set_sun(0);
  }
  void set_sun(int frame) {
    world::Sun sun;
    sun.direction = {1, -1, 1 + 0.05 * frame};
    world.set_sun(sun);
  }
  // All that may change from frame to frame.
  world::Camera advance(int frame) {
    set_sun(frame);
    world.set_pose(1, {{1.5, -1, 0.5 + 0.02 * frame}, Quat(1, 0, 0, 0)});
    world::Camera camera = view.camera;
    camera.position += Vec3(0.03 * frame, 0, 0);
    return camera;
  }
};

std::shared_ptr<Device> own_device(bool through_buffers) {
  DiagnosticLog log;
  auto device = Device::create(tested_context(), log);
  EXPECT_TRUE(device) << to_text(log);
  (*device)->impl().read_through_buffers = through_buffers;
  return *device;
}

void expect_equal(const image::Image& a, const image::Image& b) {
  EXPECT_TRUE(a.radiance == b.radiance && a.coverage == b.coverage);
  EXPECT_TRUE(a.depth == b.depth && a.range == b.range && a.normal == b.normal);
  EXPECT_TRUE(a.target_id == b.target_id && a.node_id == b.node_id);
  EXPECT_TRUE(a.material_id == b.material_id);
  EXPECT_EQ(a.unit, b.unit);
}

class FramesThrough : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Frames, FramesThrough, testing::Values(false, true),
                         [](const auto& one) { return one.param ? "Buffers" : "Memory"; });

// Whichever way a frame is made, and whatever its memory held before.
TEST_P(FramesThrough, UnderWayAreTheSameBits) {
  constexpr int kFrames = 7;
  Scene scene;
  for (const std::uint32_t tile_side : {2048u, 40u}) {
    scene.options.tile_side = tile_side;
    DiagnosticLog log;
    std::vector<image::Image> expected;
    for (int i = 0; i < kFrames; ++i) {
      scene.options.ground_truth = i % 3 == 1;
      const world::Camera camera = scene.advance(i);
      Renderer fresh(shared_device());
      auto image = fresh.render(scene.world, camera, scene.options, log);
      ASSERT_TRUE(image) << to_text(log);
      expected.push_back(*std::move(image));
    }
    Renderer renderer(own_device(GetParam()));
    int ended = 0;
    const auto end = [&] {
      auto image = renderer.collect(log);
      ASSERT_TRUE(image) << to_text(log);
      expect_equal(*image, expected[static_cast<std::size_t>(ended++)]);
      renderer.recycle(*std::move(image));
    };
    for (int i = 0; i < kFrames; ++i) {
      scene.options.ground_truth = i % 3 == 1;
      const world::Camera camera = scene.advance(i);
      ASSERT_TRUE(renderer.submit(scene.world, camera, scene.options, log)) << to_text(log);
      if (renderer.in_flight() == Renderer::kMostInFlight) end();
    }
    while (renderer.in_flight() > 0) end();
    EXPECT_EQ(ended, kFrames);
  }
}

// Camera, Sun and a target move: after the first frames of a size, neither the context nor the heap
// is asked for memory, and what goes to the context is the blocks of the frame.
TEST_P(FramesThrough, AllocateNothing) {
  for (const bool ground_truth : {false, true}) {
    Scene scene;
    scene.options.ground_truth = ground_truth;
    const auto device = own_device(GetParam());
    Renderer renderer(device);
    DiagnosticLog log;
    const auto frame = [&](int i) {
      const world::Camera camera = scene.advance(i);
      ASSERT_TRUE(renderer.submit(scene.world, camera, scene.options, log));
      if (renderer.in_flight() < Renderer::kMostInFlight) return;
      auto image = renderer.collect(log);
      ASSERT_TRUE(image);
      renderer.recycle(*std::move(image));
    };
    for (int i = 0; i < 5; ++i) frame(i);
    const Device::Counts before = device->counts();
    const std::uint64_t heap = heap_calls;
    ASSERT_GT(heap, 0u);  // it counts
    for (int i = 5; i < 10; ++i) frame(i);
    EXPECT_EQ(heap_calls - heap, 0u) << "truth " << ground_truth;
    const Device::Counts after = device->counts();
    EXPECT_EQ(after.allocations, before.allocations);
    EXPECT_EQ(after.programs, before.programs);
    EXPECT_EQ(after.model_bytes, before.model_bytes);
    EXPECT_EQ(after.models, 1u);
    // two items and one view for radiance, as much for the truth; two shadow maps of two items each
    // and their limits: blocks of 1024 bytes at most
    const std::uint64_t uploaded = after.uploaded_bytes - before.uploaded_bytes;
    EXPECT_GT(uploaded, 0u);
    EXPECT_LE(uploaded, 5u * 12 * 1024);
  }
}

TEST(Frames, MoreMemoryIsAskedForWhereMoreIsShown) {
  Scene scene;
  const auto device = own_device(false);
  Renderer renderer(device);
  DiagnosticLog log;
  ASSERT_TRUE(renderer.render(scene.world, scene.view.camera, scene.options, log));
  const std::uint64_t before = device->counts().allocations;
  EXPECT_GT(before, 0u);
  View larger = looking_from({0.3, -1, 0.5}, 12, 0.5, 200);
  ASSERT_TRUE(renderer.render(scene.world, larger.camera, scene.options, log));
  EXPECT_GT(device->counts().allocations, before);
}

TEST(Frames, ARefusedFrameLeavesTheOneUnderWay) {
  Scene scene;
  Renderer renderer(own_device(false));
  DiagnosticLog log;
  const auto expected = renderer.render(scene.world, scene.view.camera, scene.options, log);
  ASSERT_TRUE(expected);
  ASSERT_TRUE(renderer.submit(scene.world, scene.view.camera, scene.options, log));
  RenderOptions small = scene.options;
  small.max_bytes = 100;
  DiagnosticLog refused;
  EXPECT_FALSE(renderer.submit(scene.world, scene.view.camera, small, refused));
  EXPECT_TRUE(refused.contains(Code("E5003")));
  ASSERT_EQ(renderer.in_flight(), 1u);
  const auto image = renderer.collect(log);
  ASSERT_TRUE(image) << to_text(log);
  expect_equal(*image, *expected);
}

TEST(Frames, CancelledAnywhereTheNextIsWhole) {
  Scene scene;
  scene.options.samples = 4;
  scene.options.ground_truth = true;
  Renderer renderer(own_device(false));
  DiagnosticLog log;
  const auto start = std::chrono::steady_clock::now();
  const auto expected = renderer.render(scene.world, scene.view.camera, scene.options, log);
  ASSERT_TRUE(expected);
  const auto whole = std::chrono::steady_clock::now() - start;
  int cancelled = 0;
  for (int i = 0; i < 12; ++i) {
    const Job job(JobOptions{});
    std::thread other([&] {
      std::this_thread::sleep_for(whole * i / 12);
      job.cancel();
    });
    DiagnosticLog stopped;
    bool good = renderer.submit(scene.world, scene.view.camera, scene.options, stopped, job);
    if (good && renderer.in_flight() < Renderer::kMostInFlight)
      good = renderer.submit(scene.world, scene.view.camera, scene.options, stopped, job);
    while (good && renderer.in_flight() > 0) good = renderer.collect(stopped, job).ok();
    other.join();
    EXPECT_EQ(renderer.in_flight(), 0u);
    EXPECT_EQ(stopped.contains(Code("E0001")), !good);
    cancelled += !good;
    const auto image = renderer.render(scene.world, scene.view.camera, scene.options, log);
    ASSERT_TRUE(image) << to_text(log);
    expect_equal(*image, *expected);
  }
  EXPECT_GT(cancelled, 0);
}

TEST(Frames, ACancelledUploadLeavesNothing) {
  Scene scene;
  const auto device = own_device(false);
  Renderer renderer(device);
  const Job job(JobOptions{});
  job.cancel();
  DiagnosticLog log;
  EXPECT_FALSE(renderer.render(scene.world, scene.view.camera, scene.options, log, job));
  EXPECT_TRUE(log.contains(Code("E0001")));
  EXPECT_EQ(log.errors(), 1u);
  EXPECT_EQ(device->counts().models, 0u);
  DiagnosticLog later;
  EXPECT_TRUE(renderer.render(scene.world, scene.view.camera, scene.options, later));
}

TEST(Frames, DroppedAreForgotten) {
  Scene scene;
  Renderer renderer(own_device(false));
  DiagnosticLog log;
  ASSERT_TRUE(renderer.submit(scene.world, scene.view.camera, scene.options, log));
  ASSERT_TRUE(renderer.submit(scene.world, scene.advance(3), scene.options, log));
  renderer.drop();
  EXPECT_EQ(renderer.in_flight(), 0u);
  const world::Camera camera = scene.advance(5);
  const auto image = renderer.render(scene.world, camera, scene.options, log);
  Renderer fresh(shared_device());
  const auto expected = fresh.render(scene.world, camera, scene.options, log);
  ASSERT_TRUE(image && expected) << to_text(log);
  expect_equal(*image, *expected);
}

}  // namespace
}  // namespace panwright::preview::frames_test
