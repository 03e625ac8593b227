#include "apps/town/world/hedge.h"

#include <algorithm>
#include <span>

namespace orb360::town {

void AddHedge(MeshBuilder& b, const Panel& p, float length, float height, float depth,
              Random& random) {
  constexpr float kCard = 0.45F;    // metres
  constexpr float kInside = 0.16F;  // metres from the clipped surface to the core
  const Materials& m = b.materials();
  const MaterialId leaves = random.Pick(std::span<const MaterialId>(m.leaves));
  b.set_tint({0.012F, 0.02F, 0.008F, 1});
  const float end = std::min(kInside, 0.3F * length);
  b.AddBox(m.rubber, p, end, length - end, -0.5F, height - kInside, kInside - depth, -kInside);
  const Panel rear{p.At(length, 0, kInside - depth), -p.right, p.up, -p.out};
  b.AddRectangle(m.rubber, rear, end, length - end, -0.5F, height - kInside);
  const auto card = [&](const Vector3f& centre, const Vector3f& out, const Vector3f& up) {
    const auto uniform = [&](double low, double high) {
      return static_cast<float>(random.Uniform(low, high));
    };
    const float shade = uniform(0.45, 0.8);
    b.set_tint({shade * 0.85F, shade, shade * 0.75F, 1});
    const Vector3f across = (out.cross(up) + uniform(-0.5, 0.5) * up).normalized();
    const Vector3f along = (out.cross(across) + uniform(-0.25, 0.25) * out).normalized();
    const Vector3f x = 0.5F * kCard * across;
    const Vector3f y = 0.5F * kCard * along;
    const size_t first = b.mesh().vertices.size();
    b.AddQuad(leaves, {centre - x - y, centre + x - y, centre + x + y, centre - x + y},
              {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
    for (size_t i = first; i < b.mesh().vertices.size(); ++i)
      b.mesh().vertices[i].normal = (out * 127).array().round().cast<int8_t>();
  };
  const auto count = [](float area) { return static_cast<int>(14 * area); };
  const auto place = [&](float low, float high) {
    return static_cast<float>(random.Uniform(low, high));
  };
  for (int i = 0; i < count(length * height); ++i) {
    const float x = place(0, length);
    const float z = place(0, height - 0.1F);
    card(p.At(x, z, place(-0.16F, -0.04F)), p.out, p.up);
    card(p.At(x, z, place(0.04F, 0.16F) - depth), -p.out, p.up);
  }
  for (int i = 0; i < count(length * depth); ++i)
    card(p.At(place(0, length), height - place(0.04F, 0.14F), place(-depth, 0)), p.up, p.out);
  for (int i = 0; i < count(height * depth); ++i) {
    const float z = place(0, height - 0.1F);
    const float y = place(0, -depth);
    card(p.At(place(0.04F, 0.16F), z, y), -p.right, p.up);
    card(p.At(length - place(0.04F, 0.16F), z, y), p.right, p.up);
  }
}

void AddIvy(MeshBuilder& b, const Panel& p, float width, float height, Random& random) {
  const MaterialId leaves = random.Pick(std::span<const MaterialId>(b.materials().leaves));
  const auto centre = static_cast<float>(random.Uniform(0.2, 0.8)) * width;
  const auto top = static_cast<float>(random.Uniform(0.5, 0.95)) * height;
  const float spread = std::min(0.45F * width, 3.0F);
  const int cards = static_cast<int>(3.5F * spread * top);
  for (int i = 0; i < cards; ++i) {
    const auto z = static_cast<float>(random.Uniform(0, 1)) * top;
    const float reach = spread * (1 - 0.75F * z / top);
    const float x = centre + reach * static_cast<float>(random.Uniform(-1, 1));
    const auto size = static_cast<float>(random.Uniform(0.7, 1.1));
    const auto lean = static_cast<float>(random.Uniform(0.05, 0.3));
    if (x < 0.5F * size || x > width - 0.5F * size) continue;
    const auto shade = static_cast<float>(random.Uniform(0.45, 0.85));
    b.set_tint({shade * 0.8F, shade, shade * 0.7F, 1});
    b.AddQuad(leaves,
              {p.At(x - 0.5F * size, z, 0.03F), p.At(x + 0.5F * size, z, 0.03F),
               p.At(x + 0.5F * size, z + size, lean), p.At(x - 0.5F * size, z + size, lean)},
              {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
  }
}

}  // namespace orb360::town
