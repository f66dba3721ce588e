#include "studio/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/core.h>
#include <glad/gl.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "base/clock.h"
#include "base/file.h"
#include "base/file_uses.h"
#include "base/text.h"
#include "image/image.h"
#include "image/png.h"
#include "studio/main_window.h"
#include "studio/script_runner.h"

namespace panwright::studio {
namespace {

using FrameClock = std::chrono::steady_clock;

constexpr double kIdleWait = 0.1;  // seconds; models and images wake the window
constexpr int kFramesAfter = 4;    // frames after the last input, which Dear ImGui needs to settle
constexpr const char* kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/TTF/DejaVuSans.ttf"};

std::string glfw_problem;  // set by GLFW's error callback

// Window with its OpenGL context and Dear ImGui.
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
    const auto fail = [&](const std::string& why) {
      log.report(Code("E5001"), {}, fmt::format("cannot open a window: {}", why),
                 "`panwright render` needs no display; Xvfb is a virtual one");
      return false;
    };
    glfwSetErrorCallback([](int, const char* what) { glfw_problem = what; });
    started_ = glfwInit() == GLFW_TRUE;
    if (!started_) return fail(glfw_problem.empty() ? "no display" : glfw_problem);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ =
        glfwCreateWindow(static_cast<int>(options.layout.width),
                         static_cast<int>(options.layout.height), "Panwright", nullptr, nullptr);
    if (window_ == nullptr) return fail(glfw_problem);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(options.scripted ? 0 : 1);
    if (gladLoadGLContext(&gl_, glfwGetProcAddress) == 0)
      return fail("OpenGL 3.3 is not available");
    float across = 1, down = 1;
    glfwGetWindowContentScale(window_, &across, &down);
    scale_ = options.scale > 0 ? options.scale : std::max(1.0, double{across});
    start_gui(options.scripted);
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
    // values stand over the grabs of their sliders, and stay legible
    ImGui::GetStyle().Colors[ImGuiCol_SliderGrab] = {0.17f, 0.36f, 0.62f, 1};
    ImGui::GetStyle().Colors[ImGuiCol_SliderGrabActive] = {0.22f, 0.45f, 0.75f, 1};
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

  // Uploads a canvas. A pixel of an exact image is a pixel of the screen.
  void show(const Canvas& canvas, bool sample) {
    gl_.BindTexture(GL_TEXTURE_2D, textures_[sample]);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(canvas.width),
                   static_cast<GLsizei>(canvas.height), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   canvas.rgba.data());
    // without levels, mosaics of colour filters beat with the pixels of the screen
    if (canvas.smooth) gl_.GenerateMipmap(GL_TEXTURE_2D);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
                      canvas.smooth ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, canvas.smooth ? GL_LINEAR : GL_NEAREST);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl_.TexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    shows_[sample] = true;
  }

  bool screenshot(const std::filesystem::path& path, DiagnosticLog& log) {
    if (!log.files()->will_write(path, "the screenshot", log)) return false;
    if (image::image_format(path) != image::ImageFormat::png) {
      log.report(Code("E0202"), {},
                 fmt::format("screenshots are written as .png, not {}", in_quotes(path.string())));
      return false;
    }
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height));
    gl_.ReadBuffer(GL_BACK);
    gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    // rows begin at the bottom
    const std::size_t row = 4 * static_cast<std::size_t>(width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(height) / 2; ++y)
      std::swap_ranges(pixels.begin() + static_cast<std::ptrdiff_t>(y * row),
                       pixels.begin() + static_cast<std::ptrdiff_t>((y + 1) * row),
                       pixels.end() - static_cast<std::ptrdiff_t>((y + 1) * row));
    for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = 255;
    image::PngOptions options;
    options.says_srgb = true;
    const std::string file = image::png_file(static_cast<std::uint32_t>(width),
                                             static_cast<std::uint32_t>(height), pixels, options);
    return write_file(path, as_bytes(file), log);
  }

  GLFWwindow* window() const { return window_; }
  double scale() const { return scale_; }
  MainWindow::Textures textures() const {
    return {shows_[0] ? textures_[0] : 0u, shows_[1] ? textures_[1] : 0u};
  }
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

// Replaces the input by that of a script.
void apply_input(const ScriptedInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  if (input.mouse)
    io.MousePos = {static_cast<float>(input.mouse->x), static_cast<float>(input.mouse->y)};
  for (int k = 0; k < 3; ++k) io.MouseDown[k] = input.buttons[k];
  io.MouseWheel = static_cast<float>(input.wheel);
  io.KeyCtrl = input.control;
  for (bool& key : io.KeysDown) key = false;
  if (input.key > 0) io.KeysDown[input.key] = true;
  for (const char c : input.typed) io.AddInputCharacter(static_cast<unsigned char>(c));
}

