// What a device does when its context or its memory fails, and when it is shared.
#include <glad/gl.h>

#include <thread>

#include "models.h"
#include "preview/gl/gl_objects.h"

namespace panwright::preview::device_test {
namespace {

using namespace testing_support;

TEST(Programs, ARefusedShaderSaysWhy) {
  const auto& device = shared_device();
  ASSERT_TRUE(device && device->context().make_current());
  const GladGLContext& gl = device->context().gl();
  const std::string vertex = "#version 450 core\nvoid main() { gl_Position = vec4(0.0); }\n";
  const std::string good =
      "#version 450 core\nout vec4 color;\nvoid main() { color = vec4(1.0); }\n";
  const std::string bad = "#version 450 core\nvoid main() { no_such_name = 1.0; }\n";
  const GlProgram fine = request_program(gl, vertex, good);
  const GlProgram refused = request_program(gl, vertex, bad);
  EXPECT_EQ(problem_of_program(gl, fine.id()), "");
  EXPECT_NE(problem_of_program(gl, refused.id()).find("no_such_name"), std::string::npos);
}

// ---- a context that fails when it is told to

bool refuses = false;      // to be made current
bool was_reset = false;    // as a driver reports it
int errors_to_report = 0;  // out of memory, one per question
PFNGLGETERRORPROC real_get_error = nullptr;

GLenum GLAD_API_PTR get_error() {
  if (errors_to_report == 0) return real_get_error();
  --errors_to_report;
  return GL_OUT_OF_MEMORY;
}
GLenum GLAD_API_PTR reset_status() { return was_reset ? GL_UNKNOWN_CONTEXT_RESET : GL_NO_ERROR; }

class FaultyContext final : public Context {
 public:
  FaultyContext() {
    refuses = was_reset = false;
    errors_to_report = 0;
    DiagnosticLog log;
    auto inner = Context::create(tested_context(), log);
    EXPECT_TRUE(inner) << to_text(log);
    inner_ = std::move(*inner);
    inner_->release();
    EXPECT_EQ(load(), "");
  }
  ~FaultyContext() override {
    release();
    inner_->make_current();
  }
  Proc get_proc(const char* name) const override {
    const Proc real = inner_->get_proc(name);
    if (std::string_view(name) == "glGetError") {
      real_get_error = reinterpret_cast<PFNGLGETERRORPROC>(real);
      return reinterpret_cast<Proc>(get_error);
    }
    if (std::string_view(name) == "glGetGraphicsResetStatus")
      return reinterpret_cast<Proc>(reset_status);
    return real;
  }
  ContextKind kind() const override { return inner_->kind(); }

 private:
  bool bind() override { return !refuses && inner_->make_current(); }
  void unbind() override { inner_->release(); }

  std::unique_ptr<Context> inner_;
};

struct Scene {
  world::World world;
  View view = looking_from({0.3, -1, 0.5}, 8, 0.5, 48);
  RenderOptions options;

