#include "apps/town/world/plant_card.h"

namespace orb360::town {

void AddPlantCard(const PlantCard& card, MaterialId material, MeshBuilder& b) {
  const int rows = card.droop > 0 ? 3 : 1;
  uint32_t last = 0;
  for (int row = 0; row <= rows; ++row) {
    const float v = static_cast<float>(row) / static_cast<float>(rows);
    const Vector3f middle =
        card.root + v * card.length * card.along - v * v * card.droop * Vector3f::UnitZ();
    const Vector3f side = 0.5F * card.width * card.across;
    const uint32_t left = b.AddVertex(middle - side, card.light, 0, v);
    const uint32_t right = b.AddVertex(middle + side, card.light, 1, v);
    if (row > 0) {
      b.AddTriangle(material, last, last + 1, right);
      b.AddTriangle(material, last, right, left);
    }
    last = left;
  }
}

}  // namespace orb360::town
