#include "trace/embree.h"

#include "base/error.h"

#if defined(QUINCUNX_HAS_EMBREE)

#include <algorithm>

#include <dlfcn.h>
#include <embree3/rtcore.h>

#include "base/check.h"
#include "trace/slabs.h"
#include "trace/triangle_filter.h"
#include "trace/triangle_items.h"

namespace quincunx {
namespace {

/// The library, loaded at the first use, so that the program starts without it.
struct Library {
    decltype(&rtcNewDevice) newDevice = nullptr;
    decltype(&rtcNewScene) newScene = nullptr;
    decltype(&rtcReleaseScene) releaseScene = nullptr;
    decltype(&rtcSetSceneFlags) setSceneFlags = nullptr;
    decltype(&rtcCommitScene) commitScene = nullptr;
    decltype(&rtcNewGeometry) newGeometry = nullptr;
    decltype(&rtcReleaseGeometry) releaseGeometry = nullptr;
    decltype(&rtcSetGeometryUserPrimitiveCount) setPrimitiveCount = nullptr;
    decltype(&rtcSetGeometryUserData) setUserData = nullptr;
    decltype(&rtcSetGeometryBoundsFunction) setBounds = nullptr;
    decltype(&rtcSetGeometryIntersectFunction) setIntersect = nullptr;
    decltype(&rtcSetGeometryOccludedFunction) setOccluded = nullptr;
    decltype(&rtcCommitGeometry) commitGeometry = nullptr;
    decltype(&rtcAttachGeometry) attachGeometry = nullptr;
    decltype(&rtcIntersect1) intersect1 = nullptr;
    decltype(&rtcOccluded1) occluded1 = nullptr;
    bool complete = false;

    /// One for the whole program, since each has threads of its own.
    RTCDevice device = nullptr;

    static const Library& get() {
        static const Library library = load();
        return library;
    }

  private:
    static Library load() {
        Library library;
        void* const handle = dlopen("libembree3.so.3", RTLD_NOW | RTLD_LOCAL);
        if (!handle)
            return library;
        bool complete = true;
        const auto find = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(handle, name));
            complete = complete && function != nullptr;
        };
        find(library.newDevice, "rtcNewDevice");
        find(library.newScene, "rtcNewScene");
        find(library.releaseScene, "rtcReleaseScene");
        find(library.setSceneFlags, "rtcSetSceneFlags");
        find(library.commitScene, "rtcCommitScene");
        find(library.newGeometry, "rtcNewGeometry");
        find(library.releaseGeometry, "rtcReleaseGeometry");
        find(library.setPrimitiveCount, "rtcSetGeometryUserPrimitiveCount");
        find(library.setUserData, "rtcSetGeometryUserData");
        find(library.setBounds, "rtcSetGeometryBoundsFunction");
        find(library.setIntersect, "rtcSetGeometryIntersectFunction");
        find(library.setOccluded, "rtcSetGeometryOccludedFunction");
        find(library.commitGeometry, "rtcCommitGeometry");
        find(library.attachGeometry, "rtcAttachGeometry");
        find(library.intersect1, "rtcIntersect1");
        find(library.occluded1, "rtcOccluded1");
        if (complete)
            library.device = library.newDevice(nullptr);
        library.complete = library.device != nullptr;
        return library;
    }
};

class Embree : public Accelerator {
  public:
    explicit Embree(TriangleView triangles)
        : library_(Library::get()), triangles_(triangles), items_(detail::itemsOf(triangles)) {
        for (const detail::BvhItem& item : items_)
            box_.extend(Bounds{item.min, item.max});
        const glm::vec3 size = box_.max - box_.min;
        longest_ = items_.empty() ? 0 : std::max({size.x, size.y, size.z});
        scene_ = library_.newScene(library_.device);
        library_.setSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = library_.newGeometry(library_.device, RTC_GEOMETRY_TYPE_USER);
        library_.setPrimitiveCount(geometry, static_cast<unsigned>(items_.size()));
        library_.setUserData(geometry, this);
        library_.setBounds(geometry, bounds, nullptr);
        library_.setIntersect(geometry, intersect);
        library_.setOccluded(geometry, meet);
        library_.commitGeometry(geometry);
        library_.attachGeometry(scene_, geometry);
        library_.releaseGeometry(geometry);
        library_.commitScene(scene_);
    }
    ~Embree() override { library_.releaseScene(scene_); }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    std::optional<AcceleratorHit> nearest(const Ray& ray, RayInterval interval,
                                          TraversalCounts* counts) const override {
        detail::NearestHit nearest(ray, interval);
        Query query(ray, interval, box_);
        query.nearest = &nearest;
        if (!isUsable(ray) || !(interval.tMin <= interval.tMax)) {
            // nothing to be found
        } else if (query.filter && suits(ray)) {
            RTCRayHit rayHit{};
            rayHit.ray = rayOf(ray, interval);
            rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            library_.intersect1(scene_, &query.context, &rayHit);
        } else {
            for (const detail::BvhItem& item : items_)
                nearest.test(triangles_[item.index], item.index);
            query.tests = items_.size();
        }
        if (counts)
            *counts += {1, 0, query.tests};
        return nearest.hit();
    }

