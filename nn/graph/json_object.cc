#include "nn/graph/json_object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "nn/graph/limits.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {

std::string Quoted(std::string_view text) {
  constexpr std::size_t kMaxBytes = 80;  // bytes: enough to recognise it, and one line still
  const bool is_cut = text.size() > kMaxBytes;
  return nlohmann::json(text.substr(0, kMaxBytes))
             .dump(-1, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace) +
         (is_cut ? "..." : "");
}

std::string ToName(const nlohmann::json& value, const std::string& what) {
  if (!value.is_string()) throw UserError(what + " should be a string");
  const auto& name = value.get_ref<const std::string&>();
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (name.empty() || name.size() > limits::kNameBytes || std::ranges::any_of(name, is_control)) {
    throw UserError(what + " should be a name of 1 to " + std::to_string(limits::kNameBytes) +
                    " bytes without control characters, not " + Quoted(name));
  }
  return name;
}

JsonObject::JsonObject(const nlohmann::json& value, std::string name)
    : value_(value), name_(std::move(name)) {
  if (!value.is_object()) throw UserError(name_ + " should be an object");
}

const nlohmann::json& JsonObject::Get(const char* key) {
  const auto found = value_.find(key);
  if (found == value_.end()) throw UserError(name_ + " has no " + Quoted(key));
  read_.insert(key);
  return *found;
}

const nlohmann::json& JsonObject::List(const char* key, std::size_t most) {
  const nlohmann::json& list = Get(key);
  if (!list.is_array()) throw UserError(Quoted(key) + " of " + name_ + " should be a list");
  if (list.size() > most) {
    throw UserError(Quoted(key) + " of " + name_ + " has " + std::to_string(list.size()) +
                    " entries, and at most " + std::to_string(most) + " are accepted");
  }
  return list;
}

std::string JsonObject::Name(const char* key) {
  return ToName(Get(key), Quoted(key) + " of " + name_);
}

int JsonObject::Integer(const char* key, int least, int most) {
  const nlohmann::json& value = Get(key);
  // The parser reads numbers beyond std::int64_t as doubles or as unsigned.
  const bool fits = value.is_number_integer() &&
                    !(value.is_number_unsigned() &&
                      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<int>::max()});
  const std::int64_t integer = fits ? value.get<std::int64_t>() : 0;
  if (!fits || integer < least || integer > most) {
    throw UserError(Quoted(key) + " of " + name_ + " should be an integer from " +
                    std::to_string(least) + " to " + std::to_string(most));
  }
  return static_cast<int>(integer);
}

float JsonObject::Number(const char* key) {
  const nlohmann::json& value = Get(key);
  const double number =
      value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
  if (!(std::abs(number) <= std::numeric_limits<float>::max())) {
    throw UserError(Quoted(key) + " of " + name_ + " should be a number that fits 32 bits");
  }
  return static_cast<float>(number);
}

void JsonObject::CheckAllRead() const {
  for (const auto& [key, unused] : value_.items()) {
    if (!read_.contains(key)) throw UserError(name_ + " has an unknown " + Quoted(key));
  }
}

}  // namespace orb360::nn
