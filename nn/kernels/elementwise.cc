#include "nn/kernels/elementwise.h"

#include <cstdint>
#include <cstring>

#include <orb360/nn/base/check.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/kernels/elementwise.cc"
#include <hwy/foreach_target.h>
// foreach_target must come first.
#include <hwy/highway.h>

#include "nn/kernels/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace orb360::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A vector has at most a block of channels, to which a planar row is aligned too.
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

template <class Function>
void ForEach(const TensorView& a, const TensorView& b, const TensorView& y, int threads,
             const Function& function) {
  constexpr int kBlock = BlockOf(DataType::kFloat);
  const bool is_blocked = y.layout == Layout::kBlocked;
  // The loop runs over whole blocks: pixels of a blocked row, cache lines of a planar one.
  const int blocks = is_blocked ? y.shape.width : (y.shape.width + kBlock - 1) / kBlock;
  const int rows = y.shape.height;
  const int planes = y.planes();
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int line = 0; line < planes * rows; ++line) {
    const D d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int plane = line / rows;
    const float* first = a.row<float>(plane, line % rows);
    const float* second = b.row<float>(plane, line % rows);
    float* to = y.row<float>(plane, line % rows);
    for (int i = 0; i < blocks * kBlock; i += lanes) {
      hn::Store(function(hn::Load(d, first + i), hn::Load(d, second + i)), d, to + i);
    }
    const int filled = is_blocked ? y.shape.channels - plane * kBlock : kBlock;
    if (filled >= kBlock) continue;
    for (int i = 0; i < blocks * kBlock; i += kBlock) {
      std::memset(to + i + filled, 0, sizeof(float) * (kBlock - filled));
    }
  }
}

template <class Function>
void ForEach(const TensorView& x, const TensorView& y, int threads, const Function& function) {
  ForEach(x, x, y, threads, [&](V value, V) HWY_ATTR { return function(value); });
}

void Relu(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads,
          [](V value) HWY_ATTR { return hn::IfThenZeroElse(hn::Lt(value, hn::Zero(D())), value); });
}

void LeakyRelu(const TensorView& x, float slope, const TensorView& y, int threads) {
  ForEach(x, y, threads, [&](V value) HWY_ATTR {
    return hn::IfThenElse(hn::Lt(value, hn::Zero(D())), hn::Mul(hn::Set(D(), slope), value), value);
  });
}

void Tanh(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](V value) HWY_ATTR { return TotalTanh(D(), value); });
}

void Sigmoid(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](V value) HWY_ATTR { return TotalSigmoid(D(), value); });
}

void Softplus(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](V value) HWY_ATTR { return TotalSoftplus(D(), value); });
}

void Exp(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](V value) HWY_ATTR { return TotalExp(D(), value); });
}

void Log(const TensorView& x, const TensorView& y, int threads) {
  ForEach(x, y, threads, [](V value) HWY_ATTR { return TotalLog(D(), value); });
}

void Clamp(const TensorView& x, float minimum, float maximum, const TensorView& y, int threads) {
  ForEach(x, y, threads, [&](V value) HWY_ATTR {
    const V low = hn::Set(D(), minimum);
    const V high = hn::Set(D(), maximum);
    // Min and Max are not used because they lose NaN on some instruction sets.
    value = hn::IfThenElse(hn::Lt(value, low), low, value);
    return hn::IfThenElse(hn::Gt(value, high), high, value);
  });
}

void Affine(const TensorView& x, float scale, float offset, const TensorView& y, int threads) {
  ForEach(x, y, threads, [&](V value) HWY_ATTR {
    return hn::MulAdd(hn::Set(D(), scale), value, hn::Set(D(), offset));
  });
}

void Add(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  ForEach(a, b, y, threads, [](V first, V second) HWY_ATTR { return hn::Add(first, second); });
}

void Multiply(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  ForEach(a, b, y, threads, [](V first, V second) HWY_ATTR { return hn::Mul(first, second); });
}

}  // namespace HWY_NAMESPACE
}  // namespace orb360::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace orb360::nn {
namespace {

void CheckAlike(const TensorView& x, const TensorView& y) {
  ORB360_CHECK(x.type == DataType::kFloat && y.type == DataType::kFloat && x.layout == y.layout);
  ORB360_CHECK(x.shape == y.shape);
}

}  // namespace

HWY_EXPORT(Relu);
HWY_EXPORT(LeakyRelu);
HWY_EXPORT(Tanh);
HWY_EXPORT(Sigmoid);
HWY_EXPORT(Softplus);
HWY_EXPORT(Exp);
HWY_EXPORT(Log);
HWY_EXPORT(Clamp);
HWY_EXPORT(Affine);
HWY_EXPORT(Add);
HWY_EXPORT(Multiply);

void Relu(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Relu)(x, y, threads);
}

void LeakyRelu(const TensorView& x, float slope, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(LeakyRelu)(x, slope, y, threads);
}

void Tanh(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Tanh)(x, y, threads);
}

void Sigmoid(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Sigmoid)(x, y, threads);
}

void Softplus(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Softplus)(x, y, threads);
}

void Exp(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Exp)(x, y, threads);
}

void Log(const TensorView& x, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Log)(x, y, threads);
}

void Clamp(const TensorView& x, float minimum, float maximum, const TensorView& y, int threads) {
  CheckAlike(x, y);
  ORB360_CHECK(minimum <= maximum, minimum, maximum);
  HWY_DYNAMIC_DISPATCH(Clamp)(x, minimum, maximum, y, threads);
}

void Affine(const TensorView& x, float scale, float offset, const TensorView& y, int threads) {
  CheckAlike(x, y);
  HWY_DYNAMIC_DISPATCH(Affine)(x, scale, offset, y, threads);
}

void Add(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  CheckAlike(a, y);
  CheckAlike(b, y);
  HWY_DYNAMIC_DISPATCH(Add)(a, b, y, threads);
}

void Multiply(const TensorView& a, const TensorView& b, const TensorView& y, int threads) {
  CheckAlike(a, y);
  CheckAlike(b, y);
  HWY_DYNAMIC_DISPATCH(Multiply)(a, b, y, threads);
}

}  // namespace orb360::nn
#endif
