#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace orb360::nn {

/// Text from a file as part of a one-line message: quoted, control characters escaped, shortened.
std::string Quoted(std::string_view text);

/// Reads an object of JSON that is not trusted. Every failure is a UserError that names the key and
/// says what should be there. What nobody has asked for is an error too (CheckAllRead).
class JsonObject {
 public:
  /// `value` must outlive this. `name` stands in messages.
  JsonObject(const nlohmann::json& value, std::string name);

  bool Has(const char* key) const { return value_.contains(key); }
  /// Any value; the others read one of the type in their name.
  const nlohmann::json& Get(const char* key);
  /// A list of at most `most` things.
  const nlohmann::json& List(const char* key, std::size_t most);
  /// A name: 1 to limits::kNameBytes bytes without control characters.
  std::string Name(const char* key);
  int Integer(const char* key, int least, int most);
  /// Finite as a float, too.
  float Number(const char* key);

  void CheckAllRead() const;

 private:
  const nlohmann::json& value_;
  std::string name_;
  std::set<std::string, std::less<>> read_;
};

/// A name as JsonObject::Name has it, from any value; `what` stands in the message.
std::string ToName(const nlohmann::json& value, const std::string& what);

}  // namespace orb360::nn