    bool occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const override {
        detail::AnyHit any(ray, interval);
        Query query(ray, interval, box_);
        query.any = &any;
        if (!isUsable(ray) || !(interval.tMin <= interval.tMax)) {
            // nothing to be found
        } else if (query.filter && suits(ray)) {
            RTCRay embreeRay = rayOf(ray, interval);
            library_.occluded1(scene_, &query.context, &embreeRay);
        } else {
            for (std::size_t i = 0; i < items_.size() && !query.found; ++i) {
                query.found = any.test(triangles_[items_[i].index]);
                ++query.tests;
            }
        }
        if (counts)
            *counts += {1, 0, query.tests};
        return query.found;
    }

    /// Without what Embree keeps to itself.
    std::size_t memoryBytes() const override { return items_.capacity() * sizeof(detail::BvhItem); }

  private:
    /// What a callback gets to see of its ray. `context` comes first: Embree hands on its address.
    struct Query {
        Query(const Ray& ray, RayInterval interval, const Bounds& box)
            : filter(detail::filterRay(ray, interval, box)),
              tMin(detail::filterMin(interval.tMin)),
              tMax(detail::filterMax(interval.tMax)) {
            rtcInitIntersectContext(&context);
        }
        RTCIntersectContext context;
        std::optional<detail::FilterRay<float>> filter;
        float tMin;
        float tMax;
        detail::NearestHit* nearest = nullptr;
        detail::AnyHit* any = nullptr;
        bool found = false;
        std::uint64_t tests = 0;
    };

    /// See the header.
    bool suits(const Ray& ray) const {
        const glm::vec3 d = glm::abs(ray.direction);
        const float along = std::max({d.x, d.y, d.z});
        const glm::vec3 away = glm::max(glm::abs(box_.min - ray.origin), glm::abs(box_.max - ray.origin));
        return along >= 0x1p-10f && along <= 0x1p30f &&
               std::max({away.x, away.y, away.z}) <= 0x1p12f * longest_;
    }

    static RTCRay rayOf(const Ray& ray, RayInterval interval) {
        RTCRay result{};
        result.org_x = ray.origin.x;
        result.org_y = ray.origin.y;
        result.org_z = ray.origin.z;
        result.dir_x = ray.direction.x;
        result.dir_y = ray.direction.y;
        result.dir_z = ray.direction.z;
        result.tnear = detail::filterMin(interval.tMin);
        result.tfar = detail::filterMax(interval.tMax);
        result.mask = ~0u;
        return result;
    }

    static void bounds(const RTCBoundsFunctionArguments* arguments) {
        const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
        const detail::BvhItem& item = self.items_[arguments->primID];
        const glm::vec3 room =
            0x1p-20f * glm::max(glm::abs(item.min), glm::abs(item.max)) + 0x1p-24f * self.longest_;
        const glm::vec3 low = item.min - room;
        const glm::vec3 high = item.max + room;
        *arguments->bounds_o = {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
    }

    static void intersect(const RTCIntersectFunctionNArguments* arguments) {
        QX_CHECK_EQ(arguments->N, 1u);
        if (arguments->valid[0] == 0)
            return;
        const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
        auto& query = *reinterpret_cast<Query*>(arguments->context);
        const std::uint32_t index = self.items_[arguments->primID].index;
        const Triangle triangle = self.triangles_[index];
        ++query.tests;
        if (!detail::mayHit(*query.filter, triangle, query.tMin, query.tMax))
            return;
        query.nearest->test(triangle, index);
        if (!query.nearest->hit())
            return;
        query.tMax = detail::filterMax(query.nearest->tMax());
        auto& rayHit = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
        rayHit.ray.tfar = query.tMax;
        rayHit.hit.geomID = arguments->geomID;
        rayHit.hit.primID = arguments->primID;
    }

    static void meet(const RTCOccludedFunctionNArguments* arguments) {
        QX_CHECK_EQ(arguments->N, 1u);
        if (arguments->valid[0] == 0)
            return;
        const auto& self = *static_cast<const Embree*>(arguments->geometryUserPtr);
        auto& query = *reinterpret_cast<Query*>(arguments->context);
        const Triangle triangle = self.triangles_[self.items_[arguments->primID].index];
        ++query.tests;
        if (!detail::mayHit(*query.filter, triangle, query.tMin, query.tMax) || !query.any->test(triangle))
            return;
        query.found = true;
        reinterpret_cast<RTCRay*>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
    }

    const Library& library_;
    TriangleView triangles_;
    detail::HugeVector<detail::BvhItem> items_;
    Bounds box_;
    float longest_ = 0;  ///< of its sides
    RTCScene scene_ = nullptr;
};

}  // namespace

bool isEmbreeAvailable() {
    return Library::get().complete;
}

std::unique_ptr<Accelerator> makeEmbree(TriangleView triangles) {
    if (!isEmbreeAvailable())
        throw EnvironmentError("libembree3.so.3 cannot be loaded", {}, "choose another structure");
    return std::make_unique<Embree>(triangles);
}

}  // namespace quincunx

#else

namespace quincunx {

bool isEmbreeAvailable() {
    return false;
}

std::unique_ptr<Accelerator> makeEmbree(TriangleView) {
    throw EnvironmentError("this program was built without Embree", {}, "choose another structure");
}

}  // namespace quincunx

#endif
