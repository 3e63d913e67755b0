#include "offline/appearance/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace greenloop::offline {

struct RayScene::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  void require_right() const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw std::runtime_error("appearance: Embree failed with error " + std::to_string(error) +
                             (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
  }
};

namespace {

template <class Value>
void set_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<Value>& values) {
  void* const to = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Value), values.size());
  if (to != nullptr) std::memcpy(to, values.data(), values.size() * sizeof(Value));
}

}  // namespace

RayScene::RayScene(const LitSurface& surface) : embree_(std::make_unique<Embree>()) {
  embree_->device = rtcNewDevice("threads=1");
  embree_->require_right();
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(embree_->scene, RTC_BUILD_QUALITY_HIGH);
  const RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  set_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, surface.positions);
  set_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, surface.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  embree_->require_right();
}

RayScene::~RayScene() = default;

std::optional<RayHit> RayScene::first_hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                                          float near) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  ray.ray.org_x = origin.x();
  ray.ray.org_y = origin.y();
  ray.ray.org_z = origin.z();
  ray.ray.dir_x = direction.x();
  ray.ray.dir_y = direction.y();
  ray.ray.dir_z = direction.z();
  ray.ray.tnear = near;
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Eigen::Vector3f normal(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  return RayHit{ray.hit.primID, ray.hit.u, ray.hit.v, normal.dot(direction) < 0};
}

}  // namespace greenloop::offline
