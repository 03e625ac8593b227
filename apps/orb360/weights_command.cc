#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "apps/orb360/commands.h"
#include "nn/graph/fusion.h"
#include "nn/graph/layer_cost.h"
#include <orb360/nn/graph/executor.h>
#include <orb360/nn/graph/graph.h>
#include <orb360/nn/graph/network_file.h>

namespace orb360 {
namespace {

struct InspectOptions {
  std::string file;
  std::vector<int> size = {1024, 512};  // width and height, pixels
  std::vector<double> roofline;         // 10^9 operations and 10^9 bytes a second, or empty
};

std::string ToText(const nn::Shape& shape) {
  std::string text = std::to_string(shape.channels);
  for (const int size : {shape.height, shape.width}) {
    text += "x";
    text += std::to_string(size);
  }
  return text;
}

std::string Formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void PrintRow(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths,
              std::ostream& out) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    // Text is aligned to the left, numbers to the right.
    const std::string fill(widths[i] - std::min(widths[i], cells[i].size()), ' ');
    const bool is_number = i >= 3;
    out << (i == 0 ? "" : "  ") << (is_number ? fill : "") << cells[i]
        << (is_number || i + 1 == cells.size() ? "" : fill);
  }
  out << '\n';
}

void PrintTable(const std::vector<std::vector<std::string>>& rows, std::ostream& out) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const std::vector<std::string>& row : rows) PrintRow(row, widths, out);
}

std::int64_t ParametersOf(const nn::Graph& graph, const nn::Node& node) {
  std::int64_t count = 0;
  for (const int weight : node.weights) {
    count +=
        static_cast<std::int64_t>(graph.weights[static_cast<std::size_t>(weight)].values.size());
  }
  return count;
}

/// Prints the least time of each pass on a processor of the given speed and bandwidth.
void PrintRoofline(const nn::Graph& graph, const InspectOptions& options, std::ostream& out) {
  const double speed = options.roofline[0] * 1e9;
  const double bandwidth = options.roofline[1] * 1e9;
  const std::vector<nn::FusedNode> nodes = nn::FuseConvolutions(graph);
  const std::vector<nn::LayerCost> costs =
      nn::LayerCosts(graph, nodes, options.size[1], options.size[0]);
  std::vector<std::vector<std::string>> rows = {
      {"pass", "operation", "limited by", "MFLOP", "MB", "microseconds"}};
  double total = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto operations = static_cast<double>(costs[i].operations);
    const auto bytes = static_cast<double>(costs[i].bytes);
    if (bytes == 0) continue;
    const double seconds = nn::RooflineSeconds(costs[i], speed, bandwidth);
    total += seconds;
    rows.push_back({nodes[i].node.name, nn::NameOf(nodes[i].node.operation),
                    operations / speed > bytes / bandwidth ? "arithmetic" : "memory",
                    Formatted("%.2f", operations / 1e6), Formatted("%.2f", bytes / 1e6),
                    Formatted("%.1f", seconds * 1e6)});
  }
  out << '\n';
  PrintTable(rows, out);
  out << "\nat least         " << Formatted("%.2f", total * 1e3) << " ms with "
      << Formatted("%g", options.roofline[0]) << " GFLOP/s and "
      << Formatted("%g", options.roofline[1]) << " GB/s\n";
}

int Inspect(const InspectOptions& options) {
  const nn::Graph graph = nn::ReadNetwork(options.file);
  const int width = options.size[0];
  const int height = options.size[1];
  const nn::Executor executor(graph, height, width);
  std::ostream& out = std::cout;

  out << graph.name << " (" << options.file << ")\n\n";
  for (const nn::Executor::Port& input : executor.inputs()) {
    out << "input   " << input.name << "  " << ToText(input.shape) << '\n';
  }
  for (const nn::Executor::Port& output : executor.outputs()) {
    out << "output  " << output.name << "  " << ToText(output.shape) << '\n';
  }
  out << "sides are multiples of " << graph.size_multiple << " pixels\n\n";

  std::int64_t total = 0;
  std::vector<std::vector<std::string>> rows = {
      {"node", "operation", "shape", "parameters", "MMAC"}};
  for (const nn::Node& node : graph.nodes) {
    const auto tensor = static_cast<std::size_t>(node.outputs.front());
    const std::int64_t multiply_adds = nn::MultiplyAdds(graph, node, height, width);
    const std::int64_t parameters = ParametersOf(graph, node);
    total += multiply_adds;
    rows.push_back(
        {node.name, nn::NameOf(node.operation),
         ToText(nn::ShapeFor(graph.tensors[tensor], height, width)),
         parameters == 0 ? "" : std::to_string(parameters),
         multiply_adds == 0 ? "" : Formatted("%.2f", static_cast<double>(multiply_adds) / 1e6)});
  }
  PrintTable(rows, out);

  constexpr double kMegabyte = 1e6;
  out << "\nparameters       " << nn::CountParameters(graph) << '\n'
      << "multiply-adds    " << Formatted("%.2f", static_cast<double>(total) / 1e9) << " G at "
      << width << "x" << height << '\n'
      << "memory           "
      << Formatted("%.1f", static_cast<double>(executor.planned_bytes()) / kMegabyte)
      << " MB of activations, "
      << Formatted("%.1f", static_cast<double>(executor.naive_bytes()) / kMegabyte)
      << " MB without sharing\n"
      << "normalisation    " << graph.normalisation << '\n'
      << "provenance       " << graph.provenance << '\n';
  if (!options.roofline.empty()) PrintRoofline(graph, options, out);
  return EXIT_SUCCESS;
}

}  // namespace

void AddWeightsCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand("weights", "Look into network files");
  command->require_subcommand(1);
  CLI::App* inspect = command->add_subcommand(
      "inspect", "Print a network's nodes, shapes, parameters, arithmetic, memory and provenance");
  const auto options = std::make_shared<InspectOptions>();
  inspect->add_option("FILE", options->file, "Network, as weights_tools writes it")->required();
  inspect->add_option("--size", options->size, "Width and height of the image, pixels")
      ->expected(2)
      ->check(CLI::Range(1, 1 << 15))
      ->type_name("W H")
      ->capture_default_str();
  inspect
      ->add_option(
          "--roofline", options->roofline,
          "Also print the least time of each pass on a processor that computes so many 10^9 "
          "operations and moves so many 10^9 bytes a second")
      ->expected(2)
      ->check(CLI::Range(1e-3, 1e9))
      ->check(kIsNumber)
      ->type_name("GFLOPS GBPS");
  inspect->callback([options, chosen] { *chosen = [options] { return Inspect(*options); }; });
}

}  // namespace orb360
