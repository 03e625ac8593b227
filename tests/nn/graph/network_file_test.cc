#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/nn/graph/network_builder.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

NetworkBuilder Small() {
  NetworkBuilder net;
  net.Input("x", 3);
  net.Convolution("y", "x", 3, 4, 3);
  net.Output("y", "y");
  return net;
}

std::string Refusal(const std::string& path) {
  try {
    ReadNetwork(path);
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), StartsWith(path + ": "));
    return error.what();
  }
  return "accepted";
}

void WriteBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(NetworkFile, ReadsBackWhatWasWritten) {
  const TempFolder folder;
  const NetworkBuilder net = Small();
  net.Write(folder / "net.h5");
  const Graph graph = ReadNetwork(folder / "net.h5");
  const Graph expected = net.Build();
  EXPECT_EQ(graph.name, "test");
  ASSERT_EQ(graph.weights.size(), 2u);
  // Listed by name, whatever the order in which they were written.
  EXPECT_EQ(graph.weights[0].name, "y.bias");
  EXPECT_EQ(graph.weights[0].values, expected.weights[1].values);
  EXPECT_EQ(graph.weights[1].shape, (std::vector<int>{4, 3, 3, 3}));
  EXPECT_EQ(graph.weights[1].values, expected.weights[0].values);
}

TEST(NetworkFile, WidensWeightsOf16BitsExactly) {
  const TempFolder folder;
  NetworkBuilder net = Small();
  // Normal, subnormal, zeros of both signs, the largest, and one that is rounded on the way in.
  net.weights[1].values = {-1.5f, 0x1p-24f, -0.0f, 65504.0f};
  net.weights[0].values[0] = 1.0f + 0x1p-10f + 0x1p-13f;
  net.weights[0].values[1] = 0x1p-14f - 0x1p-24f;
  net.Write(folder / "half.h5", /*is_half=*/true);
  const Graph graph = ReadNetwork(folder / "half.h5");
  EXPECT_EQ(graph.weights[0].values, net.weights[1].values);
  EXPECT_TRUE(std::signbit(graph.weights[0].values[2]));
  EXPECT_EQ(graph.weights[1].values[0], 1.0f + 0x1p-10f);
  EXPECT_EQ(graph.weights[1].values[1], 0x1p-14f - 0x1p-24f);
}

TEST(NetworkFile, AnyChangedByteIsTheUsersError) {
  const TempFolder folder;
  Small().Write(folder / "net.h5");
  const std::string good = ReadText(folder / "net.h5");
  const std::string path = folder / "damaged.h5";
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ (1 << (i % 8)));
    WriteBytes(path, bytes);
    ASSERT_NE(Refusal(path), "accepted") << "byte " << i;
  }
  for (std::size_t size = 0; size < good.size(); size += 97) {
    WriteBytes(path, good.substr(0, size));
    ASSERT_NE(Refusal(path), "accepted") << size << " bytes";
  }
  WriteBytes(path, good + '\0');
  EXPECT_THAT(Refusal(path), HasSubstr("is damaged"));
}

TEST(NetworkFile, SaysWhatIsWrong) {
  const TempFolder folder;
  EXPECT_THAT(Refusal(folder / "absent.h5"), HasSubstr("No such file"));
  EXPECT_THAT(Refusal(folder / "."), HasSubstr("cannot be read"));
  WriteBytes(folder / "text.h5", "weights\n");
  EXPECT_THAT(Refusal(folder / "text.h5"), HasSubstr("is not a network of orb360"));
  Small().Write(folder / "net.h5");
  std::string bytes = ReadText(folder / "net.h5");
  bytes[8] = 2;
  WriteBytes(folder / "future.h5", bytes);
  EXPECT_THAT(Refusal(folder / "future.h5"), HasSubstr("version 2"));
  WriteWithHeader(folder / "empty.h5", std::string(4096, '\0'));
  EXPECT_THAT(Refusal(folder / "empty.h5"), HasSubstr("no HDF5 content"));

  NetworkBuilder wrong = Small();
  wrong.json["nodes"][0]["op"] = "teleport";
  wrong.Write(folder / "wrong.h5");
  EXPECT_THAT(Refusal(folder / "wrong.h5"),
              AllOf(HasSubstr("node \"y\""), HasSubstr("\"teleport\" is unknown")));
  NetworkBuilder five = Small();
  five.weights[0].shape = {4, 3, 3, 3, 1};
  five.Write(folder / "five.h5");
  EXPECT_THAT(Refusal(folder / "five.h5"), HasSubstr("\"y.weight\" have 5 dimensions"));
  NetworkBuilder wide = Small();
  wide.weights[1].shape = {4097};
  wide.weights[1].values.resize(4097);
  wide.Write(folder / "wide.h5");
  EXPECT_THAT(Refusal(folder / "wide.h5"), HasSubstr("a dimension of 4097"));
  NetworkBuilder without = Small();
  without.weights.pop_back();
  without.Write(folder / "without.h5");
  EXPECT_THAT(Refusal(folder / "without.h5"), HasSubstr("\"y.bias\" are not in the file"));
}

