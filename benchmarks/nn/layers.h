#pragma once

#include <string>
#include <vector>

namespace orb360::nn {

/// The shape of one convolution of a network. The input has 1/`reduction` of the panorama's height
/// and width.
struct Layer {
  std::string name;
  int in_channels;
  int out_channels;
  int kernel;
  int stride;
  int reduction;
  /// As the network's executor allows it: see ConvolutionSpec::may_tile.
  bool may_tile = true;
};

/// A network's convolutions; equal shapes stand once.
struct LayerList {
  std::string network;
  std::vector<Layer> layers;
};

/// Depth completion (fusion at half resolution).
inline const LayerList kCompletionLayers = {"completion",
                                            {{"E1", 9, 32, 3, 2, 1},
                                             {"E2", 32, 64, 3, 2, 2},
                                             {"E2 residual", 64, 64, 3, 1, 4},
                                             {"E3", 64, 96, 3, 2, 4},
                                             {"E3 residual", 96, 96, 3, 1, 8},
                                             {"E4", 96, 128, 3, 2, 8},
                                             {"E4 residual", 128, 128, 3, 1, 16},
                                             {"E5", 128, 160, 3, 2, 16, false},
                                             {"E5 residual", 160, 160, 3, 1, 32, false},
                                             {"L4", 160, 128, 1, 1, 32},
                                             {"D4", 128, 128, 3, 1, 16},
                                             {"L3", 128, 96, 1, 1, 16},
                                             {"D3", 96, 96, 3, 1, 8},
                                             {"L2", 96, 64, 1, 1, 8},
                                             {"D2", 64, 64, 3, 1, 4},
                                             {"L1", 64, 32, 1, 1, 4},
                                             {"D1", 32, 32, 3, 1, 2},
                                             {"H1", 32, 32, 3, 1, 2},
                                             {"H2", 32, 40, 1, 1, 2}}};

/// The published guided encoder-decoder.
inline const LayerList kEncoderDecoderLayers = {"encoder-decoder",
                                                {{"encoder 1", 5, 80, 3, 2, 1},
                                                 {"encoder 2", 80, 80, 3, 2, 2},
                                                 {"encoder 3", 80, 80, 3, 2, 4},
                                                 {"encoder 4", 80, 80, 3, 2, 8},
                                                 {"encoder 5", 80, 80, 3, 2, 16},
                                                 {"decoder 5", 160, 64, 3, 1, 16},
                                                 {"decoder 4", 144, 64, 3, 1, 8},
                                                 {"decoder 3", 144, 32, 3, 1, 4},
                                                 {"decoder 2", 112, 32, 3, 1, 2},
                                                 {"decoder 1", 33, 1, 3, 1, 1}}};

/// The published guided multi-stream network, and the first layer of the unguided one as a plain
/// convolution, for the 5x5 kernel.
inline const LayerList kMultiStreamLayers = {"multi-stream",
                                             {{"depth 1", 1, 16, 3, 1, 1},
                                              {"depth 2", 16, 16, 3, 1, 1},
                                              {"image 1", 4, 64, 3, 1, 1},
                                              {"image 2", 64, 64, 3, 1, 1},
                                              {"fusion 1", 80, 64, 3, 1, 1},
                                              {"fusion 4", 64, 32, 3, 1, 1},
                                              {"fusion 5", 32, 32, 3, 1, 1},
                                              {"fusion 7", 32, 1, 1, 1, 1},
                                              {"5x5", 32, 32, 5, 1, 2}}};

}  // namespace orb360::nn
