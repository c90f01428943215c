// What the scene's surfaces reflect: albedo, a faint grain, and markers.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/optics/marker.hpp"
#include "host_sim/optics/surface.hpp"
#include "host_sim/optics/water.hpp"
#include "shared/scene/scene.hpp"

namespace lf::optics {

class SurfaceLook {
 public:
  // Throws InputError for an albedo outside 0..1 or a marker that is not there.
  SurfaceLook(const scene::Scene& scene, float grain);

  void set_poses(const scene::BodyPoses& base_from_body);

  // Albedo of each lane's surface, 0 where there is none. `footprint`: side of the sample's square, px.
  RgbLanes albedo(const SurfacePacket& surface, LaneMask shape, float footprint) const;

  // Which of the wanted lanes' pixels hold an edge of a mark.
  LaneMask marks_edges(const SurfacePacket& surface, LaneMask shape, LaneMask wanted) const;

 private:
  struct Look {
    Rgb albedo{};
    std::size_t body = 0;
    std::optional<Marker> marker;
    Pose body_from_shape;
    Pose shape_from_base;  // of a marker
    double top_m = 0;      // of the marker's face
  };
  Lanes grain(const SurfacePacket& surface, LaneMask shape, float footprint) const;
  // White share of the lane's square; nothing beside the marker's face.
  std::optional<float> white_share(const SurfacePacket& surface, int lane, const Look& look, float footprint) const;

  std::vector<Look> looks_;
  std::vector<float> noise_;
  float grain_;
  std::vector<Rotation> rotations_;  // one a body
  std::vector<Lanes3> positions_;
};

}  // namespace lf::optics
