// Writes the maps that the fuzzer starts from into a folder: write_map_seeds FOLDER.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "tests/fuzz/map_input.h"
#include "tests/slam/pipeline/synthetic_scene.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "write_map_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  constexpr int kSeeds = 12;
  for (int i = 1; i <= kSeeds; ++i) {
    orb360::SyntheticScene scene(2 + i);
    const orb360::Map map = scene.MakeMap(orb360::Walk(1 + i % 4, {-0.5, 0.1, 0.0}), 1 + i);
    std::ofstream(folder / ("map" + std::to_string(i)), std::ios::binary)
        << orb360::WriteMapInput(orb360::ToArrays(map));
  }
  return 0;
}
