// Writes the networks that the fuzzer starts from into a folder: write_seeds FOLDER.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "tests/fuzz/graph_input.h"
#include "tests/nn/graph/random_network.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "write_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  constexpr int kSeeds = 40;
  for (int i = 1; i <= kSeeds; ++i) {
    const orb360::nn::NetworkBuilder net = orb360::nn::RandomNetwork(1 + i, i);
    std::ofstream(folder / ("network" + std::to_string(i)))
        << orb360::nn::WriteGraphInput(net.weights, net.json.dump());
  }
  return 0;
}
