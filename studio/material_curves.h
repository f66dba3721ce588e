// Image and curves of a material, and slopes of foil, in the window.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pxn/materials.h"
#include "studio/samples.h"
#include "studio/window_state.h"

namespace panwright::studio {

// Sample of one material, beside another that is held.
class SampleView {
 public:
  explicit SampleView(WindowState& state) : state_(state) {}

  // Requests a sample of a material of the models, or of a preset. Called every frame.
  void request_material(const std::string& name);
  void request_preset(const std::string& name);
  void draw();
  // Image of the sample and of the held one, where it changed; null: it did not.
  const Canvas* new_canvas();
  void set_texture(std::uintptr_t texture) { texture_ = texture; }
  const pxn::Provenance& provenance() const { return provenance_; }  // of the preset
  bool busy() const { return samples_.busy(); }
  std::string name() const { return samples_.last() ? samples_.last()->name : ""; }

 private:
  void hold_buttons(const MaterialSample& sample);
  void plots(const MaterialSample& sample);

  WindowState& state_;
  Samples samples_;
  std::string requested_;
  pxn::Provenance provenance_;
  std::optional<MaterialSample> held_;
  Canvas canvas_;
  bool changed_ = false;  // since the last new_canvas()
  std::uintptr_t texture_ = 0;
};

// Slopes of the sheets of one foil.
class FoilSlopesView {
 public:
  explicit FoilSlopesView(WindowState& state) : state_(state) {}
  void draw(const std::string& name);

 private:
  void update(const std::string& name);

  WindowState& state_;
  SheetSlopes slopes_;
  std::string computed_for_;
};

}  // namespace panwright::studio
