#include "firmware/mission/button_feel.hpp"

#include <algorithm>
#include <cmath>

namespace lf::mission {

void ButtonFeel::update(double dt_s, double force_n, double depth_m) {
  if (!std::isfinite(force_n) || !std::isfinite(depth_m)) return;
  filtered_n_ += started_ ? (force_n - filtered_n_) * (dt_s / (dt_s + config_.filter_s)) : force_n - filtered_n_;
  started_ = true;
  if (!touched_) {
    pushed_ = force_n > config_.touch_n ? pushed_ + 1 : 0;
    if (pushed_ == 1) {
      touch_depth_m_ = depth_m;
      touch_n_ = force_n;
    }
    touched_ = pushed_ >= debounce;
    if (!touched_) return;
  }
  travel_m_ = std::max(0.0, depth_m - touch_depth_m_ - (force_n - touch_n_) / config_.stiffness_n_m);
  highest_n_ = std::max(highest_n_, filtered_n_);
  dropped_ = travel_m_ > click_from_m && filtered_n_ < highest_n_ - config_.click_drop_n ? dropped_ + 1 : 0;
  clicked_ = clicked_ || dropped_ >= debounce;
}

}  // namespace lf::mission
