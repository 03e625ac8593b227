#include "apps/town/world/facade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace orb360::town {
namespace {

template <typename T>
const T& PickFrom(Random& random, const std::vector<T>& values) {
  return random.Pick(std::span<const T>(values));
}

/// How far a pane stands behind the face of its frame, metres.
constexpr float kPaneDepth = 0.03F;

/// Wall around the opening [x0, x1] x [z0, z1] inside [left, right] x [bottom, top], and the
/// opening's four reveals.
void AddWallWithOpening(MeshBuilder& b, MaterialId wall, const Panel& p, float left, float right,
                        float bottom, float top, float x0, float x1, float z0, float z1,
                        float reveal) {
  b.AddRectangle(wall, p, left, x0, bottom, top);
  b.AddRectangle(wall, p, x1, right, bottom, top);
  b.AddRectangle(wall, p, x0, x1, bottom, z0);
  b.AddRectangle(wall, p, x0, x1, z1, top);
  reveal += kPaneDepth;
  b.AddFace(wall, p.At(x0, z0), p.At(x0, z0, -reveal), p.At(x0, z1, -reveal), p.At(x0, z1));
  b.AddFace(wall, p.At(x1, z0, -reveal), p.At(x1, z0), p.At(x1, z1), p.At(x1, z1, -reveal));
  b.AddFace(wall, p.At(x0, z1, -reveal), p.At(x1, z1, -reveal), p.At(x1, z1), p.At(x0, z1));
  b.AddFace(wall, p.At(x0, z0), p.At(x1, z0), p.At(x1, z0, -reveal), p.At(x0, z0, -reveal));
}

/// Frame with a mullion and a transom in front of a pane.
void AddWindow(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x0, float x1,
               float z0, float z1, float reveal, bool divided, MaterialId pane) {
  constexpr float kFrame = 0.065F;  // metres
  // The pane reaches behind the frame as far as the reveals do, so that no gap is left.
  b.set_tint({1, 1, 1, 1});
  b.AddPicture(pane, p, x0, x1, z0, z1, -reveal - kPaneDepth);
  b.set_tint(style.frame_tint);
  const MaterialId trim = b.materials().trim;
  b.AddRectangle(trim, p, x0, x0 + kFrame, z0, z1, -reveal);
  b.AddRectangle(trim, p, x1 - kFrame, x1, z0, z1, -reveal);
  b.AddRectangle(trim, p, x0 + kFrame, x1 - kFrame, z0, z0 + kFrame, -reveal);
  b.AddRectangle(trim, p, x0 + kFrame, x1 - kFrame, z1 - kFrame, z1, -reveal);
  if (divided) {
    const float middle = 0.5F * (x0 + x1);
    const float transom = z0 + 0.68F * (z1 - z0);
    b.AddRectangle(trim, p, middle - 0.035F, middle + 0.035F, z0 + kFrame, z1 - kFrame,
                   -reveal + 0.01F);
    b.AddRectangle(trim, p, x0 + kFrame, x1 - kFrame, transom - 0.03F, transom + 0.03F,
                   -reveal + 0.012F);
  }
}

void AddSurround(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x0, float x1,
                 float z0, float z1) {
  const MaterialId trim = b.materials().trim;
  b.set_tint(style.trim_tint);
  b.AddBox(trim, p, x0 - 0.1F, x1 + 0.1F, z0 - 0.09F, z0, 0, 0.1F);  // sill
  if (!style.surrounds) return;
  b.AddBox(trim, p, x0 - 0.14F, x0, z0, z1, 0, 0.04F);
  b.AddBox(trim, p, x1, x1 + 0.14F, z0, z1, 0, 0.04F);
  b.AddBox(trim, p, x0 - 0.18F, x1 + 0.18F, z1, z1 + 0.18F, 0, 0.07F);
}

void AddBalcony(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float x0, float x1,
                float z) {
  constexpr float kDepth = 0.9F;
  constexpr float kRail = 1.0F;
  b.set_tint(style.trim_tint);
  b.AddBox(b.materials().concrete, p, x0, x1, z - 0.16F, z, 0, kDepth);
  b.set_tint({1, 1, 1, 1});
  const MaterialId railing = b.materials().railing;
  b.AddRectangle(railing, p, x0, x1, z, z + kRail, kDepth - 0.05F);
  const Panel left{p.At(x0 + 0.05F, z), p.out, p.up, -p.right};
  const Panel right{p.At(x1 - 0.05F, z), p.out, p.up, p.right};
  b.AddRectangle(railing, left, 0, kDepth, 0, kRail);
  b.AddRectangle(railing, right, 0, kDepth, 0, kRail);
}

void AddUpperFloor(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width,
                   float bottom, int floor, bool has_windows, Random& random) {
  const float top = bottom + style.floor_height;
  if (!has_windows) {
    b.set_tint(style.wall_tint);
    b.AddRectangle(style.wall, p, 0, width, bottom, top);
    return;
  }
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  for (int i = 0; i < bays; ++i) {
    const float left = bay * static_cast<float>(i);
    const float x0 = left + 0.5F * (bay - style.window_width);
    const float x1 = x0 + style.window_width;
    const bool balcony = style.balconies && floor >= 1 && i % 2 == floor % 2 && bays > 1;
    const float z0 = bottom + (balcony ? 0.05F : style.sill);
    const float z1 = bottom + style.sill + style.window_height;
    b.set_tint(style.wall_tint);
    AddWallWithOpening(b, style.wall, p, left, left + bay, bottom, top, x0, x1, z0, z1,
                       style.reveal);
    AddWindow(b, style, p, x0, x1, z0, z1, style.reveal, style.window_width > 0.9F,
              PickFrom(random, b.materials().rooms));
    if (balcony) {
      AddBalcony(b, style, p, x0 - 0.45F, x1 + 0.45F, bottom + 0.03F);
    } else {
      AddSurround(b, style, p, x0, x1, z0, z1);
    }
    if (style.shutters && !balcony) {
      b.set_tint(style.shutter_tint);
      const float half = 0.5F * style.window_width;
      b.AddBox(b.materials().trim, p, x0 - half, x0 - 0.02F, z0, z1, 0, 0.05F);
      b.AddBox(b.materials().trim, p, x1 + 0.02F, x1 + half, z0, z1, 0, 0.05F);
    }
    if (random.Chance(0.03)) {  // air conditioner
      b.set_tint({0.7F, 0.7F, 0.68F, 1});
      b.AddBox(b.materials().trim, p, x0, x0 + 0.8F, z0 - 0.75F, z0 - 0.2F, 0.05F, 0.4F);
    }
  }
}

void AddShopFront(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float left, float right,
                  float height, Random& random) {
  const Materials& m = b.materials();
  constexpr float kReveal = 0.25F;
  const float sign_bottom = height - 0.95F;
  const float x0 = left + 0.3F;
  const float x1 = right - 0.3F;
  const float z0 = 0.5F;
  const float z1 = sign_bottom - 0.1F;
  b.set_tint(style.ground_tint);
  AddWallWithOpening(b, style.ground_wall, p, left, right, 0, height, x0, x1, 0.02F, z1, kReveal);
  const float door = x0 + (x1 - x0) * (random.Chance(0.5) ? 0.0F : 1.0F) * 0.72F;
  const float door_end = door + std::min(1.1F, 0.28F * (x1 - x0));
  const Rgba paint = Srgb(30 + random.Int(140), 30 + random.Int(120), 30 + random.Int(120));
  const auto glaze = [&](float a, float c) {
    if (c - a < 0.4F) return;
    b.set_tint(paint);
    b.AddBox(m.trim, p, a, c, 0.02F, z0, -kReveal - kPaneDepth, -kReveal + 0.05F);
    FacadeStyle frame = style;
    frame.frame_tint = paint;
    const int panes = std::max(1, static_cast<int>((c - a) / 1.9F));
    for (int i = 0; i < panes; ++i) {
      const float step = (c - a) / static_cast<float>(panes);
      AddWindow(b, frame, p, a + step * static_cast<float>(i), a + step * static_cast<float>(i + 1),
                z0, z1, kReveal, false, PickFrom(random, m.shops));
    }
  };
  glaze(x0, door);
  glaze(door_end, x1);
  b.set_tint({1, 1, 1, 1});
  b.AddPicture(PickFrom(random, m.doors), p, door, door_end, 0.02F, std::min(z1, 2.3F), -kReveal);
  if (z1 > 2.3F) b.AddPicture(PickFrom(random, m.rooms), p, door, door_end, 2.3F, z1, -kReveal);
  b.set_tint(paint);
  b.AddBox(m.trim, p, left + 0.15F, right - 0.15F, sign_bottom - 0.08F, height - 0.12F, 0, 0.1F);
  b.set_tint({1, 1, 1, 1});
  const float sign_height = 0.68F;
  const float sign_width = std::min(right - left - 0.5F, 4 * sign_height);
  const float middle = 0.5F * (left + right);
  b.AddPicture(PickFrom(random, m.signs), p, middle - 0.5F * sign_width, middle + 0.5F * sign_width,
               sign_bottom, sign_bottom + sign_height, 0.115F);
  if (random.Chance(0.4)) {  // awning
    const Rgba cloth = Srgb(60 + random.Int(190), 40 + random.Int(120), 40 + random.Int(120));
    const float stripe = 0.4F;
    for (float x = x0; x < x1; x += stripe) {
      b.set_tint(std::lround((x - x0) / stripe) % 2 == 0 ? cloth : Rgba{0.8F, 0.78F, 0.72F, 1});
      const float end = std::min(x + stripe, x1);
      b.AddFace(m.trim, p.At(x, z1 - 0.35F, 1.2F), p.At(end, z1 - 0.35F, 1.2F), p.At(end, z1, 0.1F),
                p.At(x, z1, 0.1F));
      b.AddFace(m.trim, p.At(x, z1 - 0.02F, 0.1F), p.At(end, z1 - 0.02F, 0.1F),
                p.At(end, z1 - 0.37F, 1.2F), p.At(x, z1 - 0.37F, 1.2F));
      b.AddRectangle(m.trim, p, x, end, z1 - 0.6F, z1 - 0.35F, 1.2F);
    }
  }
}

void AddGroundFloor(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width,
                    bool front, bool has_windows, Random& random) {
  const Materials& m = b.materials();
  const float height = style.ground_height;
  if (!has_windows) {
    b.set_tint(style.ground_tint);
    b.AddRectangle(style.ground_wall, p, 0, width, 0, height);
    return;
  }
  if (front && style.shops) {
    const int shops = std::max(1, static_cast<int>(width / 6.5F));
    for (int i = 0; i < shops; ++i) {
      AddShopFront(b, style, p, width * static_cast<float>(i) / static_cast<float>(shops),
                   width * static_cast<float>(i + 1) / static_cast<float>(shops), height, random);
    }
    return;
  }
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  const int door_bay = front ? random.Int(bays) : -1;
  for (int i = 0; i < bays; ++i) {
    const float left = bay * static_cast<float>(i);
    const bool door = i == door_bay;
    const float opening = door ? 1.15F : style.window_width;
    const float x0 = left + 0.5F * (bay - opening);
    const float x1 = x0 + opening;
    const float z0 = door ? 0.15F : 1.0F;
    const float z1 = door ? 2.45F : std::min(height - 0.5F, 1.0F + style.window_height);
    b.set_tint(style.ground_tint);
    AddWallWithOpening(b, style.ground_wall, p, left, left + bay, 0, height, x0, x1, z0, z1,
                       style.reveal);
    if (door) {
      b.set_tint({1, 1, 1, 1});
      b.AddPicture(PickFrom(random, m.doors), p, x0, x1, z0, z1, -style.reveal);
      b.set_tint(style.trim_tint);
      b.AddBox(m.concrete, p, x0 - 0.2F, x1 + 0.2F, -0.1F, 0.15F, 0, 0.4F);
    } else {
      AddWindow(b, style, p, x0, x1, z0, z1, style.reveal, true, PickFrom(random, m.rooms));
      AddSurround(b, style, p, x0, x1, z0, z1);
    }
  }
}

}  // namespace

