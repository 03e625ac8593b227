#include "apps/town/world/opening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace orb360::town {
namespace {

/// Distance of a pane behind the face of its frame, metres.
constexpr float kPaneDepth = 0.03F;
/// Factor on the tint directly below a sill, from which dirty rain drips.
constexpr float kSillStain = 0.76F;

Rgba Shaded(const Rgba& tint, float factor) { return factor * tint; }

}  // namespace

void AddWeatheredRectangle(MeshBuilder& b, MaterialId wall, const Panel& p, const WallPiece& piece,
                           float low, float high) {
  std::vector<Vertex>& vertices = b.mesh().vertices;
  const size_t first = vertices.size();
  b.AddRectangle(wall, p, piece.left, piece.right, piece.bottom, piece.top);
  for (size_t i = first; i < vertices.size(); ++i) {
    const float root = std::sqrt(i - first < 2 ? low : high);
    for (size_t k = 0; k < 3; ++k)
      vertices[i].tint[k] =
          static_cast<uint8_t>(std::min(255.0F, root * static_cast<float>(vertices[i].tint[k])));
  }
}

void AddWallWithOpening(MeshBuilder& b, MaterialId wall, const Rgba& tint, const Panel& p,
                        const WallPiece& piece, const Opening& o, float reveal, float base) {
  b.set_tint(tint);
  AddWeatheredRectangle(b, wall, p, {piece.left, o.x0, piece.bottom, piece.top}, base, 1);
  AddWeatheredRectangle(b, wall, p, {o.x1, piece.right, piece.bottom, piece.top}, base, 1);
  AddWeatheredRectangle(b, wall, p, {o.x0, o.x1, piece.bottom, o.z0}, base, kSillStain);
  AddWeatheredRectangle(b, wall, p, {o.x0, o.x1, o.z1, piece.top}, 1, 1);
  // The pane is as deep behind the frame as the reveals, so that no gap is left.
  reveal += kPaneDepth;
  b.set_tint(Shaded(tint, 0.9F));
  b.AddFace(wall, p.At(o.x0, o.z0), p.At(o.x0, o.z0, -reveal), p.At(o.x0, o.z1, -reveal),
            p.At(o.x0, o.z1));
  b.AddFace(wall, p.At(o.x1, o.z0, -reveal), p.At(o.x1, o.z0), p.At(o.x1, o.z1),
            p.At(o.x1, o.z1, -reveal));
  b.AddFace(wall, p.At(o.x0, o.z1, -reveal), p.At(o.x1, o.z1, -reveal), p.At(o.x1, o.z1),
            p.At(o.x0, o.z1));
  b.AddFace(wall, p.At(o.x0, o.z0), p.At(o.x1, o.z0), p.At(o.x1, o.z0, -reveal),
            p.At(o.x0, o.z0, -reveal));
}

void AddPane(MeshBuilder& b, MaterialId pane, const Panel& p, const Opening& o, float depth,
             Random& random) {
  constexpr double kTilt = 0.02;  // radians
  b.set_tint({1, 1, 1, 1});
  const auto bend = [&] { return static_cast<float>(kTilt * random.Gaussian()); };
  const Vector3f normal = (p.out + bend() * p.right + bend() * p.up).normalized();
  const bool mirrored = random.Chance(0.5);
  std::array<uint32_t, 4> index{};
  for (size_t i = 0; i < 4; ++i) {
    const bool right = i == 1 || i == 2;
    index[i] = b.AddVertex(p.At(right ? o.x1 : o.x0, i >= 2 ? o.z1 : o.z0, depth), normal,
                           right != mirrored ? 1.0F : 0.0F, i >= 2 ? 1.0F : 0.0F);
  }
  b.AddTriangle(pane, index[0], index[1], index[2]);
  b.AddTriangle(pane, index[0], index[2], index[3]);
}

void AddWindow(MeshBuilder& b, const Rgba& frame, const Panel& p, const Opening& o, float reveal,
               bool divided, MaterialId room, Random& random) {
  constexpr float kFrame = 0.065F;  // metres
  AddPane(b, room, p, o, -reveal - kPaneDepth, random);
  b.set_tint(frame);
  const MaterialId trim = b.materials().trim;
  b.AddRectangle(trim, p, o.x0, o.x0 + kFrame, o.z0, o.z1, -reveal);
  b.AddRectangle(trim, p, o.x1 - kFrame, o.x1, o.z0, o.z1, -reveal);
  b.AddRectangle(trim, p, o.x0 + kFrame, o.x1 - kFrame, o.z0, o.z0 + kFrame, -reveal);
  b.AddRectangle(trim, p, o.x0 + kFrame, o.x1 - kFrame, o.z1 - kFrame, o.z1, -reveal);
  if (divided) {
    const float middle = 0.5F * (o.x0 + o.x1);
    const float transom = o.z0 + 0.68F * (o.z1 - o.z0);
    b.AddRectangle(trim, p, middle - 0.035F, middle + 0.035F, o.z0 + kFrame, o.z1 - kFrame,
                   -reveal + 0.01F);
    b.AddRectangle(trim, p, o.x0 + kFrame, o.x1 - kFrame, transom - 0.03F, transom + 0.03F,
                   -reveal + 0.012F);
  }
}

