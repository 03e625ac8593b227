#include "tests/nn/graph/random_network.h"

#include <algorithm>
#include <array>
#include <random>
#include <string>

namespace orb360::nn {
namespace {

using nlohmann::json;

struct Made {
  std::string name;
  int channels;
  int level;  // halvings, or kSingle
};
constexpr int kSingle = 100;
constexpr int kDeepest = 3;  // size_multiple is 8; pooling to the last level needs no more

class Author {
 public:
  explicit Author(unsigned seed) : net_(8, seed), random_(seed) {
    made_ = {{net_.Input("image", 3), 3, 0},
             {net_.Input("depth", 1), 1, 0},
             {net_.Input("confidence", 1), 1, 0}};
    net_.Node("points", "median_log", {"depth", "confidence"}, json::object(), 3);
    made_.push_back({"points", 1, 0});
    made_.push_back({"points.1", 1, 0});
    made_.push_back({"points.2", 1, kSingle});
  }

  NetworkBuilder Write(int nodes) {
    while (static_cast<int>(net_.json["nodes"].size()) < nodes) AddNode();
    net_.Output("last", made_.back().name);
    net_.Output("some", Any().name);
    net_.Output("first", "points");
    return std::move(net_);
  }

 private:
  int Below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  // Young tensors more often, so that the network is deep.
  const Made& Any() {
    const int count = static_cast<int>(made_.size());
    return made_[static_cast<std::size_t>(std::max(Below(count), Below(count)))];
  }
  std::string NewName() {
    std::string name = "t";
    return name += std::to_string(next_name_++);
  }
  std::string Padding(const Made& x) {
    static constexpr std::array kNames = {"zero", "wrap_replicate", "wrap_cross_pole"};
    const bool can_cross = x.level < kDeepest;  // an even width
    return kNames[static_cast<std::size_t>(Below(can_cross ? 3 : 2))];
  }
  Made Unary(const char* op, const Made& x, const json& attributes = json::object()) {
    return {net_.Node(NewName(), op, {x.name}, attributes), x.channels, x.level};
  }

