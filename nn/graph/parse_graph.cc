#include "nn/graph/parse_graph.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "nn/graph/json_object.h"
#include "nn/graph/limits.h"
#include "nn/graph/operation_schema.h"
#include "nn/graph/shape_inference.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

using nlohmann::json;
using Names = std::map<std::string, int, std::less<>>;

json ParseJson(std::string_view text) {
  if (text.size() > limits::kJsonBytes) {
    throw UserError("the graph has " + std::to_string(text.size()) +
                    " bytes of JSON, and at most " + std::to_string(limits::kJsonBytes) +
                    " are accepted");
  }
  bool is_too_deep = false;
  const auto keep = [&](int depth, json::parse_event_t, json&) {
    is_too_deep |= depth > limits::kJsonDepth;
    return !is_too_deep;
  };
  json parsed = json::parse(text, keep, /*allow_exceptions=*/false);
  if (is_too_deep) {
    throw UserError("the graph nests its JSON deeper than " + std::to_string(limits::kJsonDepth));
  }
  if (parsed.is_discarded()) throw UserError("the graph is not valid JSON");
  return parsed;
}

class Parser {
 public:
  explicit Parser(std::vector<Weight> weights) {
    graph_.weights = std::move(weights);
    for (std::size_t i = 0; i < graph_.weights.size(); ++i) {
      CheckWeight(graph_.weights[i]);
      weight_named_[graph_.weights[i].name] = static_cast<int>(i);
    }
    ORB360_CHECK(weight_named_.size() == graph_.weights.size());
  }

  Graph Parse(const json& root) {
    JsonObject object(root, "the graph");
    graph_.name = object.Name("name");
    graph_.size_multiple = object.Integer("size_multiple", 1, limits::kSizeMultiple);
    for (const json& input : NonEmptyList(&object, "inputs")) AddInput(input);
    for (const json& node : object.List("nodes", limits::kNodes)) AddNode(node);
    for (const json& output : NonEmptyList(&object, "outputs")) AddOutput(output);
    graph_.normalisation = Text(&object, "normalisation");
    graph_.provenance = Text(&object, "provenance");
    object.CheckAllRead();
    for (const auto& [name, index] : weight_named_) {
      if (!used_weights_.contains(index)) {
        throw UserError("weights " + Quoted(name) + " belong to no node");
      }
    }
    return std::move(graph_);
  }

 private:
  static void CheckWeight(const Weight& weight) {
    std::int64_t count = 1;
    for (const int size : weight.shape) {
      ORB360_CHECK(size > 0 && size <= limits::kWeights / count, weight.name, size);
      count *= size;
    }
    ORB360_CHECK(count == static_cast<std::int64_t>(weight.values.size()), weight.name, count);
    for (const float value : weight.values) {
      if (!std::isfinite(value)) {
        throw UserError("weights " + Quoted(weight.name) + " contain a number that is not finite");
      }
    }
  }

  static const json& NonEmptyList(JsonObject* object, const char* key) {
    const json& list = object->List(key, limits::kNodes);
    if (list.empty()) throw UserError("the graph has no " + std::string(key));
    return list;
  }

  static std::string Text(JsonObject* object, const char* key) {
    const json& value = object->Get(key);
    if (!value.is_object()) throw UserError(Quoted(key) + " of the graph should be an object");
    return value.dump(2);
  }

  /// Adds a tensor. A second writer of a name is refused.
  int AddTensor(Tensor tensor) {
    const auto index = static_cast<int>(graph_.tensors.size());
    if (!tensor_named_.insert({tensor.name, index}).second) {
      throw UserError("tensor " + Quoted(tensor.name) + " is written twice");
    }
    graph_.tensors.push_back(std::move(tensor));
    return index;
  }

  int FindTensor(const std::string& name) const {
    const auto found = tensor_named_.find(name);
    if (found == tensor_named_.end()) {
      throw UserError("tensor " + Quoted(name) + " is read, but nothing before has written it");
    }
    return found->second;
  }

