#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace orb360::nn {

/// Returns text from a file as part of a one-line message: quoted, with control characters escaped,
/// shortened.
std::string Quoted(std::string_view text);

/// Reads a JSON object that is not trusted. Every failure throws UserError, which names the key and
/// says what should be there. Keys that were not read are an error too (CheckAllRead).
class JsonObject {
 public:
  /// `value` must outlive this object. Messages contain `name`.
  JsonObject(const nlohmann::json& value, std::string name);

  bool Has(const char* key) const { return value_.contains(key); }
  /// Returns any value. The other functions return a value of the type in their name.
  const nlohmann::json& Get(const char* key);
  /// Returns a list of at most `most` elements.
  const nlohmann::json& List(const char* key, std::size_t most);
  /// Returns a name: 1 to limits::kNameBytes bytes without control characters.
  std::string Name(const char* key);
  int Integer(const char* key, int least, int most);
  /// Returns a number that is also finite as a float.
  float Number(const char* key);

  void CheckAllRead() const;

 private:
  const nlohmann::json& value_;
  std::string name_;
  std::set<std::string, std::less<>> read_;
};

/// Reads a name as JsonObject::Name does, from any value; the message contains `what`.
std::string ToName(const nlohmann::json& value, const std::string& what);

}  // namespace orb360::nn
