#include "studio/player.h"

#include <GLFW/glfw3.h>
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/text.h"

namespace panwright::studio {
namespace {

constexpr int kPatience = 40000;  // frames that are waited for what does not come: minutes
constexpr int kLook = 60;         // frames in which a widget has to be there

int key_of(const std::string& name) {
  if (name.size() == 1 && name[0] >= 'A' && name[0] <= 'Z') return GLFW_KEY_A + name[0] - 'A';
  if (name == "escape") return GLFW_KEY_ESCAPE;
  if (name == "enter") return GLFW_KEY_ENTER;
  if (name == "space") return GLFW_KEY_SPACE;
  return 0;
}

}  // namespace

Vec2 Player::on_image(const Vec2& part, const Desk& desk) const {
  const Place& place = desk.image_place();
  return place.low + part * (place.high - place.low);
}

Player::Wish Player::next(Desk& desk, DiagnosticLog& log) {
  Wish wish;
  if (at_ == steps_.size()) {
    wish.end = true;
    return wish;
  }
  // each step begins with a hand that holds nothing, where it was
  const std::optional<Vec2> mouse = hand_.mouse;
  hand_ = Hand{};
  hand_.mouse = mouse;
  const bool done = go(steps_[at_], desk, wish);
  ++frame_;
  if (!problem_.empty()) {
    log.report(Code::E0203, {}, fmt::format("step {} of the script: {}", at_ + 1, problem_));
    good_ = false;
    wish.end = true;
  }
  if (done) {
    ++at_;
    frame_ = 0;
    missing_ = 0;
  }
  return wish;
}

bool Player::go(const Step& step, Desk& desk, Wish& wish) {
  switch (step.kind) {
    case Step::Kind::click:
    case Step::Kind::type:
      return press(step, desk);
    case Step::Kind::drag:
    case Step::Kind::scroll:
      return move(step, desk);
    case Step::Kind::key:
      if (key_of(step.name) == 0)
        wrong(fmt::format("{} is no key; known are A to Z, escape, enter and space",
                          in_quotes(step.name)));
      hand_.key = frame_ < 2 ? key_of(step.name) : 0;
      return frame_ == 3;
    case Step::Kind::wait:
      if (step.name.empty()) return frame_ >= step.amount;
      if (frame_ > kPatience) wrong(fmt::format("waited in vain for {}", in_quotes(step.name)));
      if (frame_ < 3) return false;
      if (step.name == "read") return !desk.project().state().reading;
      if (step.name == "saved") {
        if (!desk.saving() && !desk.state("saved")->starts_with("saved "))
          wrong(fmt::format("nothing was saved: {}", *desk.state("saved")));
        return !desk.saving();
      }
      if (step.name == "video") {
        if (!desk.filming() && desk.state("video")->empty())
          wrong("no video was made: see video/make");
        return !desk.filming();
      }
      if (step.name == "sampled") {
        if (!desk.sampling() && desk.state("sample")->empty())
          wrong("no material's curves are on the screen");
        return !desk.sampling();
      }
      if (step.name == "compared" && desk.settled()) {
        if (desk.state("compare") == "off") wrong("nothing is compared: see compare/split");
        return !desk.state("reference samples")->empty();
      }
      if (desk.settled() && desk.state("pixels")->empty())
        wrong("there is no image: no version of the models could be read");
      return desk.settled();
    case Step::Kind::resize:
      if (frame_ == 0) wish.size = step.to;
      return frame_ == 8;
    case Step::Kind::replace:
      // files are looked at anew in a while: until then they count as read
      if (frame_ == 0) return !replace(step);
      return frame_ >= 40;
    case Step::Kind::screenshot:
      if (frame_ == 0) wish.screenshot = folder_ / step.name;
      return true;
    case Step::Kind::expect:
      return expect(step, desk);
  }
  return true;
}

bool Player::press(const Step& step, Desk& desk) {
  const Place* place = desk.widgets().find(step.name);
  if (place == nullptr) {
    // a tab that was just opened has its widgets in the next frame
    if (++missing_ < kLook) {
      frame_ = -1;
      return false;
    }
    const std::string near = desk.widgets().nearest(step.name);
    wrong(fmt::format("{} is not on the screen{}", in_quotes(step.name),
                      near.empty() ? "; what is further down a list comes with its search, or in a higher window"
                                   : fmt::format("; {} is", in_quotes(near))));
    return true;
  }
  const bool types = step.kind == Step::Kind::type;
  // what has its label beside it is used on its left
  const Vec2 middle(std::min(0.5 * (place->low.x + place->high.x), place->low.x + 40),
                    0.5 * (place->low.y + place->high.y));
  hand_.mouse = middle;
  hand_.control = types && frame_ >= 1 && frame_ <= 4;
  hand_.buttons[0] = frame_ == 2;
  if (!types) return frame_ == 4;
  if (frame_ == 5 || frame_ == 6) {
    hand_.control = true;
    hand_.key = frame_ == 5 ? GLFW_KEY_A : 0;
  }
  if (frame_ == 7) hand_.typed = step.value;
  if (frame_ == 9) hand_.key = GLFW_KEY_ENTER;
  return frame_ == 12;
}

bool Player::move(const Step& step, Desk& desk) {
  if (step.kind == Step::Kind::scroll) {
    hand_.mouse = on_image({0.5, 0.5}, desk);
    if (frame_ == 1) hand_.wheel = step.amount;
    return frame_ == 3;
  }
  const int way = static_cast<int>(step.amount);
  const double share = std::clamp((frame_ - 2) / step.amount, 0.0, 1.0);
  hand_.mouse = on_image(step.from + share * (step.to - step.from), desk);
  hand_.buttons[step.button] = frame_ >= 2 && frame_ <= way + 3;
  return frame_ == way + 6;
}

bool Player::replace(const Step& step) {
  const std::filesystem::path path = folder_ / step.name;
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto at = text.find(step.value);
  if (!in || at == std::string::npos) {
    wrong(fmt::format("{} does not hold {}", path.string(), in_quotes(step.value)));
    return false;
  }
  text.replace(at, step.value.size(), step.with);
  // at once, as editors do: never half of it
  const std::filesystem::path whole = path.string() + ".new";
  std::ofstream(whole, std::ios::binary) << text;
  std::error_code error;
  std::filesystem::rename(whole, path, error);
  if (error) wrong(fmt::format("{} cannot be written: {}", path.string(), error.message()));
  return true;
}

bool Player::expect(const Step& step, Desk& desk) {
  const std::optional<std::string> known = desk.state(step.name);
  if (!known) {
    wrong(fmt::format("nothing that can be expected is called {}", in_quotes(step.name)));
    return true;
  }
  const std::string& is = *known;
  if (is == step.value) return true;
  // numbers may be typed otherwise, and be off by what sliders round
  const auto number = [](const std::string& text) -> std::optional<double> {
    return parse_double(text);
  };
  const auto a = number(is), b = number(step.value);
  if (a && b && std::fabs(*a - *b) <= 1e-6 * std::fabs(*b)) return true;
  wrong(fmt::format("{} is {}, not {}", step.name, in_quotes(is), in_quotes(step.value)));
  return true;
}

}  // namespace panwright::studio
