#include "host_sim/app/observers/panel_observer.hpp"

#include <utility>

#include "host_sim/record/cloud_file.hpp"

namespace lf::app {

void PanelObserver::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) {
    if (event.kind != Event::Kind::located || located_) continue;
    located_ = Located{answered_, Pose::Identity(), event.value, asked_valve_rad_, asked_poses_, std::move(asked_cloud_)};
  }
}

void PanelObserver::on_panel_request(const PanelRequest&, ImageView, std::span<const CloudPoint> cloud) {
  asked_cloud_.assign(cloud.begin(), cloud.end());
  if (world_ != nullptr) {
    asked_poses_ = world_->base_from_body();
    asked_valve_rad_ = world_->valve_angle_rad();
  }
  if (files_.wanted() && !cloud.empty() && !located_) files_.write("cloud.pcd", record::pcd_bytes(cloud));
}

void PanelObserver::after_control(const mission::Mission& mission) {
  if (!located_ || map_taken_) return;
  located_->base_from_panel = mission.map().base_from_panel();
  located_->doubt = mission.map().doubt();
  map_taken_ = true;
}

}  // namespace lf::app
