#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// The keys and values of an object of a Quake map, such as "classname" and "origin".
using QuakeEntity = std::map<std::string, std::string>;

/// Parses the lump of entities: groups `{ "key" "value" ... }`. Of equal keys the first counts. A
/// group that is cut off, and what follows it, is left out.
std::vector<QuakeEntity> ParseQuakeEntities(std::string_view text);

/// Returns the value of a key; empty if it is absent.
std::string ValueOf(const QuakeEntity& entity, const std::string& key);

/// Returns three numbers, in the axes and units of the map; nullopt if the value has others.
std::optional<Eigen::Vector3f> VectorOf(const QuakeEntity& entity, const std::string& key);

}  // namespace orb360::town
