// Writes the maps and reconstructions that fuzzers start from: write_column_seeds MAPS MODELS, two
// folders.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "slam/io/map_arrays.h"
#include "slam/io/sparse_model_arrays.h"
#include "tests/fuzz/columns_input.h"
#include "tests/slam/io/synthetic_model.h"
#include "tests/slam/pipeline/synthetic_scene.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "write_column_seeds MAPS MODELS\n";
    return 2;
  }
  const auto write = [](const std::filesystem::path& folder, int number, const auto& arrays) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / std::to_string(number), std::ios::binary)
        << orb360::WriteColumnsInput(arrays);
  };
  for (int i = 1; i <= 12; ++i) {
    orb360::SyntheticScene scene(2 + i);
    write(argv[1], i, ToArrays(scene.MakeMap(orb360::Walk(1 + i % 4, {-0.5, 0.1, 0.0}), 1 + i)));
  }
  for (int i = 1; i <= 8; ++i) {
    write(argv[2], i, ToArrays(orb360::MakeSyntheticModel({i, 1 + i % 3, 64 * i})));
  }
  return 0;
}
