// Writes seeds for the fuzzers of the viewer: write_viewer_seeds REQUESTS OCTREES, two folders.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "slam/io/octree/octree_writer.h"
#include "slam/io/ply.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "write_viewer_seeds REQUESTS OCTREES\n";
    return 2;
  }
  for (const int i : {1, 2}) std::filesystem::create_directories(argv[i]);
  const std::filesystem::path requests = argv[1];
  const std::filesystem::path octrees = argv[2];
  // Flags, then address, path, host, origin, fetch site, content length, query, range.
  std::ofstream(requests / "page") << "\1"
                                      "127.0.0.1\n/\n127.0.0.1:8360\n\nnone\n\n\nbytes=0-99\n";
  std::ofstream(requests / "action")
      << "\2::1\n/act\n[::1]:8360\nhttp://[::1]:8360\nsame-origin\n0\n\n\n";
  std::ofstream(requests / "token")
      << "\1"
         "0.0.0.0\n/token/live.json\n192.168.0.9:8360\n\nsame-origin\n\nsince=12\nbytes=-5\n";
  const std::string cloud = octrees / "cloud.ply";
  std::vector<orb360::ColoredPoint> points;
  for (int i = 0; i < 20; ++i) {
    points.push_back({{static_cast<float>(i), static_cast<float>(i % 7), 2.0f}, {1, 2, 3}});
  }
  orb360::WritePly(cloud, points);
  orb360::WriteOctree(octrees / "small", cloud);
  std::filesystem::remove(cloud);
  return 0;
}
