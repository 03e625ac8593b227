// Functions of floats within a few units in the last place on every device: Vulkan allows its own
// ones more. Polynomials of S. Moshier's Cephes library. NaN stays NaN.

float Infinity() { return uintBitsToFloat(0x7f800000u); }
float Nan() { return uintBitsToFloat(0x7fc00000u); }

float Exp(float x) {
  if (IsNan(x)) return x;
  if (x > 88.73) return Infinity();
  if (x < -104.0) return 0.0;
  float n = floor(x * 1.44269504 + 0.5);
  float r = x - n * 0.693359375;
  r = r - n * -2.12194440e-4;
  float p = 1.9875691500e-4;
  p = p * r + 1.3981999507e-3;
  p = p * r + 8.3334519073e-3;
  p = p * r + 4.1665795894e-2;
  p = p * r + 1.6666665459e-1;
  p = p * r + 5.0000001201e-1;
  p = p * r * r + r + 1.0;
  // 2^n in two factors, because n may be 128 or below -126.
  int half_n = int(n) >> 1;
  float first = intBitsToFloat((half_n + 127) << 23);
  float second = intBitsToFloat((int(n) - half_n + 127) << 23);
  return p * first * second;
}

// Returns ln(m * 2^e) for m in [0.5, 2).
float LogOfParts(float m, int e) {
  if (m < 0.707106781) {
    m *= 2.0;
    e -= 1;
  } else if (m > 1.41421356) {
    m *= 0.5;
    e += 1;
  }
  float x = m - 1.0;
  float p = 7.0376836292e-2;
  p = p * x - 1.1514610310e-1;
  p = p * x + 1.1676998740e-1;
  p = p * x - 1.2420140846e-1;
  p = p * x + 1.4249322787e-1;
  p = p * x - 1.6668057665e-1;
  p = p * x + 2.0000714765e-1;
  p = p * x - 2.4999993993e-1;
  p = p * x + 3.3333331174e-1;
  float z = x * x;
  float y = p * x * z + float(e) * -2.12194440e-4 - 0.5 * z;
  return x + y + float(e) * 0.693359375;
}

// Returns the exponent of a positive finite number given by its bits, and in `mantissa` its factor
// in [1, 2).
int Split(uint bits, out float mantissa) {
  int exponent = int(bits >> 23);
  uint digits = bits & 0x7fffffu;
  if (exponent == 0) {  // subnormal
    int shift = 23 - findMSB(digits);
    digits = (digits << uint(shift)) & 0x7fffffu;
    exponent = 1 - shift;
  }
  mantissa = uintBitsToFloat(0x3f800000u | digits);
  return exponent - 127;
}

float Log(float x) {
  uint bits = floatBitsToUint(x);
  if (IsNan(x) || bits == 0x7f800000u) return x;
  if ((bits & 0x7fffffffu) == 0u) return -Infinity();
  if (bits > 0x7fffffffu) return Nan();
  float mantissa;
  int exponent = Split(bits, mantissa);
  return LogOfParts(mantissa, exponent);
}

// Returns ln(a / b) of positive finite numbers given by their bits, where no ratio overflows.
float LogOfRatio(uint a, uint b) {
  float mantissa_a;
  float mantissa_b;
  int exponent = Split(a, mantissa_a) - Split(b, mantissa_b);
  return LogOfParts(mantissa_a / mantissa_b, exponent);
}

// Returns ln(1 + x) for x in [0, 1].
float Log1p(float x) {
  precise float sum = 1.0 + x;
  precise float seen = sum - 1.0;
  return seen == 0.0 ? x : Log(sum) * (x / seen);
}

float Tanh(float x) {
  if (IsNan(x)) return x;
  float size = abs(x);
  if (size < 0.625) {
    float z = x * x;
    float p = -5.70498872745e-3;
    p = p * z + 2.06390887954e-2;
    p = p * z - 5.37397155531e-2;
    p = p * z + 1.33314422036e-1;
    p = p * z - 3.33332819422e-1;
    return p * z * x + x;
  }
  float y = 1.0 - 2.0 / (Exp(2.0 * min(size, 20.0)) + 1.0);
  return x < 0.0 ? -y : y;
}

float Sigmoid(float x) {
  if (IsNan(x)) return x;
  float e = Exp(-abs(x));  // at most 1, so nothing overflows
  return (x < 0.0 ? e : 1.0) / (1.0 + e);
}

float Softplus(float x) {
  if (IsNan(x)) return x;
  return max(x, 0.0) + Log1p(Exp(-abs(x)));
}