  Scene() {
    options.shadow_side = 64;
    DiagnosticLog log;
    EXPECT_TRUE(world.add("a", model(), log));
    world::Sun sun;
    sun.direction = {1, -1, 1};
    world.set_sun(sun);
  }
  static world::ModelPtr model() {
    return std::make_shared<const pan::Model>(model_of(single(box({1, 2, 0.5}), lambert(0.8))));
  }
  Result<image::Image> drawn(Renderer& renderer, DiagnosticLog& log) const {
    return renderer.render(world, view.camera, options, log);
  }
};

TEST(Device, RefusedContextComesBack) {
  const auto device = Device::create(std::make_unique<FaultyContext>());
  Renderer renderer(device);
  const Scene scene;
  DiagnosticLog log;
  const auto before = scene.drawn(renderer, log);
  ASSERT_TRUE(before) << to_text(log);
  device->context().release();
  refuses = true;
  EXPECT_FALSE(scene.drawn(renderer, log));
  EXPECT_TRUE(log.contains(Code("E5001")));
  EXPECT_EQ(log.errors(), 1u);
  refuses = false;
  const auto after = scene.drawn(renderer, log);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->radiance, before->radiance);
}

TEST(Device, LostContextIsLostForGood) {
  const auto device = Device::create(std::make_unique<FaultyContext>());
  Renderer renderer(device);
  const Scene scene;
  DiagnosticLog log;
  const auto before = scene.drawn(renderer, log);
  ASSERT_TRUE(before) << to_text(log);
  was_reset = true;
  DiagnosticLog first;
  EXPECT_FALSE(scene.drawn(renderer, first));
  EXPECT_EQ(first.entries().back().message, "the OpenGL context was lost while it drew");
  was_reset = false;
  for (int i = 0; i < 2; ++i) {
    DiagnosticLog later;
    EXPECT_FALSE(scene.drawn(renderer, later));
    EXPECT_TRUE(later.contains(Code("E5001")));
    EXPECT_FALSE(device->resources(Scene::model(), later));
    EXPECT_EQ(later.errors(), 2u);
  }
  // worlds and models outlive it
  Renderer other(Device::create(std::make_unique<FaultyContext>()));
  const auto after = scene.drawn(other, log);
  ASSERT_TRUE(after) << to_text(log);
  EXPECT_EQ(after->radiance, before->radiance);
}

TEST(Device, ContextLostBetweenFramesDropsThoseUnderWay) {
  const auto device = Device::create(std::make_unique<FaultyContext>());
  Renderer renderer(device);
  const Scene scene;
  DiagnosticLog log;
  ASSERT_TRUE(renderer.submit(scene.world, scene.view.camera, scene.options, log));
  ASSERT_TRUE(renderer.submit(scene.world, scene.view.camera, scene.options, log));
  was_reset = true;
  EXPECT_FALSE(renderer.collect(log));
  EXPECT_TRUE(log.contains(Code("E5001")));
  EXPECT_EQ(log.errors(), 1u);
  EXPECT_EQ(renderer.in_flight(), 0u);
  was_reset = false;
  DiagnosticLog later;
  EXPECT_FALSE(renderer.submit(scene.world, scene.view.camera, scene.options, later));
  EXPECT_TRUE(later.contains(Code("E5001")));
}

TEST(Device, OutOfMemoryWithASecondModelKeepsTheFirst) {
  const auto device = Device::create(std::make_unique<FaultyContext>());
  Renderer renderer(device);
  Scene scene;
  DiagnosticLog log;
  const auto before = scene.drawn(renderer, log);
  ASSERT_TRUE(before) << to_text(log);
  Scene both = scene;
  ASSERT_TRUE(both.world.add("b", Scene::model(), {{0, 0, 1}, Quat(1, 0, 0, 0)}, log));
  errors_to_report = 1;
  DiagnosticLog refused;
  EXPECT_FALSE(both.drawn(renderer, refused));
  EXPECT_EQ(refused.errors(), 1u);
  EXPECT_TRUE(refused.contains(Code("E5003")));
  EXPECT_EQ(device->counts().models, 1u);
  const auto after = scene.drawn(renderer, log);
  ASSERT_TRUE(after) << to_text(log);
  EXPECT_EQ(after->radiance, before->radiance);
  // and with memory again, both
  const auto with_both = both.drawn(renderer, log);
  ASSERT_TRUE(with_both) << to_text(log);
  EXPECT_NE(with_both->radiance, before->radiance);
}

TEST(Device, AFrameThatFailedLeavesNothingBehind) {
  const auto device = Device::create(std::make_unique<FaultyContext>());
  Renderer renderer(device);
  Scene scene;
  DiagnosticLog log;
  ASSERT_TRUE(scene.drawn(renderer, log));
  for (int failing = 1; failing < 4; ++failing) {
    world::Sun sun = scene.world.sun();
    sun.direction += Vec3(0, 0.1, 0.2);
    scene.world.set_sun(sun);
    errors_to_report = failing;
    DiagnosticLog refused;
    EXPECT_FALSE(scene.drawn(renderer, refused));
    EXPECT_TRUE(refused.contains(Code("E5003")));
    errors_to_report = 0;
    const auto after = scene.drawn(renderer, log);
    Renderer fresh(shared_device());
    const auto other = scene.drawn(fresh, log);
    ASSERT_TRUE(after && other) << to_text(log);
    EXPECT_EQ(after->radiance, other->radiance);
  }
}

TEST(Device, IsSharedByRenderersOneThreadAtATime) {
  const auto device = shared_device();
  const Scene scene;
  Renderer a(device);
  DiagnosticLog log;
  const std::uint64_t models = device->counts().models;
  const auto first = scene.drawn(a, log);
  ASSERT_TRUE(first) << to_text(log);
  Renderer b(device);
  const auto second = scene.drawn(b, log);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->radiance, first->radiance);
  EXPECT_EQ(device->counts().models, models + 1);
  const auto on_a_thread = [&] {
    std::optional<std::vector<float>> radiance;
    DiagnosticLog said;
    std::thread([&] {
      auto image = scene.drawn(b, said);
      if (image) radiance = image->radiance;
      device->context().release();
    }).join();
    EXPECT_EQ(said.contains(Code("E5001")), !radiance.has_value());
    return radiance;
  };
  EXPECT_FALSE(on_a_thread());  // it is current here
  device->context().release();
  EXPECT_EQ(on_a_thread(), first->radiance);
  const auto third = scene.drawn(a, log);
  ASSERT_TRUE(third);
  EXPECT_EQ(third->radiance, first->radiance);
}

// The renderer holds the model of the world that it drew last, on the GPU too; what others drop in
// the meantime is still there, and goes with it.
TEST(Device, AModelLivesAsLongAsARendererHoldsIt) {
  const auto device = shared_device();
  std::weak_ptr<const pan::Model> watched;
  Renderer renderer(device);
  DiagnosticLog log;
  {
    Scene scene;
    watched = scene.world[0].model();
    ASSERT_TRUE(scene.drawn(renderer, log));
  }
  ASSERT_FALSE(watched.expired());
  auto kept = device->find(watched.lock());
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->triangles(), 12u);
  EXPECT_GT(kept->bytes(), 12u * 6);
  const View view = looking_from({0, -1, 0}, 4, 0.5, 8);
  ASSERT_TRUE(renderer.render(world::World(), view.camera, {}, log));
  EXPECT_FALSE(watched.expired());  // kept here
  kept.reset();
  EXPECT_TRUE(watched.expired());
}

}  // namespace
}  // namespace panwright::preview::device_test
