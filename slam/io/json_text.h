#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace orb360 {

/// The text of a JSON value, `indent` spaces a level, or in one line for -1. Bytes that are no
/// UTF-8, which names of files may have, become replacement characters (U+FFFD) instead of an
/// exception.
inline std::string ToJsonText(const nlohmann::json& json, int indent = -1) {
  return json.dump(indent, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace);
}

}  // namespace orb360
