#include "apps/town/import/quake_entities.h"

#include <sstream>
#include <utility>

namespace orb360::town {

std::vector<QuakeEntity> ParseQuakeEntities(std::string_view text) {
  std::vector<QuakeEntity> entities;
  size_t at = 0;
  const auto quoted = [&]() -> std::optional<std::string> {
    const size_t end = text.find('"', at + 1);
    if (end == std::string_view::npos) return std::nullopt;
    std::string value(text.substr(at + 1, end - at - 1));
    at = end + 1;
    return value;
  };
  const auto skip_to = [&](const char* characters) {
    at = text.find_first_of(characters, at);
    return at != std::string_view::npos;
  };
  while (skip_to("{")) {
    ++at;
    QuakeEntity entity;
    while (skip_to("\"}") && text[at] == '"') {
      std::optional<std::string> key = quoted();
      if (!key || !skip_to("\"")) return entities;
      std::optional<std::string> value = quoted();
      if (!value) return entities;
      entity.emplace(std::move(*key), std::move(*value));
    }
    if (at == std::string_view::npos) return entities;
    entities.push_back(std::move(entity));
  }
  return entities;
}

std::string ValueOf(const QuakeEntity& entity, const std::string& key) {
  const auto entry = entity.find(key);
  return entry == entity.end() ? "" : entry->second;
}

std::optional<Eigen::Vector3f> VectorOf(const QuakeEntity& entity, const std::string& key) {
  std::istringstream text(ValueOf(entity, key));
  Eigen::Vector3f v;
  if (!(text >> v.x() >> v.y() >> v.z()) || !v.allFinite()) return std::nullopt;
  return v;
}

}  // namespace orb360::town
