#include "host_sim/app/observers/panel_observer.hpp"

#include <cmath>
#include <utility>

#include "host_sim/app/scoring.hpp"
#include "host_sim/record/cloud_file.hpp"

namespace lf::app {

void PanelObserver::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) {
    if (event.kind != Event::Kind::located || map_taken_) continue;
    if (!located_) located_ = Located{answered_, Pose::Identity(), {}, asked_poses_, std::move(asked_cloud_)};
    const auto valve = static_cast<std::size_t>(event.code);
    if (event.code >= 0 && valve < asked_valves_rad_.size()) located_->handles.push_back({valve, event.value, asked_valves_rad_[valve]});
  }
}

void PanelObserver::on_panel_request(const PanelRequest&, ImageView, std::span<const CloudPoint> cloud) {
  asked_cloud_.assign(cloud.begin(), cloud.end());
  if (world_ != nullptr) {
    asked_poses_ = world_->base_from_body();
    asked_valves_rad_.clear();
    for (std::size_t i = 0; i < world_->valve_count(); ++i) asked_valves_rad_.push_back(world_->valve_angle_rad(i));
  }
  if (files_.wanted() && !cloud.empty() && !located_) files_.write("cloud.pcd", record::pcd_bytes(cloud));
}

void PanelObserver::judge_doubt(const mission::PanelMap& map) {
  if (world_ == nullptr || !map.known() || map.base_from_panel().isApprox(newest_map_, 0)) return;
  newest_map_ = map.base_from_panel();
  const Pose& truth = world_->base_from_panel();
  worst_over_doubt_ = std::fmax(worst_over_doubt_, panel_over_doubt(newest_map_, truth, map.doubt()));
}

void PanelObserver::after_control(const mission::Mission& mission) {
  judge_doubt(mission.map());
  if (!located_ || map_taken_) return;
  located_->base_from_panel = mission.map().base_from_panel();
  map_taken_ = true;
}

}  // namespace lf::app
