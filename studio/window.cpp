#include "studio/window.h"

#include <glad/gl.h>
// after glad
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "base/file.h"
#include "base/png.h"
#include "studio/player.h"

namespace panwright::studio {
namespace {

using Clock = std::chrono::steady_clock;

// Seconds, while nothing moves: models and images wake the window.
constexpr double kIdleWait = 0.1;
// frames that are drawn after the last input, as ImGui needs some to settle
constexpr int kFramesAfter = 4;
constexpr const char* kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/TTF/DejaVuSans.ttf"};

std::string glfw_problem;

// One window with its OpenGL context, and what ImGui draws there.
class Screen {
 public:
  ~Screen() {
    if (gui_) {
      ImGui_ImplOpenGL3_Shutdown();
      ImGui_ImplGlfw_Shutdown();
      ImGui::DestroyContext();
    }
    if (window_ != nullptr) glfwDestroyWindow(window_);
    if (started_) glfwTerminate();
  }

  bool open(const Options& options, DiagnosticLog& log) {
    const auto refused = [&](const std::string& why) {
      log.report(Code::E5001, {},
                 fmt::format("no window can be opened: {}", why),
                 "`panwright render` makes images without one; Xvfb is a display without a screen");
      return false;
    };
    glfwSetErrorCallback([](int, const char* what) { glfw_problem = what; });
    started_ = glfwInit() == GLFW_TRUE;
    if (!started_) return refused(glfw_problem.empty() ? "there is no display" : glfw_problem);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ =
        glfwCreateWindow(static_cast<int>(options.layout.width),
                         static_cast<int>(options.layout.height), "Panwright", nullptr, nullptr);
    if (window_ == nullptr) return refused(glfw_problem);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(options.with_script ? 0 : 1);
    if (gladLoadGLContext(&gl_, glfwGetProcAddress) == 0)
      return refused("OpenGL 3.3 is not there");
    float across = 1, down = 1;
    glfwGetWindowContentScale(window_, &across, &down);
    scale_ = options.scale > 0 ? options.scale : std::max(1.0, double{across});
    start_gui(options.with_script);
    gl_.GenTextures(2, textures_);
    return true;
  }

  void start_gui(bool scripted) {
    ImGui::CreateContext();
    gui_ = true;
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.ConfigInputTextCursorBlink = !scripted;
    ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(static_cast<float>(scale_));
    ImGui::GetStyle().WindowRounding = 0;
    ImGui::GetStyle().WindowBorderSize = 1;
    for (const char* font : kFonts)
      if (std::filesystem::exists(font) &&
          io.Fonts->AddFontFromFileTTF(font, static_cast<float>(std::round(15 * scale_))))
        break;
    if (io.Fonts->Fonts.empty()) io.FontGlobalScale = static_cast<float>(scale_);
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330");
  }

  void begin_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
  }

  void end_frame() {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    gl_.Viewport(0, 0, width, height);
    gl_.ClearColor(0.06f, 0.06f, 0.07f, 1);
    gl_.Clear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }

  // Pixels as they are: one of the image is one of the screen, once it is exact.
  void show(const Desk::Canvas& canvas, bool sample) {
    gl_.BindTexture(GL_TEXTURE_2D, textures_[sample]);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(canvas.width),
                   static_cast<GLsizei>(canvas.height), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   canvas.rgba.data());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_2D, filter, canvas.smooth ? GL_LINEAR : GL_NEAREST);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl_.TexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    shows_[sample] = true;
  }

  bool screenshot(const std::filesystem::path& path, DiagnosticLog& log) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height));
    gl_.ReadBuffer(GL_BACK);
    gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    // the lowest row comes first
    const std::size_t row = 4 * static_cast<std::size_t>(width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(height) / 2; ++y)
      std::swap_ranges(pixels.begin() + static_cast<std::ptrdiff_t>(y * row),
                       pixels.begin() + static_cast<std::ptrdiff_t>((y + 1) * row),
                       pixels.end() - static_cast<std::ptrdiff_t>((y + 1) * row));
    for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = 255;
    PngOptions options;
    options.says_srgb = true;
    const std::string file = png_file(static_cast<std::uint32_t>(width),
                                      static_cast<std::uint32_t>(height), pixels, options);
    return write_file(path, as_bytes(file), log);
  }

  GLFWwindow* window() const { return window_; }
  double scale() const { return scale_; }
  Desk::Textures textures() const { return {shows_[0] ? textures_[0] : 0u, shows_[1] ? textures_[1] : 0u}; }
  void swap() { glfwSwapBuffers(window_); }

 private:
  bool started_ = false;
  GLFWwindow* window_ = nullptr;
  bool gui_ = false;
  GladGLContext gl_{};
  double scale_ = 1;
  GLuint textures_[2] = {};
  bool shows_[2] = {};
};

