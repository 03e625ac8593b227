#include "slam/io/positions/projection.h"

#include <algorithm>
#include <cmath>

#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

#ifdef ORB360_HAS_PROJ
#include <proj.h>
#endif

namespace orb360 {
namespace {

constexpr int kUtmNorth = 32600;
constexpr int kUtmSouth = 32700;

}  // namespace

std::optional<int> UtmEpsg(const GeodeticPoint& point) {
  const double latitude = point.latitude;
  const double longitude = std::remainder(point.longitude, 360.0);
  if (!(latitude >= -80 && latitude <= 84)) return std::nullopt;
  int zone = std::clamp(static_cast<int>(std::floor((longitude + 180) / 6)) + 1, 1, 60);
  if (latitude >= 56 && latitude < 64 && longitude >= 3 && longitude < 12) zone = 32;
  if (latitude >= 72 && longitude >= 0 && longitude < 42) {
    zone = longitude < 9 ? 31 : longitude < 21 ? 33 : longitude < 33 ? 35 : 37;
  }
  return (latitude < 0 ? kUtmSouth : kUtmNorth) + zone;
}

Projection Projection::Local(const GeodeticPoint& origin) {
  return Projection("+step +proj=cart +ellps=WGS84 +step +proj=topocentric +ellps=WGS84 +lat_0=" +
                    ToText(origin.latitude) + " +lon_0=" + ToText(origin.longitude) +
                    " +h_0=" + ToText(origin.height));
}

Projection Projection::Utm(int epsg) {
  const bool is_south = epsg > kUtmSouth;
  const int zone = epsg - (is_south ? kUtmSouth : kUtmNorth);
  ORB360_CHECK(zone >= 1 && zone <= 60, epsg);
  return Projection("+step +proj=utm +ellps=WGS84 +zone=" + std::to_string(zone) +
                    (is_south ? " +south" : ""));
}

#ifdef ORB360_HAS_PROJ

bool Projection::IsAvailable() { return true; }

namespace {

struct DestroyContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct Destroy {
  void operator()(PJ* transformation) const { proj_destroy(transformation); }
};
using Context = std::unique_ptr<PJ_CONTEXT, DestroyContext>;

/// A context that writes nothing to standard error and does not use the network.
Context MakeContext() {
  Context context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  return context;
}

}  // namespace

struct Projection::Transformation {
  Context context = MakeContext();
  std::unique_ptr<PJ, Destroy> pipeline;
};

Projection::Projection(const std::string& pipeline) {
  auto transformation = std::make_shared<Transformation>();
  const std::string text =
      "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad " + pipeline;
  transformation->pipeline.reset(proj_create(transformation->context.get(), text.c_str()));
  ORB360_CHECK(transformation->pipeline != nullptr, text);
  transformation_ = std::move(transformation);
}

Eigen::Vector3d Projection::FromGeodetic(const GeodeticPoint& point) const {
  const PJ_COORD result = proj_trans(transformation_->pipeline.get(), PJ_FWD,
                                     proj_coord(point.longitude, point.latitude, point.height, 0));
  return {result.xyz.x, result.xyz.y, result.xyz.z};
}

GeodeticPoint Projection::ToGeodetic(const Eigen::Vector3d& point) const {
  const PJ_COORD result = proj_trans(transformation_->pipeline.get(), PJ_INV,
                                     proj_coord(point.x(), point.y(), point.z(), 0));
  return {result.lpz.phi, result.lpz.lam, result.lpz.z};
}

std::string WktOfEpsg(int epsg) {
  const Context context = MakeContext();
  const std::unique_ptr<PJ, Destroy> crs(
      proj_create(context.get(), ("EPSG:" + std::to_string(epsg)).c_str()));
  const char* const options[] = {"MULTILINE=NO", nullptr};
  const char* wkt = crs ? proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, options) : nullptr;
  if (wkt == nullptr) {
    throw UserError("EPSG:" + std::to_string(epsg) +
                    " is not in the database of PROJ, or that is missing; install proj-data");
  }
  return wkt;
}

#else

bool Projection::IsAvailable() { return false; }

namespace {

[[noreturn]] void RefuseWithoutProj() {
  throw UserError(
      "this orb360 was built without PROJ, which places results on Earth; install libproj-dev and "
      "build it with -DORB360_WITH_PROJ=ON");
}

}  // namespace

struct Projection::Transformation {};
Projection::Projection(const std::string&) { RefuseWithoutProj(); }
Eigen::Vector3d Projection::FromGeodetic(const GeodeticPoint&) const { RefuseWithoutProj(); }
GeodeticPoint Projection::ToGeodetic(const Eigen::Vector3d&) const { RefuseWithoutProj(); }
std::string WktOfEpsg(int) { RefuseWithoutProj(); }

#endif

}  // namespace orb360
