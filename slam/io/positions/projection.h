#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace orb360 {

/// A place on Earth, WGS 84.
struct GeodeticPoint {
  double latitude = 0;   ///< Degrees north.
  double longitude = 0;  ///< Degrees east.
  double height = 0;     ///< Metres over the ellipsoid.
};

/// A map projection or local frame by PROJ. Copies share one context of PROJ, so that one thread at
/// a time may use them.
class Projection {
 public:
  /// Whether this build has PROJ.
  static bool IsAvailable();
  /// East, north and up, metres, from `origin`: a Cartesian frame whose axes are those of the
  /// ellipsoid at the origin ("topocentric", EPSG 9837). Throws UserError where this build has no
  /// PROJ.
  static Projection Local(const GeodeticPoint& origin);
  /// Easting, northing and height over the ellipsoid, metres, by the EPSG code of a zone of UTM on
  /// WGS 84 (32601 to 32660, 32701 to 32760). Throws ContractError for another code, and UserError
  /// where this build has no PROJ.
  static Projection Utm(int epsg);

  Eigen::Vector3d FromGeodetic(const GeodeticPoint& point) const;
  GeodeticPoint ToGeodetic(const Eigen::Vector3d& point) const;

 private:
  struct Transformation;
  explicit Projection(const std::string& pipeline);

  std::shared_ptr<const Transformation> transformation_;
};

/// EPSG code of the zone of UTM in which a place is, with the exceptions of Norway and Svalbard.
/// Empty outside 80° south to 84° north, where UTM is not defined.
std::optional<int> UtmEpsg(const GeodeticPoint& point);

/// The definition of a coordinate reference system as OGC WKT 1, which LAS wants. Throws UserError
/// where PROJ or its database is missing.
std::string WktOfEpsg(int epsg);

}  // namespace orb360
