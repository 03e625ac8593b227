#include "benchmarks/nn/onnx_model.h"

#include <cstdint>
#include <vector>

namespace orb360::nn {
namespace {

// Just enough of the protocol buffers' wire format to write onnx.proto's messages; numbers of
// fields are that file's.
class Message {
 public:
  Message& Integer(int field, std::uint64_t value) {
    Varint(static_cast<std::uint64_t>(field) << 3);
    Varint(value);
    return *this;
  }
  Message& Bytes(int field, const std::string& value) {
    Varint(static_cast<std::uint64_t>(field) << 3 | 2);
    Varint(value.size());
    bytes_ += value;
    return *this;
  }
  Message& Add(int field, const Message& value) { return Bytes(field, value.bytes_); }
  const std::string& bytes() const { return bytes_; }

 private:
  void Varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>(value | 0x80);
    bytes_ += static_cast<char>(value);
  }
  std::string bytes_;
};

constexpr int kFloat = 1;  // TensorProto.DataType

Message Integers(const std::string& name, const std::vector<int>& values) {
  Message attribute;
  attribute.Bytes(1, name);
  for (const int value : values) attribute.Integer(8, value);
  return attribute.Integer(20, 7);  // AttributeProto.INTS
}

Message Initializer(const std::string& name, const std::vector<int>& dims,
                    const std::vector<float>& values) {
  Message tensor;
  for (const int dim : dims) tensor.Integer(1, dim);
  return tensor.Integer(2, kFloat).Bytes(8, name).Bytes(
      9, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
}

Message Value(const std::string& name, const std::vector<int>& dims) {
  Message shape;
  for (const int dim : dims) shape.Add(1, Message().Integer(1, dim));
  return Message().Bytes(1, name).Add(2,
                                      Message().Add(1, Message().Integer(1, kFloat).Add(2, shape)));
}

}  // namespace

std::string OnnxModel(const Problem& problem) {
  const auto [name, in, out, kernel, stride, reduction, may_tile] = problem.layer;
  const auto beyond = [k = kernel, s = stride](int outputs, int inputs) {
    return (outputs - 1) * s + k - inputs - k / 2;
  };
  const Message node = Message()
                           .Bytes(1, "x")
                           .Bytes(1, "weight")
                           .Bytes(1, "bias")
                           .Bytes(2, "y")
                           .Bytes(3, "convolution")
                           .Bytes(4, "Conv")
                           .Add(5, Integers("kernel_shape", {kernel, kernel}))
                           .Add(5, Integers("strides", {stride, stride}))
                           .Add(5, Integers("pads", {kernel / 2, kernel / 2,
                                                     beyond(problem.out_height(), problem.height),
                                                     beyond(problem.out_width(), problem.width)}));
  const Message graph =
      Message()
          .Add(1, node)
          .Bytes(2, "layer")
          .Add(5, Initializer("weight", {out, in, kernel, kernel}, problem.weight))
          .Add(5, Initializer("bias", {out}, problem.bias))
          .Add(11, Value("x", {1, in, problem.height, problem.width}))
          .Add(12, Value("y", {1, out, problem.out_height(), problem.out_width()}));
  return Message()
      .Integer(1, 8)  // version of the format
      .Add(7, graph)
      .Add(8, Message().Bytes(1, "").Integer(2, 13))  // version of the operators
      .bytes();
}

}  // namespace orb360::nn
