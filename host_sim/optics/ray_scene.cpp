#include "host_sim/optics/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <stdexcept>
#include <string>

#include "host_sim/optics/tessellation.hpp"

namespace lf::optics {
namespace {

// The whole packet is always traced with all lanes defined: Debian's build asserts on uninitialised ones.
constexpr RTCIntersectContext make_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context{};
  context.flags = flags;
  context.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return context;
}

void check(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) throw std::runtime_error(std::string("Embree: ") + what + " failed with error " + std::to_string(error));
}

RTCGeometry make_geometry(RTCDevice device, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_m.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  check(device, "making a geometry");
  std::memcpy(vertices, mesh.vertices_m.data(), mesh.vertices_m.size() * 3 * sizeof(float));
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * 3 * sizeof(std::uint32_t));
  rtcCommitGeometry(geometry);
  return geometry;
}

template <class Rays>
void set_rays(Rays& rays, const Lanes3& origin, const Lanes3& direction, Lanes near, Lanes far) {
  store_lanes(rays.org_x, origin.x), store_lanes(rays.org_y, origin.y), store_lanes(rays.org_z, origin.z);
  store_lanes(rays.dir_x, direction.x), store_lanes(rays.dir_y, direction.y), store_lanes(rays.dir_z, direction.z);
  store_lanes(rays.tnear, near), store_lanes(rays.tfar, far);
  for (int i = 0; i < lane_count; ++i) rays.mask[i] = 0xFFFFFFFFu;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCGeometry> instances;  // one a body; nullptr: it has no shape here
  std::vector<std::int32_t> first_shape;
  std::vector<Rotation> rotations;

  ~Impl() {
    for (RTCGeometry instance : instances) {
      if (instance != nullptr) rtcReleaseGeometry(instance);
    }
    if (top != nullptr) rtcReleaseScene(top);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add_body(std::size_t body, const scene::Body& description) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    bool empty = true;
    for (std::size_t i = 0; i < description.shapes.size(); ++i) {
      if (!description.shapes[i].visible) continue;
      const TriangleMesh mesh = tessellate(description.shapes[i]);
      if (mesh.triangles.empty()) continue;
      RTCGeometry geometry = make_geometry(device, mesh);
      rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(i));
      rtcReleaseGeometry(geometry);
      empty = false;
    }
    if (!empty) {
      rtcCommitScene(scene);
      instances[body] = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(instances[body], scene);
      rtcAttachGeometryByID(top, instances[body], static_cast<unsigned>(body));
    }
    rtcReleaseScene(scene);
  }

  // Normals come in the body's frame: turned into the base frame, to unit length and against the ray.
  void finish_normals(const RTCHit8& hit, const Lanes3& direction, HitPacket& out) const {
    const Lanes3 local(load_lanes(hit.Ng_x), load_lanes(hit.Ng_y), load_lanes(hit.Ng_z));
    Lanes3 normal;
    LaneMask bodies, geometries;
    std::memcpy(&bodies, hit.instID[0], sizeof bodies);
    std::memcpy(&geometries, hit.geomID, sizeof geometries);
    out.shape = LaneMask{} - 1;
    visit_values(bodies, [&](std::int32_t body, LaneMask lanes) {
      if (body < 0) return;  // RTC_INVALID_GEOMETRY_ID: nothing was met
      normal = select(lanes, rotations[static_cast<std::size_t>(body)] * local, normal);
      out.shape = lanes ? first_shape[static_cast<std::size_t>(body)] + geometries : out.shape;
    });
    const Lanes length = max(norm(normal), all_lanes(1e-30f));
    const Lanes sign = dot(normal, direction) > 0 ? -1.f / length : 1.f / length;
    out.normal = normal * sign;
  }
};

RayScene::RayScene(const scene::Scene& scene, const std::function<bool(const scene::Body&)>& has) : impl_(std::make_unique<Impl>()) {
  // One thread builds (two milliseconds); 16-wide coherent occlusion was seen to hang on AVX-512, so AVX2 with packets of eight.
  impl_->device = rtcNewDevice("isa=avx2,threads=1,user_threads=1");
  if (impl_->device == nullptr) throw std::runtime_error("Embree: no device (does this processor have AVX2?)");
  impl_->top = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->top, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  impl_->instances.resize(scene.size());
  impl_->first_shape.resize(scene.size());
  impl_->rotations.resize(scene.size());
  std::int32_t shapes = 0;
  for (std::size_t body = 0; body < scene.size(); ++body) {
    impl_->first_shape[body] = shapes;
    shapes += static_cast<std::int32_t>(scene[body].shapes.size());
    if (has(scene[body])) impl_->add_body(body, scene[body]);
  }
  set_poses(scene::poses_at_origin(scene));
  check(impl_->device, "building the scene");
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

void RayScene::set_poses(const scene::BodyPoses& base_from_body) {
  for (std::size_t body = 0; body < impl_->instances.size(); ++body) {
    impl_->rotations[body] = Rotation(base_from_body[body].linear());
    if (impl_->instances[body] == nullptr) continue;
    const Eigen::Matrix<float, 3, 4> transform = base_from_body[body].matrix().topRows<3>().cast<float>();
    rtcSetGeometryTransform(impl_->instances[body], 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(impl_->instances[body]);
  }
  rtcCommitScene(impl_->top);
}

HitPacket RayScene::intersect(const Lanes3& origin, const Lanes3& direction, float near, Lanes far) const {
  alignas(32) RTCRayHit8 query{};
  alignas(32) static constexpr int valid[lane_count] = {-1, -1, -1, -1, -1, -1, -1, -1};
  set_rays(query.ray, origin, direction, all_lanes(near), far);
  for (int i = 0; i < lane_count; ++i) query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersect8(valid, impl_->top, &context, &query);
  HitPacket out;
  out.parameter = load_lanes(query.ray.tfar);
  impl_->finish_normals(query.hit, direction, out);
  return out;
}

LaneMask RayScene::occluded(LaneMask wanted, const Lanes3& origin, const Lanes3& direction, Lanes far) const {
  alignas(32) RTCRay8 rays{};
  alignas(32) int valid[lane_count];
  std::memcpy(valid, &wanted, sizeof valid);
  set_rays(rays, origin, direction, Lanes{}, far);
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcOccluded8(valid, impl_->top, &context, &rays);
  return wanted & (load_lanes(rays.tfar) < 0);  // Embree marks an occluded ray with tfar = -inf
}

}  // namespace lf::optics
