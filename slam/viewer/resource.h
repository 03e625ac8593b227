#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace orb360 {

/// What a server answers to one path: a file, or bytes that are made when they are asked for.
struct Resource {
  std::string type;            ///< Media type.
  std::filesystem::path file;  ///< Empty: `make` gives the bytes.
  /// Called on the thread of the server. May throw UserError.
  std::function<std::string()> make = {};
  bool is_action = false;  ///< It changes something: only POST is answered.
};

/// All that a server has, by path without a leading slash; "" is the page itself. Nothing else is
/// ever read: a request names an entry of this table, never a file.
using ResourceTable = std::map<std::string, Resource, std::less<>>;

}  // namespace orb360
