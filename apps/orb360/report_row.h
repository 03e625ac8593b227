#pragma once

namespace orb360 {

/// A line or column of a table, which shows a key of a report.
struct ReportRow {
  const char* key;
  const char* label;
  const char* unit;
  int decimals;
  double factor = 1.0;  ///< From the unit of the report to that of the table.
};

}  // namespace orb360
