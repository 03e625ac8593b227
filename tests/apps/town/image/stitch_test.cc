#include "apps/town/image/stitch.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <omp.h>

namespace orb360::town {
namespace {

constexpr int kSize = 96;
const EquirectangularCamera kCamera(256, 128);

/// A colour that changes smoothly over the sphere, in all channels.
cv::Vec3b Smooth(const Eigen::Vector3d& bearing) {
  const auto level = [](double x) { return cv::saturate_cast<uint8_t>(127.5 + 120 * x); };
  return {level(bearing.x()), level(bearing.y()), level(bearing.z())};
}

/// The direction through a face's pixel in the frame of the panorama, 1 along the face's axis.
Eigen::Vector3d FaceRay(int face, int row, int column) {
  return CameraFromFace(face) *
         Eigen::Vector3d(-1, 2 * (column + 0.5) / kSize - 1, 1 - 2 * (row + 0.5) / kSize);
}

template <typename Pixel, typename Function>
CubeImages<Pixel> PaintFaces(const Function& paint) {
  CubeImages<Pixel> faces;
  for (int face = 0; face < kCubeFaces; ++face) {
    cv::Mat_<Pixel> image(kSize, kSize);
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column)
        image(row, column) = paint(FaceRay(face, row, column));
    }
    faces[static_cast<size_t>(face)] = image;
  }
  return faces;
}

TEST(MeetCube, FindsThePointThatAFacesRayGoesThrough) {
  for (int face = 0; face < kCubeFaces; ++face) {
    for (const double right : {-0.9, 0.1, 0.7}) {
      for (const double up : {-0.8, 0.0, 0.95}) {
        const CubePoint point =
            MeetCube(3.7 * (CameraFromFace(face) * Eigen::Vector3d(-1, right, up)));
        EXPECT_EQ(point.face, face);
        EXPECT_NEAR(point.right, right, 1e-12);
        EXPECT_NEAR(point.up, up, 1e-12);
      }
    }
  }
}

TEST(MeetCube, FacesLookWhereTheirNamesSay) {
  EXPECT_EQ(MeetCube({-1, 0, 0}).face, kFront);  // the camera looks along -x, y to the right
  EXPECT_EQ(MeetCube({0, 1, 0}).face, kRight);
  EXPECT_EQ(MeetCube({0, 0, 1}).face, kUp);
  // The lower side of `up` joins the front, so does the upper side of `down`.
  EXPECT_LT(MeetCube({-0.5, 0, 1}).up, 0);
  EXPECT_GT(MeetCube({-0.5, 0, -1}).up, 0);
}

TEST(StitchColour, ShowsTheSphereTheFacesWerePaintedFromWithoutSeams) {
  const cv::Mat3b panorama = StitchColour(
      PaintFaces<cv::Vec3b>([](const Eigen::Vector3d& ray) { return Smooth(ray.normalized()); }),
      kCamera);
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      const cv::Vec3b truth = Smooth(kCamera.Bearing({column + 0.5, row + 0.5}));
      for (int channel = 0; channel < 3; ++channel) {
        ASSERT_NEAR(panorama(row, column)[channel], truth[channel], 2)
            << row << ' ' << column << ' ' << channel;
      }
    }
  }
}

TEST(StitchRadiance, IsAsGoodAtTheBordersOfFacesAsWithinThem) {
  // Waves of about eight pixels of a face.
  const auto waves = [](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d bearing = 40 * ray.normalized();
    return cv::Vec3f(static_cast<float>(std::sin(bearing.x())),
                     static_cast<float>(std::sin(bearing.y())),
                     static_cast<float>(std::sin(bearing.z())));
  };
  const EquirectangularCamera camera(512, 256);
  const cv::Mat3f panorama = StitchRadiance(PaintFaces<cv::Vec3f>(waves), camera);
  double squares[2] = {0, 0};
  int counts[2] = {0, 0};
  for (int row = 0; row < panorama.rows; ++row) {
    for (int column = 0; column < panorama.cols; ++column) {
      const Eigen::Vector3d bearing = camera.Bearing({column + 0.5, row + 0.5});
      const CubePoint point = MeetCube(bearing);
      const double to_border = 1 - std::max(std::abs(point.right), std::abs(point.up));
      const int at_border = to_border < 1.0 / kSize ? 1 : 0;  // the outer half of the last pixel
      squares[at_border] += cv::norm(panorama(row, column), waves(bearing), cv::NORM_L2SQR);
      ++counts[at_border];
    }
  }
  const double within = std::sqrt(squares[0] / (3 * counts[0]));
  EXPECT_LT(within, 0.1);
  EXPECT_LT(std::sqrt(squares[1] / (3 * counts[1])), within);  // pixels are smaller there
}

