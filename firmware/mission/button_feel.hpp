// What a press felt like: where the finger met something, how far that went in, whether it clicked, and where the way ended.
//
// The force is that of the drives along the press, over free motion's. A button that works meets the finger with its preload, goes in, drops its force as it
// clicks, and bottoms. What gives way only as the arm itself does has not moved. All of it is seen while pressing, at the speed of a press; depths are the
// tip's, by the joints, so that where the panel was believed to be does not matter.
#pragma once

namespace lf::mission {

class ButtonFeel {
 public:
  struct Config {
    // 1 sigma of the force is 0.3 N, and free motion's drifts by 1 N over a press. A button's preload is 5.
    double touch_n = 3.0;
    // What the arm gives way by at the tool while it presses: 3 mm at 60 N.
    double stiffness_n_m = 20'000;
    // Of the filtered force, below its highest so far. The default button drops 3 N, of which its spring and the filter leave 1.3.
    double click_drop_n = 0.6;
    double filter_s = 0.016;
  };

  ButtonFeel() = default;
  explicit ButtonFeel(const Config& config) : config_(config) {}

  // One SYNC of `dt_s`: the force along the press, and the tip's depth below the face where it should be.
  void update(double dt_s, double force_n, double depth_m);

  bool touched() const { return touched_; }
  double touch_depth_m() const { return touch_depth_m_; }
  // How far in since the touch, less what the arm gives way by. 0 before.
  double travel_m() const { return travel_m_; }
  bool clicked() const { return clicked_; }

 private:
  // 12 ms in a row: no single outlier is a touch, nor a click.
  static constexpr int debounce = 3;
  // A click comes on the way in, not at its beginning, where the finger's impact swings.
  static constexpr double click_from_m = 0.0015;

  Config config_;
  bool started_ = false, touched_ = false, clicked_ = false;
  double filtered_n_ = 0, touch_n_ = 0, touch_depth_m_ = 0, highest_n_ = 0, travel_m_ = 0;
  int pushed_ = 0, dropped_ = 0;  // in a row
};

}  // namespace lf::mission