void AddFacade(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
               bool front, bool has_windows, Random& random) {
  const Materials& m = b.materials();
  b.set_texture_origin(
      {static_cast<float>(random.Uniform(0, 50)), static_cast<float>(random.Uniform(0, 50))});
  b.set_tint({0.75F, 0.74F, 0.72F, 1});
  b.AddRectangle(m.concrete, p, 0, width, -drop - 1, 0, 0);
  b.AddBox(m.concrete, p, 0, width, -0.5F, 0.3F, -0.01F, 0.05F);
  AddGroundFloor(b, style, p, width, front, has_windows, random);
  for (int floor = 0; floor < style.floors - 1; ++floor) {
    AddUpperFloor(b, style, p, width,
                  style.ground_height + style.floor_height * static_cast<float>(floor), floor,
                  has_windows, random);
  }
  const float eaves = EavesHeight(style);
  b.set_tint(style.trim_tint);
  if (style.bands && front) {
    for (int floor = 0; floor < style.floors; ++floor) {
      const float z = style.ground_height + style.floor_height * static_cast<float>(floor);
      b.AddBox(m.trim, p, -0.02F, width + 0.02F, z - 0.12F, z + 0.06F, 0, 0.06F);
    }
  }
  if (style.quoins && front) {
    for (float z = 0.35F; z + 0.5F < eaves; z += 0.5F) {
      const float length = std::lround(z / 0.5F) % 2 == 0 ? 0.55F : 0.32F;
      b.AddBox(m.ashlar, p, 0, length, z, z + 0.46F, 0, 0.035F);
      b.AddBox(m.ashlar, p, width - length, width, z, z + 0.46F, 0, 0.035F);
    }
  }
  // Cornice in two steps.
  b.AddBox(m.trim, p, -0.1F, width + 0.1F, eaves - 0.28F, eaves - 0.1F, 0, 0.15F);
  b.AddBox(m.trim, p, -0.2F, width + 0.2F, eaves - 0.1F, eaves + 0.08F, 0, 0.32F);
  if (front) {
    b.set_tint({0.28F, 0.27F, 0.25F, 1});
    b.AddTube(m.metal, p.At(0.12F, 0, 0.12F), p.At(0.12F, eaves - 0.2F, 0.12F), 0.05F, 0.05F, 6);
  }
}

