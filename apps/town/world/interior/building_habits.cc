#include "apps/town/world/interior/building_habits.h"

#include <array>

namespace orb360::town {
namespace {

using enum RoomUse;
constexpr std::array kDwellingUses = {kLiving,  kKitchen, kBedroom, kBathroom,
                                      kBedroom, kLiving,  kOffice};
constexpr std::array kOfficeUses = {kOffice, kOffice, kMeeting, kOffice, kKitchen, kStore};
constexpr std::array kSchoolUses = {kClassroom, kWard,     kClassroom, kOffice,
                                    kStore,     kBathroom, kWard};
constexpr std::array kHallUses = {kOffice, kStore, kStore};
constexpr std::array kGarageUses = {kStore, kPassage, kCellar};
constexpr std::array kCellarUses = {kCellar, kStore, kCellar};

}  // namespace

Habits HabitsOf(BuildingKind kind) {
  switch (kind) {
    case BuildingKind::kDwelling:
      return {{4, 9},       {1.1F, 2.2F}, {2.3F, 3.4F}, {2.2F, 6}, {2.6F, 6},    {0.8F, 1.1F},
              {0.1F, 0.2F}, 1.7,          0.45,         0.9,       kDwellingUses};
    case BuildingKind::kOffice:
      return {{9, 22},       {1.5F, 9}, {2.5F, 3.6F}, {2.8F, 9}, {3, 8},     {0.85F, 1.4F},
              {0.08F, 0.2F}, 1.6,       0.35,         0.85,      kOfficeUses};
    case BuildingKind::kSchool:
      return {{14, 38},      {2, 4}, {2.6F, 4}, {3, 9}, {4, 8},     {0.9F, 1.6F},
              {0.15F, 0.3F}, 1.5,    0.4,       0.9,    kSchoolUses};
    case BuildingKind::kHall:
      return {{16, 40},      {9, 26}, {4.5F, 9}, {3, 8}, {3, 6},   {0.9F, 2.5F},
              {0.15F, 0.3F}, 0.7,     0.4,       0.5,    kHallUses};
    case BuildingKind::kGarage:
      return {{18, 40},     {14, 30}, {2.2F, 2.9F}, {2.5F, 5}, {2.5F, 5},  {0.9F, 2},
              {0.2F, 0.3F}, 0.6,      0.3,          0.05,      kGarageUses};
    case BuildingKind::kCellar:
      return {{6, 18},       {1.2F, 3}, {2, 2.6F}, {2.2F, 5.5F}, {2.5F, 6},  {0.8F, 1.3F},
              {0.2F, 0.45F}, 1.6,       0.4,       0.25,         kCellarUses};
  }
  return {};
}

}  // namespace orb360::town