void AddSurround(MeshBuilder& b, const FacadeStyle& style, const Panel& p, const Opening& o) {
  const MaterialId trim = b.materials().trim;
  b.set_tint(style.trim_tint);
  b.AddBox(trim, p, o.x0 - 0.1F, o.x1 + 0.1F, o.z0 - 0.07F, o.z0, 0, 0.1F);  // sill
  if (!style.surrounds) return;
  b.AddBox(trim, p, o.x0 - 0.14F, o.x0, o.z0, o.z1, 0, 0.04F);
  b.AddBox(trim, p, o.x1, o.x1 + 0.14F, o.z0, o.z1, 0, 0.04F);
  b.AddBox(trim, p, o.x0 - 0.18F, o.x1 + 0.18F, o.z1, o.z1 + 0.18F, 0, 0.07F);
}

void AddBalcony(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x0, float x1,
                float z, Random& random) {
  const Materials& m = b.materials();
  constexpr float kRail = 1.0F;  // metres
  const float depth = style.balcony == BalconyKind::kFrench ? 0.12F : 0.9F;
  if (style.balcony != BalconyKind::kFrench) {
    b.set_tint(Shaded(style.trim_tint, 0.9F));
    b.AddBox(m.concrete, p, x0, x1, z - 0.16F, z, 0, depth);
  }
  const Panel left{p.At(x0 + 0.05F, z), p.out, p.up, -p.right};
  const Panel right{p.At(x1 - 0.05F, z), p.out, p.up, p.right};
  if (style.balcony == BalconyKind::kSolid) {
    b.set_tint(style.wall_tint);
    const MaterialId wall = style.wall;
    b.AddBox(wall, p, x0, x1, z, z + kRail - 0.1F, depth - 0.12F, depth);
    const Panel inner{p.At(x1, z, depth - 0.12F), -p.right, p.up, -p.out};
    b.AddRectangle(wall, inner, 0, x1 - x0, 0, kRail - 0.1F);
    b.AddBox(wall, left, 0, depth, 0, kRail - 0.1F, -0.1F, 0.05F);
    b.AddBox(wall, right, 0, depth, 0, kRail - 0.1F, -0.1F, 0.05F);
  } else {
    b.set_tint({1, 1, 1, 1});
    b.AddRectangle(m.railing, p, x0, x1, z, z + kRail, depth - 0.05F);
    b.AddRectangle(m.railing, left, 0, depth, 0, kRail);
    b.AddRectangle(m.railing, right, 0, depth, 0, kRail);
  }
  if (random.Chance(0.35)) {
    Panel rail = p;
    rail.origin += (depth - 0.02F) * p.out;
    AddFlowerBox(b, rail, {x0 + 0.2F, x1 - 0.2F, z + 0.8F, z + 1.6F}, random);
  }
}

void AddFlowerBox(MeshBuilder& b, const Panel& p, const Opening& o, Random& random) {
  const Materials& m = b.materials();
  b.set_tint(random.Chance(0.5) ? Rgba{0.3F, 0.12F, 0.06F, 1} : Rgba{0.1F, 0.1F, 0.1F, 1});
  b.AddBox(m.trim, p, o.x0 + 0.05F, o.x1 - 0.05F, o.z0, o.z0 + 0.16F, 0.02F, 0.2F);
  const MaterialId leaves = random.Pick(std::span<const MaterialId>(m.leaves));
  constexpr float kSpacing = 0.16F;  // metres
  for (float x = o.x0 + 0.1F; x < o.x1 - 0.1F; x += kSpacing) {
    const auto shade = static_cast<float>(random.Uniform(0.6, 1));
    const bool blossom = random.Chance(0.4);
    b.set_tint(blossom ? Rgba{1, 0.3F * shade, 0.5F * shade, 1} : Rgba{shade, shade, 0.6F, 1});
    const auto size = static_cast<float>(random.Uniform(0.25, 0.42));
    const auto lean = static_cast<float>(random.Uniform(-0.1, 0.15));
    const float low = o.z0 + (random.Chance(0.4) ? -0.12F : 0.08F);
    b.AddQuad(leaves,
              {p.At(x - 0.5F * size, low, 0.14F), p.At(x + 0.5F * size, low, 0.14F),
               p.At(x + 0.5F * size, low + size, 0.14F + lean),
               p.At(x - 0.5F * size, low + size, 0.14F + lean)},
              {Vector2f(0, 0), Vector2f(1, 0), Vector2f(1, 1), Vector2f(0, 1)});
  }
}

void AddSteps(MeshBuilder& b, const Panel& p, float x0, float x1, float z, float drop) {
  constexpr float kRise = 0.16F;
  constexpr float kTread = 0.28F;
  const float bottom = -drop - 0.2F;
  float out = 0.4F;
  for (float top = z; top > bottom; top -= kRise) {
    b.AddBox(b.materials().concrete, p, x0, x1, bottom, top, 0, out);
    out += kTread;
    x0 -= 0.5F * kTread;
    x1 += 0.5F * kTread;
  }
}

}  // namespace orb360::town
