#include "tests/fuzz/graph_input.h"

#include <cstdint>
#include <set>
#include <sstream>

namespace orb360::nn {
namespace {

constexpr std::int64_t kMaxValues = 1 << 16;  // of all weights together

std::optional<Weight> ReadWeight(const std::string& line, std::int64_t* room) {
  std::istringstream words(line);
  Weight weight;
  std::string shape;
  float value = 0;
  if (!(words >> weight.name >> shape >> value)) return {};
  std::istringstream sizes(shape);
  std::int64_t count = 1;
  for (std::string size; std::getline(sizes, size, 'x');) {
    constexpr std::size_t kMaxDigits = 4;
    const bool is_number = !size.empty() && size.size() <= kMaxDigits &&
                           size.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || std::stoi(size) == 0) return {};
    weight.shape.push_back(std::stoi(size));
    count *= weight.shape.back();
    if (count > *room) return {};
  }
  constexpr std::size_t kMaxDimensions = 4;
  if (weight.shape.empty() || weight.shape.size() > kMaxDimensions) return {};
  *room -= count;
  weight.values.assign(static_cast<std::size_t>(count), value);
  return weight;
}

}  // namespace

std::optional<GraphInput> ReadGraphInput(std::string_view text) {
  GraphInput input;
  std::set<std::string> names;
  std::int64_t room = kMaxValues;
  while (true) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    const std::string line(text.substr(0, end));
    text.remove_prefix(end + 1);
    if (line.empty()) break;
    std::optional<Weight> weight = ReadWeight(line, &room);
    if (!weight || !names.insert(weight->name).second) return {};
    input.weights.push_back(std::move(*weight));
  }
  input.json = text;
  return input;
}

std::string WriteGraphInput(const std::vector<Weight>& weights, const std::string& json) {
  std::ostringstream text;
  for (const Weight& weight : weights) {
    text << weight.name << ' ';
    for (std::size_t i = 0; i < weight.shape.size(); ++i) {
      text << (i == 0 ? "" : "x") << weight.shape[i];
    }
    text << ' ' << weight.values.front() << '\n';
  }
  text << '\n' << json;
  return text.str();
}

}  // namespace orb360::nn
