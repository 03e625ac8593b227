#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace orb360 {

/// What a server answers to one path: a file, or bytes that are made when they are asked for, on
/// the thread of the server. Making them may throw UserError.
struct Resource {
  std::string type;            ///< Media type.
  std::filesystem::path file;  ///< Empty: `make` gives the bytes.
  std::function<std::string()> make = {};
  bool is_action = false;  ///< It changes something: only POST is answered.
  /// In place of `make`: the bytes for a page that has all up to the revision `since` (ParseSince).
  std::function<std::string(std::uint64_t since)> make_since = {};
};

/// All that a server has, by path without a leading slash; "" is the page itself. Nothing else is
/// ever read: a request names an entry of this table, never a file.
using ResourceTable = std::map<std::string, Resource, std::less<>>;

}  // namespace orb360