void AddBack(MeshBuilder& b, const FacadeStyle& style, const Panel& p, float width, float drop,
             Random& random) {
  const float eaves = EavesHeight(style);
  b.set_texture_origin({static_cast<float>(random.Uniform(0, 50)), 0});
  b.set_tint(style.wall_tint);
  b.AddRectangle(style.wall, p, 0, width, -drop - 1, eaves + 0.08F);
  const int bays = std::max(1, static_cast<int>(std::lround(width / style.bay)));
  const float bay = width / static_cast<float>(bays);
  for (int floor = 0; floor < style.floors; ++floor) {
    const float bottom =
        floor == 0 ? 0 : style.ground_height + style.floor_height * static_cast<float>(floor - 1);
    for (int i = 0; i < bays; ++i) {
      const float x0 = bay * static_cast<float>(i) + 0.5F * (bay - style.window_width);
      const float z0 = bottom + style.sill;
      b.set_tint(style.frame_tint);
      b.AddRectangle(b.materials().trim, p, x0, x0 + style.window_width, z0,
                     z0 + style.window_height, 0.01F);
      b.set_tint({1, 1, 1, 1});
      b.AddPicture(PickFrom(random, b.materials().rooms), p, x0 + 0.07F,
                   x0 + style.window_width - 0.07F, z0 + 0.07F, z0 + style.window_height - 0.07F,
                   0.02F);
    }
  }
}

}  // namespace orb360::town