// A hand of a script in place of the real one.
void take(const Hand& hand) {
  ImGuiIO& io = ImGui::GetIO();
  if (hand.mouse)
    io.MousePos = {static_cast<float>(hand.mouse->x), static_cast<float>(hand.mouse->y)};
  for (int k = 0; k < 3; ++k) io.MouseDown[k] = hand.buttons[k];
  io.MouseWheel = static_cast<float>(hand.wheel);
  io.KeyCtrl = hand.control;
  for (bool& key : io.KeysDown) key = false;
  if (hand.key > 0) io.KeysDown[hand.key] = true;
  for (const char c : hand.typed) io.AddInputCharacter(static_cast<unsigned char>(c));
}

void dropped(GLFWwindow* window, int count, const char** paths) {
  static_cast<Desk*>(glfwGetWindowUserPointer(window))
      ->drop(std::vector<std::string>(paths, paths + count));
}

class Loop {
 public:
  Loop(Screen& screen, Desk& desk, const Options& options)
      : screen_(screen), desk_(desk), options_(options), player_(options.script, options.folder) {}

  bool run(DiagnosticLog& log) {
    while (glfwWindowShouldClose(screen_.window()) == 0) {
      wait();
      const auto start = Clock::now();
      const double busy = thread_seconds();
      bool other = false;
      if (const Desk::Canvas* canvas = desk_.new_canvas()) {
        screen_.show(*canvas, false);
        left_ = kFramesAfter;
        other = true;
      }
      if (const Desk::Canvas* canvas = desk_.new_sample_canvas()) {
        screen_.show(*canvas, true);
        left_ = kFramesAfter;
      }
      frame();
      report_.spent.add(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      report_.busy = std::max(report_.busy, 1e3 * (thread_seconds() - busy));
      if (options_.with_script && !follow(log)) break;
      screen_.swap();
      if (other) measure();
      if (options_.with_script) report_.resident.add(static_cast<double>(resident_bytes()));
    }
    return player_.good();
  }

  Report report() const {
    Report out = report_;
    out.drawing = desk_.artist().status();
    out.readings = desk_.project().state().readings;
    out.command = desk_.command();
    return out;
  }

 private:
  // An image is on the screen.
  void measure() {
    if (report_.first_image == 0)
      report_.first_image = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (const auto saved = desk_.saved_to_image()) {
      report_.saved.add(saved->shown);
      report_.last_saved = *saved;
    }
  }

  // Nothing is drawn while nothing happens.
  void wait() {
    if (options_.with_script) return glfwPollEvents();
    const auto version = desk_.project().state().readings;
    glfwPollEvents();
    const ImGuiIO& io = ImGui::GetIO();
    const bool active = io.MouseDelta.x != 0 || io.MouseDelta.y != 0 || ImGui::IsAnyMouseDown() ||
                        io.WantTextInput || !desk_.idle() || version != readings_;
    readings_ = version;
    if (active) left_ = kFramesAfter;
    if (left_ > 0)
      --left_;
    else
      glfwWaitEventsTimeout(kIdleWait);
  }

  void frame() {
    screen_.begin_frame();
    if (options_.with_script) take(player_.hand());
    ImGui::NewFrame();
    int width = 0, height = 0;
    glfwGetWindowSize(screen_.window(), &width, &height);
    desk_.frame({width, height}, screen_.scale(), screen_.textures());
    screen_.end_frame();
  }

  // False: the script is at its end, or cannot go on.
  bool follow(DiagnosticLog& log) {
    // the image has its own thread: this one leaves it the processor
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
    const Player::Wish wish = player_.next(desk_, log);
    if (wish.size)
      glfwSetWindowSize(screen_.window(), static_cast<int>(wish.size->x),
                        static_cast<int>(wish.size->y));
    if (!wish.screenshot.empty() && !screen_.screenshot(wish.screenshot, log)) return false;
    return !wish.end;
  }

  Screen& screen_;
  Desk& desk_;
  const Options& options_;
  Player player_;
  const Clock::time_point begin_ = Clock::now();
  Report report_;
  std::uint64_t readings_ = 0;
  int left_ = kFramesAfter;
};

}  // namespace

bool run(const Options& options, DiagnosticLog& log, Report* report) {
  Screen screen;
  if (!screen.open(options, log)) return false;
  Desk desk(options);
  glfwSetWindowUserPointer(screen.window(), &desk);
  glfwSetDropCallback(screen.window(), dropped);
  Loop loop(screen, desk, options);
  const bool good = loop.run(log);
  if (!options.layout_file.empty()) write_layout(options.layout_file, desk.layout());
  if (report != nullptr) *report = loop.report();
  return good;
}

}  // namespace panwright::studio