void drop_files(GLFWwindow* window, int count, const char** paths) {
  static_cast<MainWindow*>(glfwGetWindowUserPointer(window))
      ->drop(std::vector<std::string>(paths, paths + count));
}

class FrameLoop {
 public:
  FrameLoop(Screen& screen, MainWindow& contents, const Options& options)
      : screen_(screen),
        contents_(contents),
        options_(options),
        runner_(options.script, options.script_folder) {}

  bool run(DiagnosticLog& log) {
    while (glfwWindowShouldClose(screen_.window()) == 0) {
      wait();
      const auto start = FrameClock::now();
      const double busy = thread_seconds();
      bool image_changed = false;
      if (const Canvas* canvas = contents_.new_canvas()) {
        screen_.show(*canvas, false);
        frames_left_ = kFramesAfter;
        image_changed = true;
      }
      if (const Canvas* canvas = contents_.new_sample_canvas()) {
        screen_.show(*canvas, true);
        frames_left_ = kFramesAfter;
      }
      frame();
      report_.spent.add(1e3 * seconds_since(start));
      report_.busy = std::max(report_.busy, 1e3 * (thread_seconds() - busy));
      if (options_.scripted && !follow(log)) break;
      screen_.swap();
      if (image_changed) measure();
      if (options_.scripted) report_.resident.add(static_cast<double>(resident_bytes()));
    }
    return runner_.ok();
  }

  Report report() const {
    Report out = report_;
    out.rendering = contents_.renderer().status();
    out.readings = contents_.project().state().readings;
    out.command = contents_.command();
    return out;
  }

 private:
  // Measures the times of an image that has reached the screen.
  void measure() {
    if (report_.first_image == 0) report_.first_image = seconds_since(begin_);
    if (const auto saved = contents_.saved_to_image()) {
      report_.saved.add(saved->shown);
      report_.last_saved = *saved;
    }
  }

  // Waits for input while nothing changes.
  void wait() {
    if (options_.scripted) return glfwPollEvents();
    const auto version = contents_.project().state().readings;
    glfwPollEvents();
    const ImGuiIO& io = ImGui::GetIO();
    const bool active = io.MouseDelta.x != 0 || io.MouseDelta.y != 0 || ImGui::IsAnyMouseDown() ||
                        io.WantTextInput || !contents_.idle() || version != readings_;
    readings_ = version;
    if (active) frames_left_ = kFramesAfter;
    if (frames_left_ > 0)
      --frames_left_;
    else
      glfwWaitEventsTimeout(kIdleWait);
  }

  void frame() {
    screen_.begin_frame();
    if (options_.scripted) apply_input(runner_.input());
    ImGui::NewFrame();
    int width = 0, height = 0;
    glfwGetWindowSize(screen_.window(), &width, &height);
    contents_.frame({width, height}, screen_.scale(), screen_.textures());
    screen_.end_frame();
  }

  // False: the script has ended or failed.
  bool follow(DiagnosticLog& log) {
    // leaves the processor to the render thread
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
    const ScriptRunner::Actions actions = runner_.next(contents_, log);
    if (actions.size)
      glfwSetWindowSize(screen_.window(), static_cast<int>(actions.size->x),
                        static_cast<int>(actions.size->y));
    // one after the other may have the same name
    log.set_files(contents_.project().inputs());
    if (!actions.screenshot.empty() && !screen_.screenshot(actions.screenshot, log)) return false;
    return !actions.end;
  }

  Screen& screen_;
  MainWindow& contents_;
  const Options& options_;
  ScriptRunner runner_;
  const FrameClock::time_point begin_ = FrameClock::now();
  Report report_;
  std::uint64_t readings_ = 0;
  int frames_left_ = kFramesAfter;
};

}  // namespace

bool run(const Options& options, DiagnosticLog& log, Report* report) {
  Screen screen;
  if (!screen.open(options, log)) return false;
  MainWindow contents(options);
  glfwSetWindowUserPointer(screen.window(), &contents);
  glfwSetDropCallback(screen.window(), drop_files);
  FrameLoop loop(screen, contents, options);
  const bool good = loop.run(log);
  if (!options.layout_file.empty()) write_layout(options.layout_file, contents.layout());
  if (report != nullptr) *report = loop.report();
  return good;
}

}  // namespace panwright::studio
