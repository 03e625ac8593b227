#include "slam/io/positions/projection.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/positions/shared_data.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAxis = 6378137;  // WGS 84, metres
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

const GeodeticPoint kPlaces[] = {
    {47.3769, 8.5417, 408}, {-33.8688, 151.2093, 58}, {0, 0, 0}, {69.6, -179.99, -12}};

// Closed form: Hofmann-Wellenhof, Lichtenegger, Wasle, GNSS, 2008, 8.2.
Eigen::Vector3d Geocentric(const GeodeticPoint& point) {
  const double phi = point.latitude * kDegree;
  const double lambda = point.longitude * kDegree;
  const double n = kAxis / std::sqrt(1 - kEccentricity2 * std::sin(phi) * std::sin(phi));
  return {(n + point.height) * std::cos(phi) * std::cos(lambda),
          (n + point.height) * std::cos(phi) * std::sin(lambda),
          (n * (1 - kEccentricity2) + point.height) * std::sin(phi)};
}

Eigen::Vector3d EastNorthUp(const GeodeticPoint& origin, const GeodeticPoint& point) {
  const double phi = origin.latitude * kDegree;
  const double lambda = origin.longitude * kDegree;
  Eigen::Matrix3d axes;
  axes << -std::sin(lambda), std::cos(lambda), 0,  //
      -std::sin(phi) * std::cos(lambda), -std::sin(phi) * std::sin(lambda), std::cos(phi),
      std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi);
  return axes * (Geocentric(point) - Geocentric(origin));
}

// The transverse Mercator projection by Krueger's series, to the fourth power of n: far below a
// millimetre within a zone (Karney 2011, eq. 35).
Eigen::Vector2d Krueger(const GeodeticPoint& point, double central_meridian, bool is_south) {
  const double n = kFlattening / (2 - kFlattening);
  const double radius = kAxis / (1 + n) * (1 + n * n / 4 + n * n * n * n / 64);
  const double alpha[] = {n / 2 - 2 * n * n / 3 + 5 * n * n * n / 16 + 41 * std::pow(n, 4) / 180,
                          13 * n * n / 48 - 3 * n * n * n / 5 + 557 * std::pow(n, 4) / 1440,
                          61 * n * n * n / 240 - 103 * std::pow(n, 4) / 140,
                          49561 * std::pow(n, 4) / 161280};
  const double e = std::sqrt(kEccentricity2);
  const double s = std::sin(point.latitude * kDegree);
  const double t = std::sinh(std::atanh(s) - e * std::atanh(e * s));
  const double lambda = std::remainder(point.longitude - central_meridian, 360) * kDegree;
  const double xi = std::atan2(t, std::cos(lambda));
  const double eta = std::asinh(std::sin(lambda) / std::hypot(t, std::cos(lambda)));
  double north = xi, east = eta;
  for (int j = 1; j <= 4; ++j) {
    north += alpha[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
    east += alpha[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
  }
  return {500000 + 0.9996 * radius * east, (is_south ? 1e7 : 0) + 0.9996 * radius * north};
}

class ProjectionTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Projection::IsAvailable()) GTEST_SKIP() << "this build has no PROJ";
  }
};

TEST_F(ProjectionTest, LocalFramesAreThoseOfTheClosedForm) {
  for (const GeodeticPoint& origin : kPlaces) {
    const Projection local = Projection::Local(origin);
    EXPECT_LT(local.FromGeodetic(origin).norm(), 1e-8);
    for (const auto& [north, east, up] : {std::tuple(0.01, 0.02, 30.0), {-0.3, 0.1, -50.0}}) {
      const GeodeticPoint point{origin.latitude + north, origin.longitude + east,
                                origin.height + up};
      const Eigen::Vector3d expected = EastNorthUp(origin, point);
      EXPECT_LT((local.FromGeodetic(point) - expected).norm(), 1e-6);
      const GeodeticPoint back = local.ToGeodetic(expected);
      EXPECT_NEAR(back.latitude, point.latitude, 1e-11);
      EXPECT_NEAR(std::remainder(back.longitude - point.longitude, 360), 0, 1e-11);
      EXPECT_NEAR(back.height, point.height, 1e-6);
    }
  }
}

TEST_F(ProjectionTest, UtmIsKruegersSeries) {
  for (const GeodeticPoint& point : kPlaces) {
    const int epsg = *UtmEpsg(point);
    const double meridian = 6 * (epsg % 100) - 183;
    const Eigen::Vector2d expected = Krueger(point, meridian, epsg > 32700);
    const Eigen::Vector3d projected = Projection::Utm(epsg).FromGeodetic(point);
    EXPECT_LT((projected.head<2>() - expected).norm(), 1e-4);
    EXPECT_EQ(projected.z(), point.height);
    const GeodeticPoint back = Projection::Utm(epsg).ToGeodetic(projected);
    EXPECT_NEAR(back.latitude, point.latitude, 1e-11);
  }
}

TEST_F(ProjectionTest, UtmAgreesWithCs2cs) {
  if (!HasProgram("cs2cs")) GTEST_SKIP() << "there is no cs2cs (Debian package proj-bin)";
  for (const GeodeticPoint& point : kPlaces) {
    const int epsg = *UtmEpsg(point);
    std::ostringstream command;
    command.precision(12);
    command << "echo " << point.latitude << " " << point.longitude
            << " | cs2cs -f %.6f EPSG:4326 +to EPSG:" << epsg;
    std::istringstream line(OutputOf(command.str()));
    Eigen::Vector2d expected;
    ASSERT_TRUE(line >> expected.x() >> expected.y()) << command.str();
    EXPECT_LT((Projection::Utm(epsg).FromGeodetic(point).head<2>() - expected).norm(), 1e-5);
  }
  EXPECT_THROW(Projection::Utm(4326), ContractError);
  EXPECT_THAT(WktOfEpsg(32632), testing::StartsWith("PROJCS[\"WGS 84 / UTM zone 32N\""));
  EXPECT_THROW(WktOfEpsg(1), UserError);
}

TEST(Projection, ZonesOfUtmHaveTheirCodes) {
  EXPECT_EQ(UtmEpsg({47, 8.5, 0}), 32632);
  EXPECT_EQ(UtmEpsg({-33, 151, 0}), 32756);
  EXPECT_EQ(UtmEpsg({0, -180, 0}), 32601);
  EXPECT_EQ(UtmEpsg({0, 180, 0}), 32660);
  EXPECT_EQ(UtmEpsg({60, 5, 0}), 32632);   // Norway
  EXPECT_EQ(UtmEpsg({78, 15, 0}), 32633);  // Svalbard
  EXPECT_EQ(UtmEpsg({78, 22, 0}), 32635);
  EXPECT_FALSE(UtmEpsg({85, 0, 0}));
  EXPECT_FALSE(UtmEpsg({-81, 0, 0}));
}

}  // namespace
}  // namespace orb360