  void AddNode() {
    const Made x = Any();
    switch (Below(17)) {
      case 0:
      case 1:
      case 2:
      case 3:
        return AddConvolution(x);
      case 4:
        return AddOfTwo(x, "add");
      case 5:
        return AddOfTwo(x, "multiply");
      case 6:
      case 7:
        return AddConcatenation(x);
      case 8:
      case 9:
        return AddSlice(x);
      case 10:
      case 11:
        return AddActivation(x);
      case 12:
        return AddResampling(x);
      case 13:
        return AddNormalizedConvolution(x);
      case 14:
        return AddConvexUpsampling(x);
      case 15:
        made_.push_back({net_.Node(NewName(), "latitude_sine", {x.name}), 1, x.level});
        return;
      default:
        return AddGlobalBranch(x);
    }
  }
  void AddConvolution(const Made& x) {
    static constexpr std::array kWidths = {1, 5, 16, 20, 32, 36, 48};
    const int channels = kWidths[static_cast<std::size_t>(Below(kWidths.size()))];
    const bool can_halve = x.level < kDeepest;
    const int stride = can_halve && Below(3) == 0 ? 2 : 1;
    const int level = stride == 2 ? x.level + 1 : x.level;
    const std::string padding = x.level == kSingle ? "zero" : Padding(x);
    made_.push_back({net_.Convolution(NewName(), x.name, x.channels, channels, 1 + 2 * Below(3),
                                      stride, padding),
                     channels, level});
  }
  /// With any other tensor of the same shape, most often x itself where there is none.
  void AddOfTwo(const Made& x, const char* op) {
    std::string other = x.name;
    for (const Made& made : made_) {
      if (made.channels == x.channels && made.level == x.level && Below(2) == 0) other = made.name;
    }
    const std::string y = net_.Node(NewName(), op, {other, x.name});
    // Squares of squares would leave the range of floats.
    made_.push_back(Unary("tanh", {y, x.channels, x.level}));
  }
  void AddConcatenation(const Made& x) {
    std::vector<std::string> names = {x.name};
    int channels = x.channels;
    for (const Made& made : made_) {
      if (made.level != x.level || Below(3) != 0 || channels + made.channels > 100) continue;
      names.push_back(made.name);
      channels += made.channels;
    }
    made_.push_back({net_.Node(NewName(), "concatenate", names), channels, x.level});
  }
  void AddSlice(const Made& x) {
    const int first = Below(2) == 0 ? Below(x.channels) : x.channels / 32 * 16;
    const int count = 1 + Below(x.channels - first);
    made_.push_back({net_.Node(NewName(), "slice", {x.name}, {{"first", first}, {"count", count}}),
                     count, x.level});
  }
  void AddActivation(const Made& x) {
    switch (Below(6)) {
      case 0:
        return made_.push_back(Unary("relu", x));
      case 1:
        return made_.push_back(Unary("leaky_relu", x, {{"slope", 0.2}}));
      case 2:
        return made_.push_back(Unary("softplus", x));
      case 3:
        return made_.push_back(Unary("clamp", x, {{"minimum", -0.75}, {"maximum", 1.5}}));
      case 4:
        return made_.push_back(Unary("exp", Unary("tanh", x)));
      default:
        return made_.push_back(
            Unary("log", Unary("affine", Unary("sigmoid", x), {{"scale", 2.0}, {"offset", 0.5}})));
    }
  }
  void AddResampling(const Made& x) {
    if (x.level < kDeepest && Below(2) == 0) {
      made_.push_back({net_.Node(NewName(), "average_pool", {x.name}), x.channels, x.level + 1});
    } else if (x.level != kSingle && x.level > 0) {
      const bool is_bilinear = Below(2) == 0;
      const json attributes = is_bilinear ? json{{"padding", Padding(x)}} : json(json::object());
      made_.push_back({net_.Node(NewName(), is_bilinear ? "upsample_bilinear" : "upsample_nearest",
                                 {x.name}, attributes),
                       x.channels, x.level - 1});
    }
  }
  void AddNormalizedConvolution(const Made& x) {
    const std::string c = Unary("sigmoid", x).name;
    const int channels = 1 + Below(3);
    const std::string padding = x.level == kSingle ? "wrap_replicate" : Padding(x);
    const Made y = {net_.NormalizedConvolution(NewName(), x.name, c, x.channels, channels,
                                               1 + 2 * Below(3), padding),
                    channels, x.level};
    made_.push_back(y);
    made_.push_back({y.name + ".1", channels, x.level});
    if (Below(2) == 0) {  // a chain
      const std::string z =
          net_.NormalizedConvolution(NewName(), y.name, y.name + ".1", channels, 2, 3, padding);
      made_.push_back({z, 2, x.level});
      made_.push_back({z + ".1", 2, x.level});
    }
    if (x.level >= kDeepest || Below(2) == 0) return;
    const std::string pooled = net_.Node(NewName(), "confidence_pool", {y.name, y.name + ".1"},
                                         {{"rule", Below(2) == 0 ? "quarter" : "sqrt"}}, 2);
    made_.push_back({pooled, channels, x.level + 1});
    made_.push_back({pooled + ".1", channels, x.level + 1});
    if (Below(2) == 0) return;
    // And up again, joined with what was there before.
    const std::string up = net_.Node(NewName(), "upsample_nearest", {pooled});
    const std::string up_c = net_.Node(NewName(), "upsample_nearest", {pooled + ".1"});
    const std::string both = net_.Node(NewName(), "concatenate", {y.name, up});
    const std::string both_c = net_.Node(NewName(), "concatenate", {y.name + ".1", up_c});
    const std::string joined =
        net_.NormalizedConvolution(NewName(), both, both_c, 2 * channels, 1, 3, padding);
    made_.push_back({joined, 1, x.level});
    made_.push_back({joined + ".1", 1, x.level});
  }
  void AddConvexUpsampling(const Made& x) {
    if (x.level == kSingle || x.level == 0) return;
    const std::string value =
        net_.Node(NewName(), "slice", {x.name}, {{"first", x.channels - 1}, {"count", 1}});
    const int factor = 1 + Below(2);
    const std::string weights =
        net_.Convolution(NewName(), x.name, x.channels, 9 * factor * factor, 1);
    made_.push_back({net_.Node(NewName(), "convex_upsample", {value, weights},
                               {{"padding", Padding(x)}, {"factor", factor}}),
                     1, x.level - factor + 1});
  }
  void AddGlobalBranch(const Made& x) {
    const std::string mean = net_.Node(NewName(), "global_average_pool", {x.name});
    const int channels = 1 + Below(40);
    made_.push_back({net_.Dense(NewName(), mean, x.channels, channels), channels, kSingle});
  }

  NetworkBuilder net_;
  std::mt19937 random_;
  std::vector<Made> made_;
  int next_name_ = 0;
};

}  // namespace

NetworkBuilder RandomNetwork(int nodes, unsigned seed) { return Author(seed).Write(nodes); }

std::vector<PlainImage> RandomInputs(int height, int width, unsigned seed) {
  std::vector<PlainImage> inputs = {RandomImage({3, height, width}, 0, 1, seed),
                                    RandomImage({1, height, width}, -8, 12, seed + 1),
                                    RandomImage({1, height, width}, 0, 1, seed + 2)};
  for (std::size_t i = 0; i < inputs[1].values.size(); ++i) {
    if (inputs[1].values[i] > 0) continue;  // no point
    inputs[1].values[i] = inputs[2].values[i] = 0;
  }
  return inputs;
}

}  // namespace orb360::nn