  void AddInput(const json& value) {
    JsonObject object(value, "an input");
    Tensor tensor{object.Name("name"), object.Integer("channels", 1, limits::kChannels), {}};
    object.CheckAllRead();
    graph_.inputs.push_back(AddTensor(std::move(tensor)));
  }

  void AddOutput(const json& value) {
    JsonObject object(value, "an output");
    const std::string name = object.Name("name");
    if (!outputs_.insert(name).second) {
      throw UserError("two outputs have the name " + Quoted(name));
    }
    graph_.outputs.push_back({name, FindTensor(object.Name("tensor"))});
    object.CheckAllRead();
  }

  void AddNode(const json& value) {
    JsonObject object(value, "node " + std::to_string(graph_.nodes.size()));
    Node node;
    node.name = object.Name("name");
    if (!nodes_.insert(node.name).second) {
      throw UserError("two nodes have the name " + Quoted(node.name));
    }
    const std::string operation = object.Name("op");
    try {
      FillNode(&object, SchemaOf(operation), &node);
    } catch (const UserError& reason) {
      throw UserError("node " + Quoted(node.name) + " (" + operation + "): " + reason.what());
    }
    graph_.nodes.push_back(std::move(node));
  }

  void FillNode(JsonObject* object, const OperationSchema& schema, Node* node) {
    const json& inputs = object->List("inputs", limits::kNodeInputs);
    const json& outputs = object->List("outputs", schema.outputs);
    if (inputs.size() < schema.least_inputs || inputs.size() > schema.most_inputs) {
      throw UserError("it has " + std::to_string(inputs.size()) + " inputs and should have " +
                      std::to_string(schema.least_inputs) +
                      (schema.most_inputs > schema.least_inputs ? " or more" : ""));
    }
    if (outputs.size() != schema.outputs) {
      throw UserError("it has " + std::to_string(outputs.size()) + " outputs and should have " +
                      std::to_string(schema.outputs));
    }
    for (const json& name : inputs) node->inputs.push_back(FindTensor(ToName(name, "an input")));
    FillWeights(object, schema.has_weights, node);
    FillAttributes(object, schema, node);
    object->CheckAllRead();

    std::vector<Tensor> tensors = InferOutputs(graph_, *node);
    for (std::size_t i = 0; i < tensors.size(); ++i) {
      tensors[i].name = ToName(outputs[i], "an output");
      node->outputs.push_back(AddTensor(std::move(tensors[i])));
    }
  }

  void FillWeights(JsonObject* object, bool has_weights, Node* node) {
    static const json nothing = json::object();
    JsonObject weights(object->Has("weights") ? object->Get("weights") : nothing, "\"weights\"");
    for (const char* const key : {"weight", "bias"}) {
      if (!has_weights) break;
      const std::string name = weights.Name(key);
      const auto found = weight_named_.find(name);
      if (found == weight_named_.end()) {
        throw UserError("weights " + Quoted(name) + " are not in the file");
      }
      node->weights.push_back(found->second);
      used_weights_.insert(found->second);
    }
    weights.CheckAllRead();
  }

  static void FillAttributes(JsonObject* object, const OperationSchema& schema, Node* node) {
    static const json nothing = json::object();
    JsonObject attributes(object->Has("attributes") ? object->Get("attributes") : nothing,
                          "\"attributes\"");
    node->operation = schema.read_attributes(&attributes);
    attributes.CheckAllRead();
  }

  Graph graph_;
  Names tensor_named_;
  Names weight_named_;
  std::set<std::string> nodes_;
  std::set<std::string> outputs_;
  std::set<int> used_weights_;
};

}  // namespace

Graph ParseGraph(std::string_view text, std::vector<Weight> weights) {
  const json root = ParseJson(text);
  return Parser(std::move(weights)).Parse(root);
}

}  // namespace orb360::nn