// A file whose digest is right, but whose HDF5 content is not a network: `change` gets the file.
template <typename Change>
std::string RefusalOf(const Change& change) {
  const TempFolder folder;
  Small().Write(folder / "net.h5");
  hid_t file = H5Fopen((folder / "net.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  WriteWithHeader(folder / "net.h5", ReadText(folder / "net.h5"));
  return Refusal(folder / "net.h5");
}

TEST(NetworkFile, RefusesOtherContentBehindARightDigest) {
  const auto add = [](hid_t file, const char* name, hid_t type, hsize_t size) {
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dclose(set);
    H5Sclose(space);
  };
  EXPECT_THAT(RefusalOf([&](hid_t file) { add(file, "weights/more", H5T_NATIVE_DOUBLE, 4); }),
              HasSubstr("\"more\" should be little-endian IEEE floats"));
  EXPECT_THAT(RefusalOf([&](hid_t file) { add(file, "weights/more", H5T_NATIVE_INT, 4); }),
              HasSubstr("\"more\" should be little-endian IEEE floats"));
  EXPECT_THAT(RefusalOf([&](hid_t file) { add(file, "weights/more", H5T_IEEE_F32LE, 4); }),
              HasSubstr("\"more\" belong to no node"));
  EXPECT_THAT(RefusalOf([](hid_t file) {
                H5Gclose(H5Gcreate2(file, "weights/group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
              }),
              HasSubstr("no dataset \"group\""));
  EXPECT_THAT(RefusalOf([](hid_t file) {
                H5Lcreate_external("/etc/hostname", "/x", file, "weights/elsewhere", H5P_DEFAULT,
                                   H5P_DEFAULT);
              }),
              HasSubstr("no dataset \"elsewhere\""));
  EXPECT_THAT(RefusalOf([](hid_t file) { H5Ldelete(file, "graph", H5P_DEFAULT); }),
              HasSubstr("no dataset \"graph\""));
  EXPECT_THAT(RefusalOf([&](hid_t file) {
                H5Ldelete(file, "graph", H5P_DEFAULT);
                add(file, "graph", H5T_NATIVE_INT, 4);
              }),
              HasSubstr("\"graph\" should be one string"));
  EXPECT_THAT(RefusalOf([&](hid_t file) {
                H5Ldelete(file, "weights", H5P_DEFAULT);
                add(file, "weights", H5T_NATIVE_INT, 4);
              }),
              HasSubstr("\"weights\" should be a group"));
}

TEST(NetworkFile, ReadsAVariableLengthStringAsWell) {
  EXPECT_EQ(RefusalOf([](hid_t file) {
              H5Ldelete(file, "graph", H5P_DEFAULT);
              const hid_t type = H5Tcopy(H5T_C_S1);
              H5Tset_size(type, H5T_VARIABLE);
              const hid_t space = H5Screate(H5S_SCALAR);
              const hid_t set =
                  H5Dcreate2(file, "graph", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
              const std::string text = Small().json.dump();
              const char* const pointer = text.c_str();
              H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &pointer);
              H5Dclose(set);
              H5Sclose(space);
              H5Tclose(type);
            }),
            "accepted");
}

}  // namespace
}  // namespace orb360::nn
