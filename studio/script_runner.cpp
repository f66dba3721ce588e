#include "studio/script_runner.h"

#include <GLFW/glfw3.h>
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "base/file.h"
#include "base/text.h"

namespace panwright::studio {
namespace {

constexpr int kMaxWaitFrames = 40000;  // minutes
constexpr int kWidgetFrames = 60;      // frames to wait for a widget
constexpr std::uint64_t kMaxReplacedBytes = std::uint64_t{1} << 30;

int key_of(const std::string& name) {
  if (name.size() == 1 && name[0] >= 'A' && name[0] <= 'Z') return GLFW_KEY_A + name[0] - 'A';
  if (name == "escape") return GLFW_KEY_ESCAPE;
  if (name == "enter") return GLFW_KEY_ENTER;
  if (name == "space") return GLFW_KEY_SPACE;
  if (name == "left") return GLFW_KEY_LEFT;
  if (name == "right") return GLFW_KEY_RIGHT;
  return 0;
}

}  // namespace

Vec2 ScriptRunner::on_image(const Vec2& part, const MainWindow& window) const {
  const WidgetRect& place = window.image_rect();
  return place.low + part * (place.high - place.low);
}

ScriptRunner::Actions ScriptRunner::next(MainWindow& window, DiagnosticLog& log) {
  Actions actions;
  if (at_ == steps_.size()) {
    actions.end = true;
    return actions;
  }
  // each step begins without buttons or keys pressed
  const std::optional<Vec2> mouse = input_.mouse;
  input_ = ScriptedInput{};
  input_.mouse = mouse;
  const bool done = advance(steps_[at_], window, actions);
  ++frame_;
  if (!problem_.empty()) {
    log.report(Code("E0203"), {}, fmt::format("step {} of the script: {}", at_ + 1, problem_));
    ok_ = false;
    actions.end = true;
  }
  if (done) {
    ++at_;
    frame_ = 0;
    missing_ = 0;
  }
  return actions;
}

bool ScriptRunner::advance(const Step& step, MainWindow& window, Actions& actions) {
  switch (step.kind) {
    case Step::Kind::click:
    case Step::Kind::type:
      return press(step, window);
    case Step::Kind::drag:
    case Step::Kind::scroll:
      return move(step, window);
    case Step::Kind::key:
      if (key_of(step.name) == 0)
        fail(fmt::format("unknown key {}; expected A to Z, escape, enter, space, left or right",
                         in_quotes(step.name)));
      input_.key = frame_ < 2 ? key_of(step.name) : 0;
      return frame_ == 3;
    case Step::Kind::wait:
      return wait(step, window);
    case Step::Kind::resize:
      if (frame_ == 0) actions.size = step.to;
      return frame_ == 8;
    case Step::Kind::replace:
      // changed files are found after some frames
      if (frame_ == 0) return !replace(step);
      return frame_ >= 40;
    case Step::Kind::screenshot:
      if (frame_ == 0) actions.screenshot = folder_ / step.name;
      return true;
    case Step::Kind::expect:
      return expect(step, window);
  }
  return true;
}

bool ScriptRunner::wait(const Step& step, MainWindow& window) {
  if (step.name.empty()) return frame_ >= step.amount;
  if (frame_ > kMaxWaitFrames) fail(fmt::format("{} did not occur in time", in_quotes(step.name)));
  if (frame_ < 3) return false;
  if (step.name == "read") return !window.project().state().reading;
  if (step.name == "played") return !window.playing();
  if (step.name == "saved") {
    if (!window.saving() && !window.state("saved")->starts_with("saved "))
      fail(fmt::format("nothing was saved: {}", *window.state("saved")));
    return !window.saving();
  }
  if (step.name == "video") {
    if (!window.recording() && window.state("video")->empty())
      fail("no video was made: see video/make");
    return !window.recording();
  }
  if (step.name == "sampled") {
    if (!window.sampling() && window.state("sample")->empty())
      fail("no curves of a material are displayed");
    return !window.sampling();
  }
  if (const std::string why = window.settled() ? window.failure() : std::string(); !why.empty()) {
    fail("there is no image of this view: " + why);
    return true;
  }
  if (step.name == "compared" && window.settled()) {
    if (window.state("compare") == "off") fail("no comparison is active: see compare/split");
    return !window.state("reference samples")->empty();
  }
  if (window.settled() && window.state("pixels")->empty())
    fail("there is no image: no version of the models could be read");
  return window.settled();
}

bool ScriptRunner::press(const Step& step, MainWindow& window) {
  const WidgetRect* place = window.widgets().find(step.name);
  if (place == nullptr) {
    // a new tab has its widgets from the next frame
    if (++missing_ < kWidgetFrames) {
      frame_ = -1;
      return false;
    }
    const std::string near = window.widgets().nearest(step.name);
    fail(fmt::format("{} is not on the screen{}", in_quotes(step.name),
                     near.empty() ? "; search the list, or use a higher window"
                                  : fmt::format("; {} is", in_quotes(near))));
    return true;
  }
  const bool types = step.kind == Step::Kind::type;
  // widgets with a label are used on their left
  const Vec2 middle(std::min(0.5 * (place->low.x + place->high.x), place->low.x + 40),
                    0.5 * (place->low.y + place->high.y));
  input_.mouse = middle;
  input_.control = types && frame_ >= 1 && frame_ <= 4;
  input_.buttons[0] = frame_ == 2;
  if (!types) return frame_ == 4;
  if (frame_ == 5 || frame_ == 6) {
    input_.control = true;
    input_.key = frame_ == 5 ? GLFW_KEY_A : 0;
  }
  if (frame_ == 7) input_.typed = step.value;
  if (frame_ == 9) input_.key = GLFW_KEY_ENTER;
  return frame_ == 12;
}

bool ScriptRunner::move(const Step& step, MainWindow& window) {
  if (step.kind == Step::Kind::scroll) {
    input_.mouse = on_image({0.5, 0.5}, window);
    if (frame_ == 1) input_.wheel = step.amount;
    return frame_ == 3;
  }
  const int way = static_cast<int>(step.amount);
  const double share = std::clamp((frame_ - 2) / step.amount, 0.0, 1.0);
  input_.mouse = on_image(step.from + share * (step.to - step.from), window);
  input_.buttons[step.button] = frame_ >= 2 && frame_ <= way + 3;
  return frame_ == way + 6;
}

bool ScriptRunner::replace(const Step& step) {
  const std::filesystem::path path = folder_ / step.name;
  DiagnosticLog log;
  auto text = read_file(path, kMaxReplacedBytes, log);
  const auto at = text ? text->find(step.value) : std::string::npos;
  if (text && at == std::string::npos) {
    fail(fmt::format("{} does not contain {}", path.string(), in_quotes(step.value)));
    return false;
  }
  // replaced as a whole, as editors do
  if (!text || !write_file(path, as_bytes(text->replace(at, step.value.size(), step.with)), log)) {
    fail(log.entries()[0].message);
    return false;
  }
  return true;
}

bool ScriptRunner::expect(const Step& step, MainWindow& window) {
  const std::optional<std::string> known = window.state(step.name);
  if (!known) {
    fail(fmt::format("unknown name {}", in_quotes(step.name)));
    return true;
  }
  const std::string& found = *known;
  if (found == step.value) return true;
  // numbers may differ in notation and by the rounding of sliders
  const auto number = [](const std::string& text) -> std::optional<double> {
    return parse_double(text);
  };
  const auto a = number(found), b = number(step.value);
  if (a && b && std::fabs(*a - *b) <= 1e-6 * std::fabs(*b)) return true;
  fail(
      fmt::format("{}: expected {}, found {}", step.name, in_quotes(step.value), in_quotes(found)));
  return true;
}

}  // namespace panwright::studio