TEST(StitchColour, AveragesFacesThatAreFinerThanThePanorama) {
  CubeImages<cv::Vec3b> faces;
  for (cv::Mat3b& face : faces) {
    face.create(kSize, kSize);
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column)
        face(row, column) = cv::Vec3b::all((row + column) % 2 == 0 ? 40 : 200);
    }
  }
  const cv::Mat3b panorama = StitchColour(faces, EquirectangularCamera(32, 16));
  double least = 0;
  double most = 0;
  cv::minMaxLoc(panorama.reshape(1), &least, &most);
  EXPECT_GT(least, 105);
  EXPECT_LT(most, 135);
}

TEST(StitchRange, IsExactForPlanesUpToTheBordersOfTheFaces) {
  // Inside a room, not in its middle: each ray meets the nearest of six walls.
  const Eigen::Vector3d low(-4, -3, -1.6);
  const Eigen::Vector3d high(7, 5, 4);
  const auto room = [&](const Eigen::Vector3d& d) {
    double t = 1e30;
    for (int i = 0; i < 3; ++i) t = std::min(t, (d[i] > 0 ? high[i] : low[i]) / d[i]);
    return t;
  };
  const cv::Mat1f range = StitchRange(
      PaintFaces<float>([&](const Eigen::Vector3d& ray) { return static_cast<float>(room(ray)); }),
      kCamera);
  int exact = 0;
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const double truth = room(kCamera.Bearing({column + 0.5, row + 0.5}));
      ASSERT_NEAR(range(row, column), truth, 0.05 * truth) << row << ' ' << column;
      exact += std::abs(range(row, column) - truth) < 1e-4 * truth ? 1 : 0;
    }
  }
  // All but the pixels where two walls meet.
  EXPECT_GT(exact, 0.9 * 256 * 128);
}

TEST(StitchRange, NeverMixesWhatIsNearWithWhatIsFarOrNothing) {
  const cv::Mat1f range = StitchRange(PaintFaces<float>([](const Eigen::Vector3d& ray) {
                                        const double turn = std::atan2(ray.y(), ray.x());
                                        if (std::sin(9 * turn) > 0)
                                          return ray.z() > 0.2 ? 2.0F : 2.04F;
                                        return ray.z() > 0 ? 0.0F : 50.0F;
                                      }),
                                      kCamera);
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const CubePoint point = MeetCube(kCamera.Bearing({column + 0.5, row + 0.5}));
      const double z =
          range(row, column) / std::sqrt(1 + point.right * point.right + point.up * point.up);
      EXPECT_TRUE(std::abs(z - 2) < 1e-4 || std::abs(z - 2.04) < 1e-4 || std::abs(z - 50) < 1e-3 ||
                  z == 0)
          << z;
    }
  }
}

TEST(StitchRange, FollowsTheNearestSurfaceAtTheEdgeOfASlopingOne) {
  // Terraces around the camera, 1.2 and 1.6 m below it.
  const auto terrace = [](double height, const Eigen::Vector3d& ray) { return -height / ray.z(); };
  const cv::Mat1f range =
      StitchRange(PaintFaces<float>([&](const Eigen::Vector3d& ray) {
                    if (ray.z() >= 0) return 0.0F;
                    return static_cast<float>(terrace(std::sin(20 * ray.z()) > 0 ? 1.2 : 1.6, ray));
                  }),
                  kCamera);
  int exact = 0;
  int steep = 0;
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      if (bearing.z() > -0.3) continue;
      const double error = std::min(std::abs(range(row, column) / terrace(1.2, bearing) - 1),
                                    std::abs(range(row, column) / terrace(1.6, bearing) - 1));
      ASSERT_LT(error, 0.04) << row << ' ' << column;  // half a pixel of slope
      ++steep;
      exact += error < 1e-4 ? 1 : 0;
    }
  }
  EXPECT_GT(exact, 0.9 * steep);
}

TEST(DecodeDepth24, ReadsTheBytesFromRedToBlue) {
  cv::Mat3b image(1, 3);
  image(0, 0) = {0, 0, 1};    // blue, green, red
  image(0, 1) = {128, 3, 7};  // 7 + 3 * 256 + 128 * 65536
  image(0, 2) = {255, 255, 255};
  const cv::Mat1f depth = DecodeDepth24(image, 1000);
  EXPECT_NEAR(depth(0, 0), 1000.0 / 16777215, 1e-9);
  EXPECT_NEAR(depth(0, 1), 1000.0 * (7 + 3 * 256 + 128 * 65536) / 16777215, 1e-4);
  EXPECT_EQ(depth(0, 2), 0);
}

TEST(Stitch, GivesTheSameBytesForAnyNumberOfThreads) {
  const CubeImages<cv::Vec3b> faces =
      PaintFaces<cv::Vec3b>([](const Eigen::Vector3d& ray) { return Smooth(ray.normalized()); });
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const cv::Mat3b one = StitchColour(faces, kCamera);
  omp_set_num_threads(2);
  EXPECT_EQ(cv::norm(one, StitchColour(faces, kCamera), cv::NORM_INF), 0);
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace orb360::town
