#include "slam/io/sparse_file.h"

#include <array>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "nn/base/hdf5_handle.h"
#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr const char* kImage = "image";
constexpr const char* kRange = "range";
constexpr const char* kConfidence = "confidence";
constexpr const char* kFrameIndex = "frame_index";
constexpr const char* kTimestamp = "timestamp";
constexpr const char* kPose = "world_from_camera";

// Access properties of a file that exists in memory only (core driver of HDF5).
Hdf5Handle MemoryFileAccess() {
  constexpr size_t kGrowth = 1 << 20;  // bytes
  Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kGrowth, /*backing_store=*/0);
  return access;
}

bool WriteArray(hid_t file, const char* name, hid_t type, const std::vector<hsize_t>& dims,
                const void* data) {
  constexpr unsigned kCompression = 4;  // deflate; sparse images become tiny
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);  // the same data gives the same bytes
  std::vector<hsize_t> chunk = dims;
  chunk[0] = std::min<hsize_t>(chunk[0], 64);
  H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_deflate(creation.get(), kCompression);
  const Hdf5Handle set(
      H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
      H5Dclose);
  return set.is_valid() && H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
}

bool WriteAttribute(hid_t file, const char* name, hid_t type, hsize_t count, const void* data) {
  const Hdf5Handle space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr),
                         H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(file, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  return attribute.is_valid() && H5Awrite(attribute.get(), type, data) >= 0;
}

std::string Encode(const SparseSample& sample) {
  const Hdf5Handle access = MemoryFileAccess();
  const Hdf5Handle file(H5Fcreate("sample", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  cv::Mat rgb;
  cv::cvtColor(sample.image, rgb, cv::COLOR_BGR2RGB);
  const hsize_t height = rgb.rows;
  const hsize_t width = rgb.cols;
  const Eigen::Vector3d& t = sample.world_from_camera.translation;
  const Eigen::Quaterniond& q = sample.world_from_camera.rotation;
  const std::array<double, 7> pose = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  const bool ok =
      file.is_valid() &&
      WriteArray(file.get(), kImage, H5T_NATIVE_UINT8, {height, width, 3}, rgb.data) &&
      WriteArray(file.get(), kRange, H5T_NATIVE_FLOAT, {height, width}, sample.sparse.range.data) &&
      WriteArray(file.get(), kConfidence, H5T_NATIVE_FLOAT, {height, width},
                 sample.sparse.confidence.data) &&
      WriteAttribute(file.get(), kFrameIndex, H5T_NATIVE_INT, 1, &sample.frame_index) &&
      WriteAttribute(file.get(), kTimestamp, H5T_NATIVE_DOUBLE, 1, &sample.timestamp) &&
      WriteAttribute(file.get(), kPose, H5T_NATIVE_DOUBLE, pose.size(), pose.data()) &&
      H5Fflush(file.get(), H5F_SCOPE_LOCAL) >= 0;
  ORB360_CHECK(ok);
  std::string bytes(static_cast<size_t>(H5Fget_file_image(file.get(), nullptr, 0)), '\0');
  ORB360_CHECK(H5Fget_file_image(file.get(), bytes.data(), bytes.size()) >= 0);
  return bytes;
}

// Reads a dataset if it exists and has the given dimensions.
bool ReadArray(hid_t file, const char* name, hid_t type, const std::vector<hsize_t>& dims,
               void* data) {
  const Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  if (!set.is_valid()) return false;
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  std::vector<hsize_t> found(dims.size());
  if (H5Sget_simple_extent_ndims(space.get()) != static_cast<int>(dims.size())) return false;
  H5Sget_simple_extent_dims(space.get(), found.data(), nullptr);
  return found == dims && H5Dread(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
}

bool ReadAttribute(hid_t file, const char* name, hid_t type, hssize_t count, void* data) {
  if (H5Aexists(file, name) <= 0) return false;
  const Hdf5Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
  return H5Sget_simple_extent_npoints(space.get()) == count &&
         H5Aread(attribute.get(), type, data) >= 0;
}

bool Decode(hid_t file, SparseSample* sample) {
  hsize_t dims[3] = {0, 0, 0};
  {
    const Hdf5Handle set(H5Dopen2(file, kImage, H5P_DEFAULT), H5Dclose);
    if (!set.is_valid()) return false;
    const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
    if (H5Sget_simple_extent_ndims(space.get()) != 3) return false;
    H5Sget_simple_extent_dims(space.get(), dims, nullptr);
  }
  constexpr hsize_t kMaxSide = 1 << 15;  // pixels; more is damage
  if (dims[0] == 0 || dims[1] == 0 || dims[0] > kMaxSide || dims[1] > kMaxSide) return false;
  const int height = static_cast<int>(dims[0]);
  const int width = static_cast<int>(dims[1]);
  cv::Mat rgb(height, width, CV_8UC3);
  sample->sparse = {cv::Mat(height, width, CV_32F), cv::Mat(height, width, CV_32F)};
  std::array<double, 7> pose{};
  const bool ok =
      ReadArray(file, kImage, H5T_NATIVE_UINT8, {dims[0], dims[1], 3}, rgb.data) &&
      ReadArray(file, kRange, H5T_NATIVE_FLOAT, {dims[0], dims[1]}, sample->sparse.range.data) &&
      ReadArray(file, kConfidence, H5T_NATIVE_FLOAT, {dims[0], dims[1]},
                sample->sparse.confidence.data) &&
      ReadAttribute(file, kFrameIndex, H5T_NATIVE_INT, 1, &sample->frame_index) &&
      ReadAttribute(file, kTimestamp, H5T_NATIVE_DOUBLE, 1, &sample->timestamp) &&
      ReadAttribute(file, kPose, H5T_NATIVE_DOUBLE, static_cast<hssize_t>(pose.size()),
                    pose.data());
  if (!ok) return false;
  cv::cvtColor(rgb, sample->image, cv::COLOR_RGB2BGR);
  sample->world_from_camera.translation = {pose[0], pose[1], pose[2]};
  sample->world_from_camera.rotation = Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]);
  return true;
}

}  // namespace

void WriteSparseSample(const std::filesystem::path& path, const SparseSample& sample) {
  ORB360_CHECK(sample.image.type() == CV_8UC3 && sample.sparse.range.type() == CV_32F &&
               sample.sparse.confidence.type() == CV_32F);
  ORB360_CHECK(sample.sparse.range.size() == sample.image.size() &&
               sample.sparse.confidence.size() == sample.image.size());
  WriteFileAtomically(path, Encode(sample));
}

SparseSample ReadSparseSample(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw UserError(path.string() + ": no such file");
  }
  const Hdf5Quiet quiet;
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  SparseSample sample;
  if (!file.is_valid() || !Decode(file.get(), &sample)) {
    throw UserError(path.string() + ": not sparse depth as `orb360 run --save-sparse` writes it");
  }
  return sample;
}

}  // namespace orb360
