#include "slam/depth/tested_row.h"

namespace orb360 {

void TestedRow::Clear(int new_row) {
  row = new_row;
  size = 0;
  column.clear();
  range.clear();
  for (Array& axis : bearing) axis.clear();
}

void TestedRow::Add(int new_column, const Eigen::Vector3f& new_bearing, float new_range) {
  ++size;
  column.push_back(new_column);
  range.push_back(new_range);
  for (int axis = 0; axis < 3; ++axis)
    bearing[static_cast<size_t>(axis)].push_back(new_bearing[axis]);
}

void TestedRow::Close() {
  // Entries past the end refer to column 0, which every image has.
  const size_t length = (size + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
  column.resize(length);
  range.resize(length);
  for (Array& axis : bearing) axis.resize(length);
  for (Array& axis : normal) axis.assign(length, 0.0f);
  for (Array* array : {&variance, &support, &conflict, &information, &best, &shift}) {
    array->assign(length, 0.0f);
  }
}

}  // namespace orb360
